"""Tables and pictures of studies of many designs: sweeps, optima, tolerances, engines over a space of designs."""
