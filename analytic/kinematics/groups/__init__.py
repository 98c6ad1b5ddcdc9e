"""Assur groups of class III and higher: search, continuation over the driver's coordinate, Newton's method."""
