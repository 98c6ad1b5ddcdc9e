"""One mechanism: its page, and what the terminal says of it."""
