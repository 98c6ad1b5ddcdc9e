"""A linkage of the same structure with other numbers: the way back from the vector of numbers to a description."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.flat_linkage import CONSTANT, FlatLinkage
from analytic.description.law import Law
from analytic.description.linkage import GROUND, Guide, Link, Linkage, Output, PointForce, Spring, Vector, unit

Array = NDArray[np.float64]


def redesigned(flat: FlatLinkage, numbers: Array) -> Linkage:
    """The linkage with other ``numbers``, in the order of the tables'; its sketch is left as it is."""
    return _Reader(flat, numbers).linkage()


class _Reader:
    """Looks numbers up where the tables have them."""

    def __init__(self, flat: FlatLinkage, numbers: Array) -> None:
        self.flat = flat
        self.numbers = [float(number) for number in numbers]

    def linkage(self) -> Linkage:
        old, tables = self.flat.linkage, self.flat.tables
        return replace(
            old,
            ground={point: self.point(GROUND, point) for point in old.ground},
            links={name: self.link(link) for name, link in old.links.items()},
            sliders=tuple(replace(slider, guide=self.guide(slider.link, slider.guide)) for slider in old.sliders),
            slots=tuple(replace(slot, guide=self.guide(slot.name, slot.guide)) for slot in old.slots),
            gravity=self.vector(tables.gravity[0]),
            forces=tuple(self.force(n, force) for n, force in enumerate(old.forces)),
            torques=tuple(
                replace(torque, torque=self.law(tables.torques[n, 1], torque.torque))
                for n, torque in enumerate(old.torques)
            ),
            springs=tuple(self.spring(n, spring) for n, spring in enumerate(old.springs)),
            dampers=tuple(
                replace(damper, coefficient=self.numbers[tables.dampers[n, 2]]) for n, damper in enumerate(old.dampers)
            ),
            output=None if old.output is None else self.output(old.output),
        )

    def vector(self, at: int) -> Vector:
        return (self.numbers[at], self.numbers[at + 1])

    def point(self, body: str, point: str) -> Vector:
        return self.vector(self.flat.points[body, point])

    def link(self, link: Link) -> Link:
        mass, centre, inertia = self.flat.inertias[link.name]
        return replace(
            link,
            points={point: self.point(link.name, point) for point in link.points},
            mass=self.numbers[mass],
            centre=self.vector(centre),
            inertia=None if link.inertia is None else self.numbers[inertia],
        )

    def guide(self, name: str, guide: Guide) -> Guide:
        through, along, _ = self.flat.guides[name]
        return Guide(guide.host, self.vector(through), unit(self.vector(along)))

    def law(self, number: int, law: Law) -> Law:
        pieces, components, at = self.flat.tables.laws[number]
        return Law(np.array(self.numbers[at : at + components])) if pieces == CONSTANT else law

    def force(self, number: int, force: PointForce) -> PointForce:
        return replace(force, force=self.law(self.flat.tables.forces[number, 2], force.force))

    def spring(self, number: int, spring: Spring) -> Spring:
        stiffness, length, damping = (self.numbers[at] for at in self.flat.tables.springs[number, 4:])
        return replace(spring, stiffness=stiffness, length=length, damping=damping)

    def output(self, output: Output) -> Output:
        return replace(output, along=unit(self.vector(self.flat.tables.output[2])))
