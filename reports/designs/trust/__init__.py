"""What simulations of a sample of designs say and show."""
