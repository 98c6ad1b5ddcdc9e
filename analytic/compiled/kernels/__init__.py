"""Loops over blocks of crank angles, compiled once for all linkages."""
