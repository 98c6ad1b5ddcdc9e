"""A planar linkage as data: the file it is read from, its units, and the motions its crank may be given."""
