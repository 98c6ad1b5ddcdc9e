"""Optimisation: the least or largest value of a figure over bounded numbers of the file, others constrained."""
