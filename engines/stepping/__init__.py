"""What adapters share on the way from time steps to a history."""
