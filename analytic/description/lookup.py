"""Looking things up in a validated document: SI values, laws over φ, and which bodies carry a point."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from analytic.description import schema as doc
from analytic.description.diagnosis import Source
from analytic.description.law import FULL_TURN, Law
from analytic.description.linkage import GROUND, Vector, unit
from analytic.description.units import UNITS, factor
from analytic.errors import DescriptionError, UnknownNameError, listed

# SI magnitudes outside 1e±60 are slips of the pen, and products of four of them would leave the range of a double.
LARGEST: Final = 1e60
LEAST_STEP: Final = 1e-6  # rad between the angles of a law: nearer ones are one angle written twice


@dataclass(frozen=True)
class Reader:
    """A document with its units as SI factors."""

    document: doc.Document
    source: Source
    scale: dict[str, float]

    def fail(self, message: str) -> DescriptionError:
        """The error to raise about this file; the message begins with the key at fault."""
        return self.source.fault(message)

    def number(self, value: float, kind: str, where: str) -> float:
        """A number of a kind of unit in SI."""
        return self.magnitude(value * self.scale[kind], where, f"{value:g} {getattr(self.document.units, kind)}")

    def weight(self, value: float, kind: str, where: str) -> float:
        """A mass or an inertia in SI: zero only where it is written as zero."""
        si = self.number(value, kind, where)
        if value and not si:
            raise self._out_of_range(where, f"{value:g} {getattr(self.document.units, kind)}")
        return si

    def magnitude(self, si: float, where: str, written: str) -> float:
        """An SI number, 0 where it is negligibly small; raises DescriptionError where it is too large or too small."""
        if abs(si) > LARGEST:
            raise self._out_of_range(where, written)
        return si if abs(si) >= 1.0 / LARGEST else 0.0

    def _out_of_range(self, where: str, written: str) -> DescriptionError:
        """The error for a number too large or too small to compute with."""
        return self.fail(
            f"{where}: expected a magnitude between {1.0 / LARGEST:g} and {LARGEST:g} in SI units, got {written}; "
            "correct the number or the unit"
        )

    @property
    def is_linear(self) -> bool:
        """Whether the driver is pushed along a line, so that its coordinate φ is a length and its drive a force."""
        if self.document.cylinder is not None:
            return True
        driver = self.document.links.get(self.document.crank)
        return driver is not None and driver.slides is not None and driver.slides.on == GROUND

    @property
    def coordinate(self) -> str:
        """The kind of unit of φ."""
        return "length" if self.is_linear else "angle"

    @property
    def drive(self) -> str:
        """The kind of unit of the drive: a torque, or a force."""
        return "force" if self.is_linear else "torque"

    def vector(self, place: doc.Place, where: str) -> Vector:
        """A point in m."""
        if isinstance(place, doc.Polar):
            radius = self.number(place.radius, "length", where)
            angle = place.angle * self.scale["angle"]
            about = [self.number(part, "length", where) for part in place.about]
            return (about[0] + radius * math.cos(angle), about[1] + radius * math.sin(angle))
        return (self.number(place[0], "length", where), self.number(place[1], "length", where))

    def direction(self, pair: tuple[float, float], where: str) -> Vector:
        """A unit vector; its given length does not matter."""
        if pair == (0.0, 0.0):
            raise self.fail(f"{where}.along: expected a direction [x, y], got [0, 0]; give a vector along the line")
        largest = max(abs(pair[0]), abs(pair[1]))
        return unit((pair[0] / largest, pair[1] / largest))

    def points(self, link: str) -> dict[str, doc.Place]:
        """Named points of a link; a slider's own point sits at its origin unless it says otherwise."""
        table = self.document.links[link]
        if table.slides is not None and table.slides.point not in table.points:
            return {table.slides.point: (0.0, 0.0), **table.points}
        return table.points

    @cached_property
    def carriers(self) -> dict[str, list[str]]:
        """The bodies that carry each named point, sorted, the ground included; points in order of their names."""
        carriers: dict[str, list[str]] = defaultdict(list)
        for point in self.document.ground:
            carriers[point].append(GROUND)
        for name in self.document.links:
            for point in self.points(name):
                carriers[point].append(name)
        return {point: sorted(names) for point, names in sorted(carriers.items())}

    def owner(self, point: str, named: str | None, where: str) -> str:
        """The body that carries a point: ``named`` where that is given, else the only one; raises DescriptionError."""
        owners = self.carriers.get(point)
        if owners is None:
            raise self.fail(f"{where}: {UnknownNameError('point', point, self.carriers)}")
        if named is not None and named not in owners:
            raise self.fail(
                f"{where}: expected a body that carries '{point}' ({listed(owners)}), got '{named}'; correct it"
            )
        moving = [name for name in owners if name != GROUND]
        if named is None and GROUND not in owners and len(moving) > 1:
            raise self.fail(
                f"{where}: expected one link to take the load, got point '{point}' of {listed(moving)}; name one of "
                "them with link = ... (links = [...] for a spring)"
            )
        return named or (GROUND if GROUND in owners else moving[0])

    def body(self, name: str, where: str) -> str:
        """A link's name or the ground, checked."""
        if name != GROUND and name not in self.document.links:
            raise self.fail(f"{where}: {UnknownNameError('link', name, [*self.document.links, GROUND])}")
        return name


