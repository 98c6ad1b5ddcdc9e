"""Any linkage as flat tables of numbers, for kernels that are compiled once for all linkages.

It has no names and no objects: integer tables say which body, joint and quantity goes where, one vector of
floats holds the linkage's own numbers as they stand in its description. Constants derived from them (arm lengths,
offsets) are not in it, so a changed design is nothing but another vector.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import changed
from analytic.description.law import Law
from analytic.description.linkage import GROUND, Guide, Linkage, Vector
from analytic.dynamics.derivative_orders import needs
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.structure import KINDS, Dyad, Joint, Revolute, Structure

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

# Kind codes of dyads in ``Tables.dyads``.
RRR, RRP, RPR, RPP, PRP = range(len(KINDS))

# Bodies are numbered in solving order: the ground, the crank, then the two links of each dyad.
GROUND_BODY: Final = 0
CRANK_BODY: Final = 1

CONSTANT: Final = 0  # pieces of a law that is no table


class Tables(NamedTuple):
    """A linkage's structure and loads; entries named ``at`` are places in the vector of numbers.

    A vector's place is that of its x, y follows. A joint takes four entries: for R the places of the point in the near
    and in the far body's frame; for P those of the guide's through and along and of the slider's point, and 1 if it is
    seen from the slider.
    """

    dyads: Integers  # kind, sign, near body of the first joint, of the second, then first, inner and second joint
    crank: Integers  # at: the pivot on the ground and on the crank, mass, centre, inertia
    masses: Integers  # all links but the crank: body, at: mass, centre, inertia
    gravity: Integers  # at
    forces: Integers  # body, at the point, law
    torques: Integers  # body, law
    springs: Integers  # body and at the point of either end, at: stiffness, length, damping
    dampers: Integers  # two bodies, at the coefficient
    output: Integers  # body, at the point, at the direction; the ground if there is no output
    laws: Integers  # pieces, components, at the values, or where its table starts in ``curves``
    levels: Integers  # per dyad: order of the derivatives that the equation of motion needs, -1 if it needs none
    curves: Array  # per law: knots (pieces + 1), then (pieces, components, 4), highest power first


@dataclass(frozen=True)
class FlatLinkage:
    """A linkage for the kernels; ``places`` finds a number of the description by name in ``numbers``.

    ``bodies`` finds a body's number. Names are those of the linkage file: ``rod.B.x``, ``rod.mass``, ``rod.centre.y``,
    ``rod.inertia``, ``needle_bar.through.x``, ``needle_bar.along.y``, ``E in rocker.through.x`` (of a slot),
    ``ground.O2.x``, ``gravity.y``, ``forces.E.x``, ``torques.rod``, ``springs.A.B.stiffness``,
    ``dampers.crank.ground.coefficient``, ``output.along.x``; SI units. A second number of one name, such as that of
    another force at the point, is followed by `` #2``. Loads that are tables over the crank angle have no name here,
    nor has the inertia of a link that cannot turn. Directions are scaled to unit length wherever they are used.

    ``points`` (by body and point) and ``guides`` (through, along, the slider's point) of links and slots are places
    too.
    """

    linkage: Linkage
    structure: Structure
    tables: Tables
    numbers: Array
    places: Mapping[str, int]
    bodies: Mapping[str, int]
    points: Mapping[tuple[str, str], int]
    guides: Mapping[str, tuple[int, int, int]]


class _Numbers:
    """The vector of numbers while it is filled; a zero vector stands first, for what a description leaves out."""

    def __init__(self) -> None:
        self.values: list[float] = [0.0, 0.0]
        self.places: dict[str, int] = {}

    def add(self, names: Iterable[str], values: Iterable[float]) -> int:
        """Append values under their names, and return the first one's place."""
        start = len(self.values)
        for name, value in zip(names, values, strict=True):
            self.places[self._free(name)] = len(self.values)
            self.values.append(float(value))
        return start

    def vector(self, name: str, value: Vector) -> int:
        """Append a vector."""
        return self.add((f"{name}.x", f"{name}.y"), value)

    def _free(self, name: str) -> str:
        """The name, or the name with a count if it is taken."""
        count = 2
        free = name
        while free in self.places:
            free = f"{name} #{count}"
            count += 1
        return free


@lru_cache(maxsize=16)
def flatten(mechanism: Mechanism) -> FlatLinkage:
    """The tables of a linkage, in the assembly modes its sketch picks."""
    return _Writer(mechanism).flattened()


def redesigned(flat: FlatLinkage, numbers: Array) -> Linkage:
    """The linkage with other ``numbers``, in the order of the tables'; its sketch is left as it is."""
    values = {name: float(numbers[place]) for name, place in flat.places.items()}
    return changed(flat.linkage, lambda name, _, value: values.get(name, value))


def levels(structure: Structure, orders: Mapping[str, int]) -> Integers:
    """Order of the derivatives needed of each dyad, -1 if none, for those needed of some bodies, by name."""
    needed = dict(orders)
    found = []
    for dyad in reversed(structure.dyads):
        order = max(needed.get(name, -1) for name in dyad.links)
        for joint in (dyad.first_joint, dyad.second_joint):
            needed[joint.near] = max(order, needed.get(joint.near, -1))
        found.append(order)
    return np.array(found[::-1], dtype=np.int64)


class _Writer:
    """Numbers the bodies, stores what the description holds, then refers to it in the tables."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.linkage, self.structure = mechanism.linkage, mechanism.structure
        links = [name for dyad in self.structure.dyads for name in dyad.links]
        self.bodies = {name: number for number, name in enumerate((GROUND, self.linkage.crank, *links))}
        self.numbers = _Numbers()
        self.points: dict[tuple[str, str], int] = {}
        self.inertias: dict[str, tuple[int, int, int]] = {}
        self.guides: dict[str, tuple[int, int, int]] = {}
        self.curves: list[float] = []
        self.laws: list[tuple[int, int, int]] = []

    def flattened(self) -> FlatLinkage:
        """Everything of the linkage; links, ground and guides first, since the joints refer to them."""
        self._store_bodies()
        self._store_guides()
        gravity = self.numbers.vector("gravity", self.linkage.gravity)
        tables = Tables(
            dyads=_table((self._dyad(dyad) for dyad in self.structure.dyads), 16),
            crank=_row(self._crank()),
            masses=_table(self._masses(), 4),
            gravity=_row((gravity,)),
            forces=_table(self._forces(), 3),
            torques=_table(self._torques(), 2),
            springs=_table(self._springs(), 7),
            dampers=_table(self._dampers(), 3),
            output=_row(self._output()),
            laws=_table(self.laws, 3),
            levels=levels(self.structure, needs(self.linkage, {"Mkr"}, turns=True).orders),
            curves=np.array(self.curves, dtype=np.float64),
        )
        numbers = np.array(self.numbers.values)
        return FlatLinkage(
            self.linkage,
            self.structure,
            tables,
            numbers,
            self.numbers.places,
            self.bodies,
            self.points,
            self.guides,
        )

    def _store_bodies(self) -> None:
        """Masses before points, lest a point called ``centre`` take the mass centre's name."""
        for name, link in self.linkage.links.items():
            mass = self.numbers.add((f"{name}.mass",), (link.mass,))
            centre = self.numbers.vector(f"{name}.centre", link.centre)
            inertia = 0 if link.inertia is None else self.numbers.add((f"{name}.inertia",), (link.inertia,))
            self.inertias[name] = (mass, centre, inertia)
        for name, points in ((GROUND, self.linkage.ground), *((n, k.points) for n, k in self.linkage.links.items())):
            for point, place in points.items():
                self.points[name, point] = self.numbers.vector(f"{name}.{point}", place)

    def _store_guides(self) -> None:
        for slider in self.linkage.sliders:
            self._store_guide(slider.link, slider.guide, self.points[slider.link, slider.point])
        for slot in self.linkage.slots:
            self._store_guide(slot.name, slot.guide, 0)
            self.points[slot.name, slot.point] = 0

    def _store_guide(self, name: str, guide: Guide, point: int) -> None:
        through = self.numbers.vector(f"{name}.through", guide.through)
        self.guides[name] = (through, self.numbers.vector(f"{name}.along", guide.along), point)

    def _dyad(self, dyad: Dyad) -> tuple[int, ...]:
        near = (self.bodies[dyad.first_joint.near], self.bodies[dyad.second_joint.near])
        joints = [entry for joint in dyad.joints for entry in self._joint(joint)]
        return (KINDS.index(dyad.kind), dyad.sign, *near, *joints)

    def _joint(self, joint: Joint) -> tuple[int, int, int, int]:
        if isinstance(joint, Revolute):
            return (self.points[joint.near, joint.point], self.points[joint.far, joint.point], 0, 0)
        return (*self.guides[joint.slider], int(joint.near == joint.slider))

    def _crank(self) -> tuple[int, ...]:
        pivot, crank = self.structure.pivot, self.linkage.crank
        return (self.points[GROUND, pivot.point], self.points[crank, pivot.point], *self.inertias[crank])

    def _masses(self) -> Iterator[tuple[int, ...]]:
        for name in self.bodies:
            if name in self.linkage.links and name != self.linkage.crank:
                yield (self.bodies[name], *self.inertias[name])

    def _forces(self) -> Iterator[tuple[int, ...]]:
        for force in self.linkage.forces:
            names = [f"forces.{force.point}.{axis}" for axis in "xy"]
            yield self.bodies[force.link], self.points[force.link, force.point], self._law(force.force, names)

    def _torques(self) -> Iterator[tuple[int, ...]]:
        for torque in self.linkage.torques:
            yield self.bodies[torque.link], self._law(torque.torque, [f"torques.{torque.link}"])

    def _law(self, law: Law, names: list[str]) -> int:
        """The number of a law, now stored."""
        if law.is_constant:
            self.laws.append((CONSTANT, len(names), self.numbers.add(names, law.values)))
        else:
            knots, coefficients = _pieces(law)
            self.laws.append((len(knots) - 1, len(names), len(self.curves)))
            self.curves += [*knots, *np.moveaxis(coefficients, 0, -1).ravel()]
        return len(self.laws) - 1

    def _springs(self) -> Iterator[tuple[int, ...]]:
        for spring in self.linkage.springs:
            ends = [
                entry
                for point, body in zip(spring.points, spring.links, strict=True)
                for entry in (self.bodies[body], self.points[body, point])
            ]
            name = f"springs.{'.'.join(spring.points)}"
            values = {"stiffness": spring.stiffness, "length": spring.length, "damping": spring.damping}
            first = self.numbers.add([f"{name}.{key}" for key in values], values.values())
            yield (*ends, first, first + 1, first + 2)

    def _dampers(self) -> Iterator[tuple[int, ...]]:
        for damper in self.linkage.dampers:
            at = self.numbers.add([f"dampers.{'.'.join(damper.links)}.coefficient"], [damper.coefficient])
            one, two = damper.links
            yield self.bodies[one], self.bodies[two], at

    def _output(self) -> tuple[int, ...]:
        output = self.linkage.output
        if output is None:
            return (GROUND_BODY, 0, 0)
        along = self.numbers.vector("output.along", output.along)
        return (self.bodies[output.link], self.points[output.link, output.point], along)


def _pieces(law: Law) -> tuple[Array, Array]:
    """Knots (pieces + 1,), rad, and coefficients (4, pieces, components), highest power first, of a law's spline."""
    spline = law._spline
    return np.asarray(spline.x), np.asarray(spline.c)


def _table(rows: Iterable[tuple[int, ...]], columns: int) -> Integers:
    """Rows of integers, none of them too."""
    return np.array(list(rows), dtype=np.int64).reshape(-1, columns)


def _row(entries: tuple[int, ...]) -> Integers:
    return np.array(entries, dtype=np.int64)
