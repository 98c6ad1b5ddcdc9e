"""Headers of result files: the name in them, the unit, and the signal of the linkage that they mean."""
