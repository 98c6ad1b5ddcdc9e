"""Requests of users: the declared options, the computations that they select, and exit codes."""

PASSED, FAILED, BAD_INPUT, SUITE_ERROR, INTERRUPTED = 0, 1, 2, 3, 130
