"""Studies of many designs of one linkage: sweeps, optima, tolerances, and how far engines may be trusted there."""
