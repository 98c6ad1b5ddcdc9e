"""Printed numbers: their values, and half a unit of the last digit that is printed of each."""

from __future__ import annotations

import re
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

NUMBER: Final = re.compile(r"[+-]?(?:[0-9]++\.?[0-9]*+|\.[0-9]++)(?:[eEdD][+-]?[0-9]{1,3})?")
LONGEST: Final = 60  # characters of a number
LARGEST: Final = 1e100  # of a number: squares of larger ones are beyond all numbers
MOST_DIGITS: Final = 17  # of a double: more say nothing
SMALLEST: Final = 400  # decimals of the smallest double, and more


def is_number(word: str) -> bool:
    """Whether a word is a finite number with a decimal point."""
    plain = word.replace("d", "e").replace("D", "e")
    return len(word) <= LONGEST and NUMBER.fullmatch(word) is not None and abs(float(plain)) < LARGEST


def parse(words: list[str]) -> tuple[Array, Array] | None:
    """Values (n,) and decimals (n,) of numbers with a decimal point; None if any is no finite number.

    Decimals count from the point to the last printed digit, less the exponent: 3 for 0.125 and for 12.5e-2.
    """
    try:
        values = np.array(words, dtype=np.float64)
    except ValueError:
        return _slowly(words)
    if not (np.abs(values) < LARGEST).all() or not all(map(str.isascii, words)):
        return None
    text = np.array(words, dtype=np.bytes_)
    return values, _decimals(text)


def _slowly(words: list[str]) -> tuple[Array, Array] | None:
    """Numbers with an exponent written as in Fortran."""
    if not all(map(NUMBER.fullmatch, words)):
        return None
    plain = [word.replace("d", "e").replace("D", "e") for word in words]
    values = np.array(plain, dtype=np.float64)
    return (values, _decimals(np.array(plain, dtype=np.bytes_))) if (np.abs(values) < LARGEST).all() else None


def _decimals(text: NDArray[np.bytes_]) -> Array:
    """Decimals of every number of ``text`` (n,), each of which has at most one point and one exponent."""
    width = text.dtype.itemsize
    flat = text.view(np.uint8)
    end = np.char.str_len(text).astype(np.int64)
    exponent = np.zeros(len(text), dtype=np.int64)
    rows, columns = np.divmod(np.flatnonzero((flat == ord("e")) | (flat == ord("E"))), width)
    if len(rows):
        exponent[rows] = _exponents(flat.reshape(-1, width)[rows], columns)
        end[rows] = columns
    fraction = np.zeros(len(text), dtype=np.int64)
    rows, columns = np.divmod(np.flatnonzero(flat == ord(".")), width)
    fraction[rows] = end[rows] - columns - 1
    return np.asarray(fraction - exponent, dtype=np.float64)


def _exponents(characters: NDArray[np.uint8], at: Integers) -> Integers:
    """The integers behind the letters at the columns ``at`` (n,) of the rows of ``characters`` (n, width)."""
    value, sign = np.zeros(len(at), dtype=np.int64), np.ones(len(at), dtype=np.int64)
    rows = np.arange(len(at))
    padded = np.pad(characters, ((0, 0), (0, 6)))
    for behind in range(1, 6):  # a sign and at most three digits
        character = padded[rows, at + behind].astype(np.int64)
        digit = character - ord("0")
        value = np.where((digit >= 0) & (digit <= 9), 10 * value + digit, value)
        sign = np.where(character == ord("-"), -1, sign)
    return sign * value


def resolution(values: Array, decimals: Array) -> Array:
    """Half a unit of the last digit of each number of a column (n,).

    Where trailing zeros are left out, as by ``%g``, a short number is as sharp as the column's other numbers: it has
    their decimals or their number of digits, whichever is coarser.
    """
    with np.errstate(divide="ignore"):
        magnitude = np.where(values == 0.0, -SMALLEST, np.floor(np.log10(np.abs(values))))
    digits = min(float(np.max(np.where(values == 0.0, 1.0, magnitude + 1.0 + decimals))), MOST_DIGITS)
    sharpest = float(np.max(decimals))
    hidden = np.minimum(sharpest, digits - magnitude - 1.0)
    return np.asarray(0.5 * 10.0 ** -np.clip(np.maximum(decimals, hidden), -300, 300))
