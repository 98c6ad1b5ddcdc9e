"""The work-precision study on the terminal and on its page."""
