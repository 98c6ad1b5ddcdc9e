"""A header in its two parts: the name and the unit, which stands in brackets, behind a sign or as a last word."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from comparisons.imported.headers.units import parsed

# "Torque (N*m)", "Torque [Nm]", "M{Nm}"; the index of an array, "r_0[1]", is part of the name.
BRACKETS: Final = re.compile(r"^(.*?)\s*[(\[{<]\s*([^()\[\]{}<>]*(?:\([^()]*\)[^()\[\]{}<>]*)?)\s*[)\]}>]\s*$")
# "M in Nm", "M / Nm", "M, Nm", "M: Nm", "torque_Nm", "Torque Nm".
SIGNS: Final = (
    re.compile(r"^(.+?)\s+in\s+(\S.*)$"),
    re.compile(r"^([^/]+?)\s*/\s*(\S.*)$"),
    re.compile(r"^(.+?)\s*[,:;]\s*(\S.*)$"),
    re.compile(r"^(.+)_([^_]+)$"),
    re.compile(r"^(.+)\s+(\S+)$"),
)
# What tells a header from an equal one before it in its table.
AGAIN: Final = re.compile(r"\s#\d+$")
LONGEST: Final = 300  # characters of a header that are looked at
NO_UNIT: Final = ("", "-", "none", "dimensionless")


@dataclass(frozen=True)
class SplitHeader:
    """A header's name and its unit as printed, "" if there is none; ``is_certain`` where brackets part them."""

    name: str
    unit: str
    is_certain: bool


def splits(header: str, unit: str) -> Iterator[SplitHeader]:
    """The ways to part a header, the likeliest first; ``unit`` is the one that the file states apart from it."""
    header = AGAIN.sub("", header[:LONGEST])
    if unit:
        yield SplitHeader(header, unit, True)
    bracket = BRACKETS.match(header)
    if bracket and not bracket[2].replace(",", "").replace(" ", "").isdigit():
        yield SplitHeader(bracket[1], "" if bracket[2].lower() in NO_UNIT else bracket[2], True)
    if unit:
        return
    for sign in SIGNS:
        match = sign.match(header)
        if match and parsed(match[2].strip("()[]")):
            yield SplitHeader(match[1], match[2].strip("()[]"), False)
    yield SplitHeader(header, "", False)
