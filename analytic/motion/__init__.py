"""Motions of a crank that is released or steady, and what one turn shows: unit functions, thread feed."""
