"""Faults of a simulation: one list, from which faults are planted, fitted to curves and ranked."""
