"""Commands and options of linkproof 1.0 that are gone, each with what to do instead, in a sentence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from itertools import pairwise
from pathlib import Path

TEXT = Path(__file__).parents[1] / "templates" / "gone.txt"


@cache
def _answers() -> Mapping[str, str]:
    """The answer for each command and option that is gone, by its words."""
    return dict(line.split(": ", 1) for line in TEXT.read_text(encoding="utf-8").splitlines())


def answer_to_command(name: str) -> str:
    """The sentence about a command that is gone; empty for any other."""
    return f"{name}: {_answers()[name]}" if name in _answers() else ""


def answer_to_option(command: str, option: str) -> str:
    """The sentence about an option of a command that is gone; empty for any other."""
    answer = _answers().get(f"{command} {option}", _answers().get(option))
    return f"{option}: {answer}" if answer else ""


def answer_to_json_file(words: Sequence[str]) -> str:
    """The sentence about a file, or "-", typed after --json, which is now a flag; "" without one."""
    files = (file for word, file in pairwise(words) if word == "--json")
    return next((answer_to_option("", "--json") for file in files if file == "-" or file.lower().endswith(".json")), "")
