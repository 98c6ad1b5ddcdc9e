"""Numbers as they are printed: a number that is rounded to zero has no sign."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray


def finite(value: float) -> float | None:
    """The number; None if it is not finite."""
    return value if math.isfinite(value) else None


def plain(values: NDArray[np.float64]) -> list[float | None]:
    """Numbers as a list for JSON, None in place of nan and infinity."""
    return [finite(value) for value in values.tolist()]


def fixed(value: float, digits: int) -> str:
    """A number as text, with so many decimals; never "-0"."""
    return f"{value:z.{digits}f}"


def signed(value: float, form: str) -> str:
    """A difference with its sign, in a format such as ".2f"; without a sign where it is rounded to zero."""
    text = f"{value:+{form}}"
    return text if text.strip("+-0.e%") else text[1:]


def change(share: float, form: str = ".2f") -> str:
    """A relative change in per cent."""
    return f"{signed(100.0 * share, form)} %"


def csv_text(text: str) -> str:
    """A name as a cell of a CSV table: an apostrophe precedes names that a spreadsheet would take for formulas."""
    return f"'{text}" if text.startswith(("=", "+", "-", "@")) else text
