"""What an optimisation says and shows."""
