"""Any linkage as flat tables of numbers, for kernels that are compiled once for all linkages.

It has no names and no objects: integer tables say which body, joint and quantity goes where, one vector of
floats holds the linkage's own numbers as they stand in its description. Constants derived from them (arm lengths,
offsets) are not in it, so a changed design is nothing but another vector.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import Kind, changed, with_numbers
from analytic.description.law import Law
from analytic.description.linkage import GROUND, Linkage
from analytic.dynamics.derivative_orders import needs
from analytic.dynamics.group_forces import references
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.structure import KINDS, Dyad, Joint, Revolute, Structure

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Row = tuple[float, ...]  # of integers: places are read where a linkage has its numbers

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
    references: Integers  # per body: at the point about which its balance of moments is made
    laws: Integers  # pieces, components, at the values, or where its table starts in ``curves``
    levels: Integers  # per dyad: order of the derivatives that the equation of motion needs, -1 if it needs none
    curves: Array  # per law: knots (pieces + 1), then (pieces, components, 4), highest power first


@dataclass(frozen=True)
class FlatLinkage:
    """A linkage for the kernels; ``places`` finds a number of the description by name in ``numbers``.

    Names are those of the linkage file: ``rod.B.x``, ``rod.mass``, ``rod.centre.y``,
    ``rod.inertia``, ``needle_bar.through.x``, ``needle_bar.along.y``, ``E in rocker.through.x`` (of a slot),
    ``ground.O2.x``, ``gravity.y``, ``forces.E.x``, ``torques.rod``, ``springs.A.B.stiffness``,
    ``dampers.crank.ground.coefficient``, ``output.along.x``; SI units. A second number of one name, such as that of
    another force at the point, is followed by `` #2``. Loads that are tables over the crank angle have no name here,
    nor has the inertia of a link that cannot turn. Directions are scaled to unit length wherever they are used.

    ``directions`` are the places of the directions' x.
    """

    linkage: Linkage
    structure: Structure
    tables: Tables
    numbers: Array
    places: Mapping[str, int]
    directions: tuple[int, ...]


def has_kernels(structure: Structure) -> bool:
    """Whether the kernels can solve a linkage: turning crank, groups of class II, no change point; NumPy solves all."""
    changes = any(dyad.changes for dyad in structure.dyads)
    return isinstance(structure.pivot, Revolute) and not structure.is_numerical and not changes


@lru_cache(maxsize=16)
def flatten(mechanism: Mechanism) -> FlatLinkage:
    """The tables of a linkage, in the assembly modes its sketch picks; raises LinkproofError where there are none."""
    if not isinstance(mechanism.structure.pivot, Revolute):
        raise LinkproofError(
            f"'{mechanism.linkage.name}': expected a turning crank and groups of class II, which many designs at once "
            f"need, got {mechanism.structure.formula}; evaluate every design as a mechanism of its own"
        )
    return _Writer(mechanism).flattened()


def redesigned(flat: FlatLinkage, numbers: Array) -> Linkage:
    """The linkage with other ``numbers``, in the order of the tables'; its sketch is left as it is."""
    return with_numbers(flat.linkage, {name: float(numbers[place]) for name, place in flat.places.items()})


