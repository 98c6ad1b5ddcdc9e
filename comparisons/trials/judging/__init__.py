"""Quantities, deviations, limits, changes, and the records made of them."""
