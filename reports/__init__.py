"""Tables, figures, pages and the command line: the top floor."""
