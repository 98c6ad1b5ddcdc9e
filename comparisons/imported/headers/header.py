"""A header in its two parts: the name and the unit, which stands in brackets, behind a sign or as a last word."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Final

from comparisons.imported.headers.units import parsed

# "Torque (N*m)", "Torque [Nm]", "M{Nm}"; the index of an array, "r_0[1]", is part of the name.
BRACKETS: Final = re.compile(r"^(.*?)\s*[(\[{<]\s*([^()\[\]{}<>]*(?:\([^()]*\)[^()\[\]{}<>]*)?)\s*[)\]}>]\s*$")
# "M in Nm", "M / Nm", "M, Nm", "M: Nm", "torque_Nm", "Torque Nm".
SIGNS: Final = tuple(map(re.compile, (r"^(.+?)\s+in\s+(\S.*)$", r"^([^/]+?)\s*/\s*(\S.*)$", r"^(.+?)\s*[,:;]\s*(\S.*)$",
                                      r"^(.+)_([^_]+)$", r"^(.+)\s+(\S+)$")))  # fmt: skip
AGAIN: Final = re.compile(r"\s#\d+$")  # what tells a header from an equal one before it in its table
LONGEST: Final = 300  # characters of a header that are looked at
NO_UNIT: Final = ("", "-", "none", "dimensionless")


def splits(header: str, unit: str) -> Iterator[tuple[str, str]]:
    """Name and unit of a header, the likeliest first, "" for none; ``unit`` is that which the file states apart."""
    header = AGAIN.sub("", header[:LONGEST])
    bracket = BRACKETS.match(header)
    if bracket and bracket[2].replace(",", "").replace(" ", "").isdigit():
        bracket = None
    if unit:
        yield header, unit
    if bracket:
        yield bracket[1], "" if bracket[2].lower() in NO_UNIT else bracket[2]
    for sign in SIGNS if not unit else ():
        match = sign.match(header)
        if match and parsed(match[2].strip("()[]")):
            yield match[1], match[2].strip("()[]")
    if not unit:
        yield header, ""
