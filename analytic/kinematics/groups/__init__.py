"""Assur groups of class III and higher: found, followed over the driver's coordinate, and solved by Newton's method."""
