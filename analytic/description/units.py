"""Units a linkage file may state; each is converted to SI once, on reading."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final

from analytic.errors import UnknownNameError

UNITS: Final[Mapping[str, Mapping[str, float]]] = {
    "length": {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": 0.0254},
    "mass": {"kg": 1.0, "g": 1e-3, "mg": 1e-6, "t": 1e3, "lb": 0.45359237},
    "inertia": {"kg*m^2": 1.0, "kg*cm^2": 1e-4, "kg*mm^2": 1e-6, "g*m^2": 1e-3, "g*cm^2": 1e-7, "g*mm^2": 1e-9},
    "angle": {"rad": 1.0, "deg": math.pi / 180.0},
    "force": {"N": 1.0, "mN": 1e-3, "kN": 1e3},
    "torque": {"N*m": 1.0, "N*mm": 1e-3, "mN*m": 1e-3, "kN*m": 1e3},
    "stiffness": {"N/m": 1.0, "N/mm": 1e3, "kN/m": 1e3},
    "damping": {"N*s/m": 1.0, "N*s/mm": 1e3},
    "turn_damping": {"N*m*s": 1.0, "N*m*s/rad": 1.0, "N*mm*s": 1e-3},
}


def factor(kind: str, unit: str) -> float:
    """SI value of one ``unit``; raises UnknownNameError naming the nearest known unit of that kind."""
    known = UNITS[kind]
    if unit not in known:
        raise UnknownNameError(f"{kind} unit", unit, known)
    return known[unit]
