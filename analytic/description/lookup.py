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
from analytic.description.linkage import GROUND, DriverCoordinate, DriverKind, Vector, driver_coordinate
from analytic.description.units import UNITS, FileUnit, Kind, factor
from analytic.description.walk import Keys, unit_vector, walk, with_values
from analytic.description.written import kind_unit
from analytic.errors import DescriptionError, UnknownNameError, listed

# SI magnitudes outside 1e±60 are slips of the pen, and products of four of them would leave the range of a double.
LARGEST: Final = 1e60
ROUNDED: Final = 4e-16  # of a cosine or sine: what a quarter of a turn, rounded, leaves of zero
LEAST_STEP: Final = 1e-6  # rad between the angles of a law: nearer ones are one angle written twice


@dataclass(frozen=True)
class Reader:
    """A document with all its numbers in SI, and its driver's coordinate."""

    document: doc.Document
    source: Source
    phi: DriverCoordinate

    def fail(self, message: str) -> DescriptionError:
        """The DescriptionError about this file, for the caller to raise; the message begins with the key at fault."""
        return self.source.fault(message)

    def unit(self, kind: Kind) -> FileUnit:
        """The file's unit for a kind of number, of the driver's kind where that depends on the driver."""
        return kind_unit(self.phi.kind(kind), self.units)

    @cached_property
    def units(self) -> dict[str, str]:
        """Names of the file's units, by kind."""
        return self.document.units.model_dump()

    def direction(self, pair: tuple[float, float], where: str) -> Vector:
        """A direction as a unit vector; raises DescriptionError, at the key ``where``.along, for one without length."""
        if pair == (0.0, 0.0):
            raise self.fail(f"{where}.along: expected a direction [x, y], got [0, 0]; give a vector along the line")
        largest = max(abs(pair[0]), abs(pair[1]))
        return unit_vector((pair[0] / largest, pair[1] / largest))

    def points(self, link: str) -> dict[str, doc.Place]:
        """Named points of a link, as written; a slider's own point sits at its origin unless it says otherwise.

        Raises KeyError for an unknown link.
        """
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

    def owner(self, point: str, named: str | None, where: str, key: str = "link = ...") -> str:
        """The body that carries a point: ``named`` if given, else the ground if it has the point, else the only link.

        ``where`` is the key at fault and ``key`` what gives ``named`` in the file, both for the message. Raises
        DescriptionError for an unknown point, another body, or several links.
        """
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
                f"them with {key}"
            )
        return named or (GROUND if GROUND in owners else moving[0])

    def body(self, name: str, where: str) -> str:
        """The name itself of a link or of the ground.

        Raises DescriptionError, which begins with the key ``where``, if there is none of this name.
        """
        if name != GROUND and name not in self.document.links:
            raise self.fail(f"{where}: {UnknownNameError('link', name, [*self.document.links, GROUND])}")
        return name


def position(place: doc.Place) -> Vector:
    """The Cartesian coordinates of a point that may be given by polar ones, in the same unit, angles in rad.

    A sine or cosine that is zero to rounding counts as zero.
    """
    if not isinstance(place, doc.Polar):
        return place
    x, y = place.about
    parts = (math.cos(place.angle), math.sin(place.angle))
    c, s = (0.0 if abs(part) < ROUNDED else part for part in parts)  # a quarter of a turn, π/2 being rounded
    return x + place.radius * c, y + place.radius * s


def reader_of(document: doc.Document, source: Source) -> Reader:
    """A reader of a copy of the document with SI numbers.

    Raises DescriptionError for an unknown unit or a number out of range.
    """
    for name in UNITS:
        try:
            factor(name, getattr(document.units, name))
        except UnknownNameError as error:
            raise DescriptionError(source.place(f"units.{name}: {error}")) from error
    driver = document.links.get(document.crank)
    slides = driver is not None and driver.slides is not None and driver.slides.on == GROUND
    pushed = DriverKind.SLIDER if slides else DriverKind.CRANK
    kind = pushed if document.cylinder is None else DriverKind.CYLINDER
    reader = Reader(document, source, driver_coordinate(kind, document.units.length))
    return replace(reader, document=with_values(document, _si_values(reader)))


def _si_values(reader: Reader) -> dict[Keys, float]:
    """The numbers of a file whose SI value differs, by their keys; negligibly small ones become 0.

    Raises DescriptionError for one too large, or a mass or inertia too small.
    """
    values = {}
    for path, kind, value in walk(reader.document):
        unit = reader.unit(kind)
        si = value * unit.size
        if abs(si) < 1.0 / LARGEST:
            si = 0.0
        if abs(si) > LARGEST or (kind in (Kind.MASS, Kind.INERTIA) and value and not si):
            keys = path[: 1 + max(n for n, key in enumerate(path) if isinstance(key, str))]  # without components
            keys = (*keys[:2], "from") if keys[::2] == ("regimes", "begin") else keys
            raise reader.fail(
                f"{'.'.join(map(str, keys))}: expected a magnitude between {1.0 / LARGEST:g} and {LARGEST:g} in SI "
                f"units, got {value:g} {unit.name}; correct the number or the unit"
            )
        if si != value or math.copysign(1.0, value) < 0.0:  # a default, which is 0, stays what the file does not give
            values[path] = si
    return values


