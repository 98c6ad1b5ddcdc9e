"""The form of a linkage file: its repeated parts, its JSON schema, and a file to begin with."""
