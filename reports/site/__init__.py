"""A report's folder: all its pages, written from what is saved in it."""
