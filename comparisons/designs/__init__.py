"""Studies of many designs of one linkage: sweeps, optima, tolerances."""
