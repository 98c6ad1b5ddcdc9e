"""One mechanism: its page and its tables in the terminal."""
