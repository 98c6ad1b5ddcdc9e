"""Tolerances: which number of a linkage moves which figure by how much."""
