"""What a designer is shown: results of a linkage, its check, sweeps, optima and tolerances, in print and files."""
