"""The report's figures, one kind per file; each has a ``draw_...`` on given axes and a figure of its own around it."""
