"""What a designer asks of a linkage alone: its sheet, its check, sweeps, optima and tolerances."""
