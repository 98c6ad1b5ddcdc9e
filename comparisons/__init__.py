"""Engines against the reference: quantities, deviations, limits, invariants, campaigns that write records."""
