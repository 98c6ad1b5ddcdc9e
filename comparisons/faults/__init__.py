"""What can be wrong with a simulation: one list of faults, which is planted, fitted to curves and ranked."""
