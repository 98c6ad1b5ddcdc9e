"""What numbers measure, and the units in which a linkage file may state them; each is converted to SI once."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import Final, NamedTuple

from analytic.errors import UnknownNameError


class Kind(StrEnum):
    """What a number measures: its SI unit as pages print it, and that unit's exponents of m, kg and s.

    A field of a dataclass has its kind in its annotation, ``mass: Annotated[float, Kind.MASS]``: a vector's or a
    law's is that of all its numbers. Of the driver, ``COORDINATE``, ``COORDINATE_SPEED`` and ``DRIVE`` are kinds
    until it is known whether it turns: see ``of_driver``. ``SPEED`` is the driver's as people give it, in rpm.
    """

    si: str
    exponents: tuple[int, int, int]

    def __new__(cls, name: str, si: str, *exponents: int) -> Kind:
        """Make a member from its name, which also names its unit in a file's [units], SI unit and exponents."""
        kind = str.__new__(cls, name)
        kind._value_, kind.si, kind.exponents = name, si, (exponents[0], exponents[1], exponents[2])
        return kind

    LENGTH = "length", "m", 1, 0, 0
    DIRECTION = "direction", "", 0, 0, 0
    ANGLE = "angle", "rad", 0, 0, 0
    MASS = "mass", "kg", 0, 1, 0
    INERTIA = "inertia", "kg m²", 2, 1, 0
    FORCE = "force", "N", 1, 1, -2
    TORQUE = "torque", "N m", 2, 1, -2
    STIFFNESS = "stiffness", "N/m", 0, 1, -2
    DAMPING = "damping", "N s/m", 0, 1, -1
    TURN_DAMPING = "turn_damping", "N m s", 2, 1, -1
    RATIO = "ratio", "", 0, 0, 0
    TIME = "time", "s", 0, 0, 1
    VELOCITY = "velocity", "m/s", 1, 0, -1
    ACCELERATION = "acceleration", "m/s²", 1, 0, -2
    ANGULAR_VELOCITY = "angular velocity", "rad/s", 0, 0, -1
    ANGULAR_ACCELERATION = "angular acceleration", "rad/s²", 0, 0, -2
    SPEED = "speed", "rad/s", 0, 0, -1
    COORDINATE = "coordinate", "", 0, 0, 0
    COORDINATE_SPEED = "coordinate speed", "", 0, 0, -1
    DRIVE = "drive", "", 0, 0, 0

    @property
    def unit(self) -> str:
        """The SI unit of the kind, spelt as in files: "kg*m^2"."""
        return self.si.replace(" ", "*").replace("²", "^2")

    def of_driver(self, *, is_linear: bool) -> Kind:
        """The kind that a number of the driver has; other kinds come back unchanged.

        Coordinate, its speed and drive become angle, angular velocity and torque, of a linear one length, velocity and
        force; a speed of a linear one becomes a velocity.
        """
        turning, pushed = OF_DRIVERS.get(self, (self, self))
        return pushed if is_linear else turning

    def size(self, length: float, mass: float, time: float = 1.0) -> float:
        """The SI size of this kind's unit in a system whose units of length, mass and time have these SI sizes."""
        a, b, c = self.exponents
        return float(length**a * mass**b * time**c)


OF_DRIVERS: Final[Mapping[Kind, tuple[Kind, Kind]]] = {
    Kind.SPEED: (Kind.SPEED, Kind.VELOCITY),
    Kind.COORDINATE: (Kind.ANGLE, Kind.LENGTH),
    Kind.COORDINATE_SPEED: (Kind.ANGULAR_VELOCITY, Kind.VELOCITY),
    Kind.DRIVE: (Kind.TORQUE, Kind.FORCE),
}
# The kinds for which a file states a unit, with the units that it may state.
UNITS: Final[Mapping[str, Mapping[str, float]]] = tomllib.loads(
    Path(__file__).with_name("units.toml").read_text(encoding="utf-8")
)
# An SI unit as pages print it: what is measured in it, and what follows the name of a file's unit for that.
MEASURED: Final[Mapping[str, tuple[Kind, str]]] = {
    kind.si + rate.replace("^2", "²"): (kind, rate)
    for kind in Kind
    if kind in UNITS
    for rate in (("", "/s", "/s^2") if kind in (Kind.LENGTH, Kind.ANGLE) else ("",))
}


class FileUnit(NamedTuple):
    """A unit as it is written in files, and its size in SI."""

    name: str
    size: float

    @property
    def on_page(self) -> str:
        """The unit's name as a page prints it: "N mm", "mm/s²"."""
        return self.name.replace("*", " ").replace("^2", "²")


def factor(kind: str, unit: str) -> float:
    """SI value of one ``unit`` of a kind; raises UnknownNameError, with the nearest known unit of that kind.

    Raises KeyError for a kind for which files state no unit.
    """
    known = UNITS[kind]
    if unit not in known:
        raise UnknownNameError(f"{kind} unit", unit, known)
    return known[unit]


def conversion(unit: str, si: str) -> float:
    """Value in ``si`` of one ``unit``, a unit of a linkage file, or one of length or angle per ``s`` or ``s^2``.

    ``si`` is an SI unit as pages print it, "kg m²". Power, energy and plain numbers, for which files have no unit of
    their own, are in SI. Raises UnknownNameError for a unit of another kind than ``si``.
    """
    what, fitting = f"unit of a figure in {si or 'plain numbers'}", {si: 1.0}  # W, J, a plain number
    if si in MEASURED:
        kind, rate = MEASURED[si]
        what, fitting = f"{kind} unit", {name + rate: value for name, value in UNITS[kind].items()}
    if unit not in fitting:
        raise UnknownNameError(what, unit, fitting)
    return fitting[unit]
