"""Results of another tool's files beside the closed form, and the likeliest cause of an error."""
