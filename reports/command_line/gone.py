"""Commands and options of linkproof 1.0 that are gone, each with what to do instead, in a sentence."""

from __future__ import annotations

from pathlib import Path

from analytic.errors import LinkproofError

TEXT = Path(__file__).parents[1] / "templates" / "gone.txt"


def refuse(name: str, command: str = "") -> None:
    """Raise LinkproofError for a command, or an option of a ``command``, that is gone; do nothing for any other."""
    answers = dict(line.split(": ", 1) for line in TEXT.read_text(encoding="utf-8").splitlines())
    answer = answers.get(f"{command} {name}", answers.get(name))
    if answer:
        raise LinkproofError(f"{name}: {answer}")
