"""Sweeps: figures over a space of designs, block by block, and the file that saves them."""
