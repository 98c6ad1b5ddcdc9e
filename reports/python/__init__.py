"""What the package linkproof offers to Python: the commands as functions."""
