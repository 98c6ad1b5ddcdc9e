"""Saved records as plain data for pages, tables and the terminal."""
