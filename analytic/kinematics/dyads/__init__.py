"""The five dyads in closed form, a file each: formulas that NumPy calls with arrays and numba compiles."""
