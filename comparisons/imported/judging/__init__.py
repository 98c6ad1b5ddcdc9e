"""Imported signals beside the closed form: at which instants, how far off, whether the columns agree."""
