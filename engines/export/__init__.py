"""A pass of an engine as a script in the engine's own API, free of this suite."""
