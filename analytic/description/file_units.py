"""Units for output: those of the linkage's file instead of SI."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

from analytic.description.linkage import Linkage
from analytic.description.units import factor

# SI unit: the kind of unit that a file states for it, and what follows that unit's name.
KINDS: Final = {
    "m": ("length", ""),
    "m/s": ("length", "/s"),
    "m/s²": ("length", "/s^2"),
    "rad": ("angle", ""),
    "rad/s": ("angle", "/s"),
    "rad/s²": ("angle", "/s^2"),
    "N": ("force", ""),
    "N/m": ("stiffness", ""),
    "N m": ("torque", ""),
    "kg": ("mass", ""),
    "kg m²": ("inertia", ""),
}
FILE_KINDS: Final = {
    "length": "m",
    "angle": "rad",
    "force": "N",
    "torque": "N*m",
    "stiffness": "N/m",
    "mass": "kg",
    "inertia": "kg*m^2",
}


class FileUnit(NamedTuple):
    """A unit as it is written in files, and its size in SI."""

    name: str
    size: float

    @property
    def on_page(self) -> str:
        """The unit as a page prints it: "N mm", "mm/s²"."""
        return self.name.replace("*", " ").replace("^2", "²")


def file_unit(si: str, linkage: Linkage) -> FileUnit:
    """The file's unit for an SI unit; s, J and W remain."""
    if si not in KINDS:
        return FileUnit(si, 1.0)
    kind, rest = KINDS[si]
    name = linkage.units.get(kind, FILE_KINDS[kind])
    return FileUnit(name + rest, factor(kind, name))


def in_unit(value: float, size: float) -> float:
    """An SI value in a unit of a ``size``: the shortest number that gives the value back, else the nearest."""
    near = value / size
    tried = (float(f"{near:.15g}"), near, math.nextafter(near, math.inf), math.nextafter(near, -math.inf))
    return next((number for number in tried if number * size == value), near)