# Laws over φ.


def interpolated_law(
    reader: Reader, table: doc.ForceTable | doc.TorqueTable, rows: Sequence[tuple[float, ...]], where: str
) -> Law:
    """The law of a force or torque, SI, by a spline or by straight lines as its table says.

    ``rows`` are its values, SI, a tuple of components for each, ``where`` its key in the file, for messages. Raises
    DescriptionError for keys that do not go together, and as ``law_over_angle`` does for wrong lists.
    """
    is_over_travel = table.over == "S"
    if (is_over_travel or table.when) and (reader.phi.is_linear or reader.document.output is None):
        key = "over" if is_over_travel else "when"
        cure = (
            "give the load over the driver's travel, with angle" if reader.phi.is_linear else "add output = { point }"
        )
        raise reader.fail(
            f"{where}.{key}: expected an output that a turning crank moves, got none, so the load has no "
            f"travel and no direction; {cure}"
        )
    places, other = (table.travel, "angle") if is_over_travel else (table.angle, "travel")
    if getattr(table, other) is not None or (is_over_travel and places is None):
        wanted = "travel = [...] with over = 'S', angle = [...] without" if not is_over_travel else "travel = [...]"
        raise reader.fail(f"{where}.{other if places is None else 'over'}: expected {wanted}; correct it")
    law = law_over_angle(reader, rows, places, where, period=_period(reader, table, where))
    for key in ("interpolation", "period"):
        if getattr(table, key) and law.angles is None:
            raise reader.fail(
                f"{where}.{key}: expected a list of values over angle = [...] beside it, got one value; leave it out"
            )
    return replace(law, linear=table.interpolation == "linear", over=table.over, when=table.when)


def _period(reader: Reader, table: doc.LoadTable, where: str) -> float | None:
    """The period of a load's table, rad, of one turn or two; None if it is over a travel.

    Raises DescriptionError for others, and for a period over a travel; ``where`` is the load's key, for messages.
    """
    if reader.phi.is_linear or table.over == "S":
        if table.period is not None:
            raise reader.fail(f"{where}.period: expected no period of a load over a travel; leave it out")
        return None
    turns = 1.0 if table.period is None else table.period / FULL_TURN
    if not any(abs(turns - whole) < LEAST_STEP for whole in (1.0, 2.0)):
        raise reader.fail(f"{where}.period: expected one turn or two, got {turns:.4g} turns; write 360 or 720 degrees")
    return round(turns) * FULL_TURN


def law_over_angle(
    reader: Reader,
    rows: Sequence[tuple[float, ...]],
    angles: list[float] | None,
    where: str,
    *,
    period: float | None = FULL_TURN,
) -> Law:
    """The law through rows of components at ``angles``, rad, increasing, at least 3.

    One row without angles is a constant. With ``period`` None they are travels, m. Raises DescriptionError, which
    begins with ``where``, the rows' place in the file, for lists of other lengths, fewer than 3 angles, and angles that
    do not increase or span a period.
    """
    table = np.array(rows, dtype=float)
    if angles is None:
        if len(table) != 1:
            raise reader.fail(
                f"{where}: expected one value, or angle = [...] with as many angles as values, got {len(table)} values "
                "and no angles; add angle"
            )
        return Law(table[0])
    phi, angle_unit = np.asarray(angles, dtype=float), reader.unit(Kind.COORDINATE if period else Kind.LENGTH)
    written = phi / angle_unit.size
    if len(table) != len(phi) or len(phi) < 3:
        raise reader.fail(
            f"{where}: expected as many values as angles and at least 3 of each, got {len(table)} values and "
            f"{len(phi)} angles; complete the shorter list"
        )
    if np.any(np.diff(phi) < LEAST_STEP) or (period and phi[-1] - phi[0] >= period):
        if not period:
            raise reader.fail(
                f"{where}: expected increasing travels, got steps of {min(np.diff(written)):g} {angle_unit.name} and "
                "more; sort them"
            )
        turns = "one turn" if period == FULL_TURN else "two turns"
        raise reader.fail(
            f"{where}.angle: expected increasing angles that span less than {turns}, after which the law repeats, "
            f"got {written[0]:g} to {written[-1]:g} in steps of "
            f"{min(np.diff(written)):g} and more; sort them, and leave out a last one that repeats the first"
        )
    return Law(table, phi, period)
