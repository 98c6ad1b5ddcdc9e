"""Likely causes of a difference: the closed form with one thing changed, fitted to the file."""
