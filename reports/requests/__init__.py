"""What users request: options declared once, what is worked out of them, and exit codes that say how it ended."""

PASSED, FAILED, BAD_INPUT, SUITE_ERROR, INTERRUPTED = 0, 1, 2, 3, 130
