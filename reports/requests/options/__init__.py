"""The options of every request as annotated fields; nothing else is imported, so that help comes at once."""
