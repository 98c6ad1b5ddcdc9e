"""Results of a linkage without an engine: peaks, bearing forces, tables of every signal, drawings."""
