"""Quantities, deviations, limits, baseline, and the records made of them."""
