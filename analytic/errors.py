"""Errors a user can cause, each a single sentence: what was expected, what was got, what to do."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class LinkproofError(Exception):
    """Root of every error that is the caller's to mend; the command line turns it into exit code 2."""


class DescriptionError(LinkproofError):
    """A linkage file that cannot be read, or that describes something impossible."""


class StructureError(LinkproofError):
    """A linkage that is not a class I crank followed by Assur groups of class II."""


class AssemblyError(LinkproofError):
    """A linkage whose links cannot meet at the crank angle asked for."""


class UnknownNameError(LinkproofError):
    """A name (mechanism, variant, engine, quantity, ...) that does not exist."""

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        choices = sorted(known)
        same = [choice for choice in choices if name and choice.lower().startswith(name.lower())]
        near = same or difflib.get_close_matches(name, choices, n=1, cutoff=0.5)
        hint = f"did you mean '{near[0]}'? " if near else ""
        super().__init__(f"unknown {kind} '{name}': {hint}known are {', '.join(choices) or 'none'}")
