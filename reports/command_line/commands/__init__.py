"""The work of the commands once their options are read: a module per group of commands."""