def reader_of(document: doc.Document, source: Source) -> Reader:
    """A reader of the document, with its units as SI factors."""
    scale = {}
    for kind in UNITS:
        try:
            scale[kind] = factor(kind, getattr(document.units, kind))
        except UnknownNameError as error:
            raise DescriptionError(source.place(f"units.{kind}: {error}")) from error
    return Reader(document, source, scale)


# Laws over φ.


def interpolated_law(
    reader: Reader, table: doc.ForceTable | doc.TorqueTable, rows: Sequence[tuple[float, ...]], kind: str, where: str
) -> Law:
    """The law of a force or torque, by a spline or by straight lines as the table says."""
    law = _law(reader, rows, table.angle, kind, where)
    if table.interpolation and law.is_constant:
        raise reader.fail(
            f"{where}.interpolation: expected a list of values over angle = [...] beside it, got one value; leave it "
            "out"
        )
    return replace(law, linear=table.interpolation == "linear")


def law_over_angle(reader: Reader, values: list[float], angles: list[float], kind: str, where: str) -> Law:
    """The law of one component through values at angles, both in the file's units."""
    return _law(reader, [(value,) for value in values], angles, kind, where)


def _law(reader: Reader, rows: Sequence[tuple[float, ...]], angles: list[float] | None, kind: str, where: str) -> Law:
    """The law through rows of components; one row without angles is a constant."""
    table = np.array([[reader.number(value, kind, f"{where}.{kind}") for value in row] for row in rows], dtype=float)
    if angles is None:
        if len(table) != 1:
            raise reader.fail(
                f"{where}: expected one value, or angle = [...] with as many angles as values, got {len(table)} values "
                "and no angles; add angle"
            )
        return Law(table[0])
    phi = np.asarray(angles, dtype=float) * reader.scale[reader.coordinate]
    periodic = not reader.is_linear
    if len(table) != len(phi) or len(phi) < 3:
        raise reader.fail(
            f"{where}: expected as many values as angles and at least 3 of each, got {len(table)} values and "
            f"{len(phi)} angles; complete the shorter list"
        )
    if np.any(np.diff(phi) < LEAST_STEP) or (periodic and phi[-1] - phi[0] >= FULL_TURN):
        if not periodic:
            raise reader.fail(
                f"{where}.angle: expected increasing travels of the driver, got steps of {min(np.diff(angles)):g} "
                f"{reader.document.units.length} and more; sort them"
            )
        raise reader.fail(
            f"{where}.angle: expected increasing angles that span less than one turn, since the law repeats with the "
            f"turn, got {angles[0]:g} to {angles[-1]:g} in steps of "
            f"{min(np.diff(angles)):g} and more; sort them, and leave out a last one that repeats the first"
        )
    return Law(table, phi, periodic)
