"""Units a linkage file may state; each is converted to SI once, on reading."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from analytic.errors import UnknownNameError

UNITS: Final[Mapping[str, Mapping[str, float]]] = tomllib.loads(
    Path(__file__).with_name("units.toml").read_text(encoding="utf-8")
)


def factor(kind: str, unit: str) -> float:
    """SI value of one ``unit``; raises UnknownNameError naming the nearest known unit of that kind."""
    known = UNITS[kind]
    if unit not in known:
        raise UnknownNameError(f"{kind} unit", unit, known)
    return known[unit]


# The SI unit of each kind as reports write it.
SI: Final[Mapping[str, str]] = {
    **{"length": "m", "mass": "kg", "inertia": "kg m²", "angle": "rad", "force": "N", "torque": "N m"},
    **{"stiffness": "N/m", "damping": "N s/m", "turn_damping": "N m s"},
}


def conversion(unit: str, si: str) -> float:
    """Value in ``si`` of one ``unit``, a unit of a linkage file, or one of length or angle per ``s`` or ``s^2``.

    Power, energy and plain numbers, for which files have no unit of their own, are in SI. Raises UnknownNameError for
    a unit of another kind than ``si``.
    """
    rates = {"": "", "/s": "/s", "/s^2": "/s²"}
    known = {
        name + rate: (value, SI[kind] + written)
        for kind, table in UNITS.items()
        for name, value in table.items()
        for rate, written in rates.items()
        if not rate or kind in ("length", "angle")
    }
    fitting = {name: value for name, (value, base) in known.items() if base == si} or {si: 1.0}  # W, J, a plain number
    if unit not in fitting:
        raise UnknownNameError(f"unit of a figure in {si or 'plain numbers'}", unit, fitting)
    return fitting[unit]
