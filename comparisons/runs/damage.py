"""What is wrong with saved data, in words."""

from __future__ import annotations

from pydantic import ValidationError


def first_fault(error: ValidationError) -> tuple[str, str]:
    """The key of the first part that is wrong, "cells.3.value", empty for the whole, and what is wrong with it."""
    first = error.errors(include_url=False, include_input=False)[0]
    return ".".join(map(str, first["loc"])), first["msg"]


def fault_words(error: Exception) -> str:
    """What is wrong with a file, in a line: of its checked parts the first, by its key."""
    return ": ".join(first_fault(error)) if isinstance(error, ValidationError) else str(error)
