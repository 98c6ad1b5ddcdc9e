"""The data sheet of a linkage: what its designer wants of the closed form, as plain data that is saved and shown."""
