"""What a sweep says and shows."""
