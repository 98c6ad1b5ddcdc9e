"""Results of tools that cannot be called: their files read, held against the closed form, and judged."""
