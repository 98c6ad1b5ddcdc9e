"""Tables and pictures of an optimisation."""
