"""What studies of many designs say and show: sweeps, optima, tolerances, trust in engines over a space."""
