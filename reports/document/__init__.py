"""The model of a report, from pages down to words, and its writers: to a terminal, as Markdown, as HTML."""