def bodies(structure: Structure) -> dict[str, int]:
    """Numbers of the bodies by name."""
    assert structure.pivot is not None
    links = [name for dyad in structure.dyads for name in dyad.links]
    return {name: number for number, name in enumerate((GROUND, structure.pivot.far, *links))}


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
    """Gives every number a place, then writes tables of the linkage whose numbers are these places."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.linkage, self.structure = mechanism.linkage, mechanism.structure
        self.bodies = bodies(self.structure)
        self.values = [0.0, 0.0]  # a zero vector stands first, for what a description leaves out
        self.places: dict[str, int] = {}
        numbered = replace(
            self.linkage,
            forces=tuple(force for force in self.linkage.forces if force.force.is_constant),
            torques=tuple(torque for torque in self.linkage.torques if torque.torque.is_constant),
            sketch={},
        )
        self.at = changed(numbered, self._place, direction=lambda places: places)
        self.constants = iter([*(f.force for f in self.at.forces), *(t.torque for t in self.at.torques)])
        self.guides = {
            slider.link: (slider.guide.through[0], slider.guide.along[0], self._point(slider.link, slider.point))
            for slider in self.at.sliders
        }
        self.guides |= {slot.name: (slot.guide.through[0], slot.guide.along[0], 0) for slot in self.at.slots}
        self.curves: list[float] = []
        self.laws: list[Row] = []

    def _place(self, name: str, _: Kind, value: float) -> int:
        """Store a number."""
        place = self.places[name] = len(self.values)
        self.values.append(value)
        return place

    def flattened(self) -> FlatLinkage:
        """Everything of the linkage; the laws of the forces come before those of the torques."""
        tables = Tables(
            dyads=_table((self._dyad(dyad) for dyad in self.structure.dyads), 16),
            crank=_row(self._crank()),
            masses=_table(self._masses(), 4),
            gravity=_row(self.at.gravity[:1]),
            forces=_table(self._forces(), 3),
            torques=_table(self._torques(), 2),
            springs=_table(self._springs(), 7),
            dampers=_table(self._dampers(), 3),
            output=_row(self._output()),
            references=_row(tuple(self._references())),
            laws=_table(self.laws, 3),
            levels=levels(self.structure, needs(self.linkage, {"Mkr"}, turns=True).orders),
            curves=np.array(self.curves, dtype=np.float64),
        )
        directions = [along for _, along, _ in self.guides.values()]
        directions += [self.at.output.along[0]] if self.at.output else []
        return FlatLinkage(
            self.linkage, self.structure, tables, np.array(self.values), self.places, tuple(map(int, directions))
        )

    def _point(self, body: str, point: str) -> float:
        """Place of a point; the massless slider of a slot has its pin at its origin."""
        return self.at.local(point, body)[0] if body == GROUND or body in self.at.links else 0

    def _mass(self, name: str) -> Row:
        link = self.at.links[name]
        return (link.mass, link.centre[0], link.inertia or 0)

    def _dyad(self, dyad: Dyad) -> Row:
        near = (self.bodies[dyad.first_joint.near], self.bodies[dyad.second_joint.near])
        joints = [entry for joint in dyad.joints for entry in self._joint(joint)]
        return (KINDS.index(dyad.kind), dyad.sign, *near, *joints)

    def _joint(self, joint: Joint) -> Row:
        if isinstance(joint, Revolute):
            return (self._point(joint.near, joint.point), self._point(joint.far, joint.point), 0, 0)
        return (*self.guides[joint.slider], int(joint.near == joint.slider))

    def _references(self) -> Iterator[float]:
        """The points of ``group_forces.references``, which copies what a joint says of them: here their places."""

        def placed(joint: Joint) -> Joint:
            if not isinstance(joint, Revolute):
                return joint
            near, far = self._point(joint.near, joint.point), self._point(joint.far, joint.point)
            return replace(joint, near_local=(near, 0), far_local=(far, 0))

        dyads = tuple(
            replace(
                dyad,
                first_joint=placed(dyad.first_joint),
                inner_joint=placed(dyad.inner_joint),
                second_joint=placed(dyad.second_joint),
            )
            for dyad in self.structure.dyads
        )
        assert self.structure.pivot is not None
        links = {**self.structure.bodies, **self.at.links}
        found = references(Structure(links, placed(self.structure.pivot), dyads))
        for name in self.bodies:
            yield found[name][0]

    def _crank(self) -> Row:
        assert isinstance(self.structure.pivot, Revolute)
        point, crank = self.structure.pivot.point, self.linkage.crank
        return (self._point(GROUND, point), self._point(crank, point), *self._mass(crank))

    def _masses(self) -> Iterator[Row]:
        for name, number in self.bodies.items():
            if name in self.linkage.links and name != self.linkage.crank:
                yield (number, *self._mass(name))

    def _forces(self) -> Iterator[Row]:
        for force in self.linkage.forces:
            yield self.bodies[force.link], self._point(force.link, force.point), self._law(force.force)

    def _torques(self) -> Iterator[Row]:
        for torque in self.linkage.torques:
            yield self.bodies[torque.link], self._law(torque.torque)

    def _law(self, law: Law) -> int:
        """The number of a law, now stored."""
        components = law.values.shape[-1]
        if law.is_constant:
            self.laws.append((CONSTANT, components, next(self.constants).values[0]))
        else:
            knots, coefficients = _pieces(law)
            self.laws.append((len(knots) - 1, components, len(self.curves)))
            self.curves += [*knots, *np.moveaxis(coefficients, 0, -1).ravel()]
        return len(self.laws) - 1

    def _springs(self) -> Iterator[Row]:
        for spring in self.at.springs:
            (one, two), (here, there) = spring.links, spring.points
            ends = (self.bodies[one], self._point(one, here), self.bodies[two], self._point(two, there))
            yield (*ends, spring.stiffness, spring.length, spring.damping)

    def _dampers(self) -> Iterator[Row]:
        for damper in self.at.dampers:
            one, two = damper.links
            yield self.bodies[one], self.bodies[two], damper.coefficient

    def _output(self) -> Row:
        output = self.at.output
        if output is None:
            return (GROUND_BODY, 0, 0)
        return (self.bodies[output.link], self._point(output.link, output.point), output.along[0])


def _pieces(law: Law) -> tuple[Array, Array]:
    """Knots (pieces + 1,), rad, and coefficients (4, pieces, components), highest power first, of a law's spline."""
    spline = law._spline
    return np.asarray(spline.x), np.asarray(spline.c)


def _table(rows: Iterable[Row], columns: int) -> Integers:
    """Rows of integers, none of them too."""
    return np.array(list(rows), dtype=np.int64).reshape(-1, columns)


def _row(entries: Row) -> Integers:
    return np.array(entries, dtype=np.int64)
