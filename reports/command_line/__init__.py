"""The commands: words in, exit codes out."""

PASSED, FAILED, BAD_INPUT, SUITE_ERROR, INTERRUPTED = 0, 1, 2, 3, 130
