"""What a study of tolerances says and shows."""
