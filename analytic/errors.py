"""Errors that a user can cause, each a single sentence: the expected value, the actual value, the remedy."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from typing import Final

MOST_NAMES: Final = 30  # of a list in a message
NEAREST: Final = 3  # of the names that one is taken for
LONGEST_NAME: Final = 60  # characters of a name or value worth repeating
LONGEST: Final = 1500  # characters of a message
SIMILAR: Final = 0.6  # share of equal characters from which one name is taken for a misspelling of another


# Words that are accepted in the place of a symbol.
WORDS: Final[Mapping[str, str]] = {
    "torque": "Mkr", "power": "Peq", "energy": "Teq", "inertia": "Jeq", "displacement": "S",
}  # fmt: skip
# Symbols of quantities by the words a user may try in their place.
SYMBOLS: Final[Mapping[str, str]] = {
    "torque": "Mkr",
    "moment": "Mkr",
    "power": "Peq",
    "energy": "Teq",
    "inertia": "Jeq",
    "stroke": "S",
    "position": "S",
    "displacement": "S",
    "velocity": "v",
    "speed": "v",
    "acceleration": "a",
    "force": "joint_force",
    "forces": "joint_force",
}


class LinkproofError(Exception):
    """Base class of every error that the caller can correct; the command line turns it into exit code 2."""

    def __str__(self) -> str:
        """The message, safe to print: control characters escaped, the middle left out beyond 1500 characters."""
        text = printable(super().__str__())
        return text if len(text) <= LONGEST else f"{text[: LONGEST - 500]} ... {text[-495:]}"


class DescriptionError(LinkproofError):
    """A linkage file that cannot be read, or that describes something impossible."""


class StructureError(LinkproofError):
    """A linkage that is no driver followed by Assur groups, or whose sketch leaves a group's configuration open.

    ``so_far`` is the structural formula of the groups before the fault, "" in the second case.
    """

    so_far: str = ""


class AssemblyError(LinkproofError):
    """A linkage whose links cannot meet, or cannot move on, at the given crank angle or over the motion asked for."""


def symbol(name: str) -> str:
    """A signal's or figure's name with its first word replaced by the symbol: ``torque.peak`` becomes ``Mkr.peak``.

    The word ends at the first "." or "@"; a name that begins with none of ``WORDS`` stays as it is.
    """
    ends = [place for place in (name.find("."), name.find("@")) if place >= 0]
    word = name[: min(ends, default=len(name))]
    return WORDS.get(word, word) + name[len(word) :]


def install_words(extra: str) -> str:
    """The shell command that installs an extra, by name, into this installation.

    It fits an installation from an index, a file or a checkout.
    """
    import json  # noqa: PLC0415 - an error is rare
    from importlib import metadata  # noqa: PLC0415
    from urllib.parse import unquote, urlsplit  # noqa: PLC0415

    with suppress(metadata.PackageNotFoundError, ValueError):
        origin = json.loads(metadata.distribution("linkproof").read_text("direct_url.json") or "{}")
        if str(origin.get("url", "")).startswith("file:"):
            flag = "-e " if origin.get("dir_info", {}).get("editable") else ""
            return f"pip install {flag}'{unquote(urlsplit(origin['url']).path)}[{extra}]'"
    return f"pip install 'linkproof[{extra}]'"


class UnknownNameError(LinkproofError):
    """A name (mechanism, variant, engine, quantity, ...) that does not exist.

    ``where`` names the command that lists the ``known`` names; if it is empty the message lists them.
    """

    def __init__(self, kind: str, name: str, known: Iterable[str], where: str = "") -> None:
        """Compose the message: the unknown name, the nearest of the ``known`` ones, and all of these or ``where``.

        ``kind`` is the word for what the name should be, such as "signal".
        """
        choices = sorted(set(known))
        meant, many = SYMBOLS.get(name.lower()), NEAREST if len(choices) > MOST_NAMES else 1
        words = [WORDS[word] for word in _similar_names(name, [*WORDS]) if WORDS[word] in choices]
        near = [meant] if meant in choices else (_similar_names(name, choices) or words)[:many]
        meanings = "' or '".join(near)
        hint = f"did you mean '{meanings}'? " if near else ""
        super().__init__(f"unknown {kind} '{shortened(name)}': {hint}known are {where or listed(choices)}")


def _similar_names(name: str, choices: Sequence[str]) -> list[str]:
    """Those ``choices`` that begin with a name, capitals or not.

    If there are none, up to three close in spelling, the nearest first; if none is, those that differ in one letter.
    An overlong name gets none of these two kinds, and an overlong choice is not among them.
    """
    begun = [choice for choice in choices if name and choice.lower().startswith(name.lower())]
    if begun or len(name) > LONGEST_NAME:
        return begun
    by_spelling = {choice.lower(): choice for choice in choices if len(choice) <= LONGEST_NAME}
    near = difflib.get_close_matches(name.lower(), by_spelling, n=NEAREST, cutoff=SIMILAR)
    near = near or [choice for choice in by_spelling if _differ_by_a_letter(name.lower(), choice)]
    return [by_spelling[key] for key in near]


def _differ_by_a_letter(name: str, other: str) -> bool:
    """Whether two names of one length, at least two letters, differ in exactly one letter."""
    same = sum(a == b for a, b in zip(name, other, strict=False))
    return len(name) == len(other) == same + 1 > 1


def listed(names: Iterable[str]) -> str:
    """Names as an enumeration for a sentence, each shortened; "none" without any.

    Of more than 30 it has the first 30 and the number of the others.
    """
    every = list(names)
    more = f" and {len(every) - MOST_NAMES} more" if len(every) > MOST_NAMES else ""
    return ", ".join(map(shortened, every[:MOST_NAMES])) + more or "none"


def shortened(text: str) -> str:
    """A text for a message, cut to 60 characters and "..." if it is longer."""
    return text if len(text) <= LONGEST_NAME else f"{text[:LONGEST_NAME]}..."


def is_safe(character: str) -> bool:
    """Whether a character changes nothing but its own place on a terminal.

    A control character, a mark of the writing direction or a surrogate is not safe.
    """
    return character.isprintable() or not (
        character < " " or "\x7f" <= character <= "\x9f" or "\u202a" <= character <= "\u202e"
        or "\u2066" <= character <= "\u2069" or "\ud800" <= character <= "\udfff"
    )  # fmt: skip


def printable(text: str) -> str:
    """A text with every character that is not safe, line ends among them, escaped, so that it stays on one line."""
    if text.isprintable():
        return text
    return "".join(c if is_safe(c) else c.encode("unicode_escape").decode() for c in text)
