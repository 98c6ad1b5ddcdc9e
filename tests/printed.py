"""Printed text compared as a reader does: words to the letter, numbers to a unit of the last digit that is printed.

Which way a number is rounded, and whether a zero bears a sign, may hang on the last bit of one processor.
"""

from __future__ import annotations

import re
from decimal import Decimal

NUMBER = re.compile(r"[-−+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
SEARCHED = re.compile(r"(?<=Evaluated: )\d+")  # how far a search went, which its roundings decide
ROUNDING = Decimal("1e-9")  # numbers with an exponent below it are roundings of zero


def is_same(text: str, other: str) -> bool:
    """Whether two texts differ in nothing but the last digits of numbers that are no counts, and their width."""
    text, other = (SEARCHED.sub("", one) for one in (text, other))
    numbers = NUMBER.findall(text), NUMBER.findall(other)
    if numbers[0] == numbers[1]:
        return text == other
    return words(text) == words(other) and all(map(_is_close, *numbers))


def words(text: str) -> str:
    """A text without its numbers, and without the room that they take."""
    return " ".join(NUMBER.sub("#", text).split())


def _is_close(one: str, other: str) -> bool:
    first, second = (Decimal(number.replace("−", "-")) for number in (one, other))
    if "e" in one + other and max(abs(first), abs(second)) < ROUNDING:
        return True
    unit = max(Decimal(1).scaleb(number.as_tuple().exponent) for number in (first, second))
    is_count = not set(".e") & set(one + other)
    return abs(first - second) <= (0 if is_count else unit)
