"""The stability maps on the terminal and on their page."""
