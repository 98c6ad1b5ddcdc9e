"""One module per group of commands: what each does once its options are read."""
