"""What a designer wants of a linkage without an engine: peaks, bearing forces, tables of every signal, a drawing."""
