"""A report's folder: all its pages, written from the data saved in it."""
