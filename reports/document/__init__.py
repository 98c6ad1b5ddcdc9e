"""The one model of a report, pages down to words, and what writes it: to a terminal, as Markdown, as HTML."""
