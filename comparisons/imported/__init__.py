"""Results of tools that cannot be called: their files read and judged against the closed form."""
