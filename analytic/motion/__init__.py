"""Motions of a crank that is released: by collocation, by the sources' fixed-step method, in steady rotation."""
