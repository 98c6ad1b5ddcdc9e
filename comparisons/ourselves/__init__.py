"""What measures the suite itself."""
