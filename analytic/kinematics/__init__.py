"""Assur groups: decomposition, closed-form solution, derivatives over the crank angle, error bounds."""
