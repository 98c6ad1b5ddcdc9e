"""What saved records say, as plain data for pages, tables and the terminal."""
