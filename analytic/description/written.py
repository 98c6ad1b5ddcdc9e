"""Numbers and units as they are written: in the units of the linkage's file instead of SI, and as text.

A number that is rounded to zero has no sign.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import RPM
from analytic.description.linkage import Linkage
from analytic.description.units import MEASURED, UNITS, FileUnit, Kind, factor


def file_unit(si: str, linkage: Linkage) -> FileUnit:
    """The file's unit that takes the place of an SI unit, as pages print this, "m/s²": "mm/s^2".

    Units without one in files, such as J, stay; where the file states none it is SI.
    """
    if si not in MEASURED:
        return FileUnit(si, 1.0)
    kind, rate = MEASURED[si]
    name = linkage.units.get(kind, kind.unit)
    return FileUnit(name + rate, factor(kind, name))


def kind_unit(kind: Kind, units: Mapping[str, str]) -> FileUnit:
    """The unit in which a file, which states ``units`` by kind, has a kind of number; SI where it states none.

    Speeds of a crank are in rpm, velocities in the unit of length per s. Raises UnknownNameError for an unknown unit.
    """
    if kind is Kind.SPEED:
        return FileUnit("rpm", RPM)
    base, rate = (Kind.LENGTH, "/s") if kind is Kind.VELOCITY else (kind, "")
    name = units.get(base, base.unit)
    return FileUnit(name + rate, factor(base, name) if base in UNITS else 1.0)


def in_unit(value: float, size: float) -> float:
    """An SI value in a unit of a ``size``: the shortest number that gives the value back, else the nearest."""
    near = value / size
    tried = (float(f"{near:.15g}"), near, math.nextafter(near, math.inf), math.nextafter(near, -math.inf))
    return next((number for number in tried if number * size == value), near)


def finite(value: float) -> float | None:
    """The number; None if it is not finite."""
    return value if math.isfinite(value) else None


def plain(values: NDArray[np.float64]) -> list[float | None]:
    """Numbers (n,) as a list for JSON, None in place of nan and infinity."""
    return [finite(value) for value in values.tolist()]


def fixed(value: float, digits: int) -> str:
    """A number as text with this many decimals; never "-0"."""
    return f"{value:z.{digits}f}"


def signed(value: float, form: str) -> str:
    """A difference as text with its sign, in a format such as ".2f"; without a sign if it rounds to zero."""
    text = f"{value:+{form}}"
    return text if text.strip("+-0.e%") else text[1:]


def change(share: float, form: str = ".2f") -> str:
    """A relative change, a share, as text in per cent, with its sign, "+1.25 %"; ``form`` is the number's format."""
    return f"{signed(100.0 * share, form)} %"


def csv_text(text: str) -> str:
    """A name as a cell of a CSV table: an apostrophe precedes names that a spreadsheet would take for formulas."""
    return f"'{text}" if text.startswith(("=", "+", "-", "@")) else text
