"""The best of the designs of a linkage: a figure least or largest, others kept, numbers of the file between bounds."""
