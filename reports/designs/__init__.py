"""What a designer asks for, shown: results of a linkage, its check, sweeps, optima, tolerances; tables, files, pictures."""
