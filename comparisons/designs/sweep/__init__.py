"""Sweeps: figures over a space of designs, block by block, and the file they are kept in."""
