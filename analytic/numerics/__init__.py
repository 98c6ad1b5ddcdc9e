"""Numerical methods without linkages: integration in time, periodic tables, extremes, roots, derivatives."""
