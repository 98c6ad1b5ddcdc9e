"""The commands as functions of the package linkproof."""
