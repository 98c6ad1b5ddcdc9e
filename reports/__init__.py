"""Tables, figures, pages and the command line: the top floor."""

PASSED, FAILED, BAD_INPUT, SUITE_ERROR, INTERRUPTED = 0, 1, 2, 3, 130  # exit codes
