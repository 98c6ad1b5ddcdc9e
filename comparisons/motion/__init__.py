"""A linkage under a motion of its crank: the case, its truth, its scene."""
