"""A linkage with something changed: numbers set, multiplied or scaled, or something left out.

A number has a path as a linkage file has it (``links.rod.points.B.x``, ``links.bar.slides.through.y``, ``gravity.y``)
and a kind that says what it measures. Loads and slots are counted from 0 in the linkage's own order. Sketch angle,
regimes, thread and published figures are no numbers in this sense. The linkage given is never altered.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from analytic.description.law import Law
from analytic.description.linkage import GROUND, Guide, Link, Linkage, Slot, Spring, Vector, unit
from analytic.errors import UnknownNameError

Kind = Literal[
    "length", "direction", "mass", "inertia", "force", "torque", "acceleration", "stiffness", "damping", "turn_damping"
]
Change = Callable[[str, Kind, float], float]

# What can be left out, and what then stands in its place.
NOTHING: Final[Mapping[str, object]] = {
    "gravity": (0.0, 0.0),
    "forces": (),
    "torques": (),
    "springs": (),
    "dampers": (),
    "output": None,
    "thread": None,
}
LOADS: Final = ("forces", "torques", "springs", "dampers")

# Exponents of length, mass and time in each kind of number.
DIMENSIONS: Final[Mapping[Kind, tuple[int, int, int]]] = {
    "length": (1, 0, 0),
    "direction": (0, 0, 0),
    "mass": (0, 1, 0),
    "inertia": (2, 1, 0),
    "force": (1, 1, -2),
    "torque": (2, 1, -2),
    "acceleration": (1, 0, -2),
    "stiffness": (0, 1, -2),
    "damping": (0, 1, -1),
    "turn_damping": (2, 1, -1),
}


def changed(linkage: Linkage, change: Change) -> Linkage:
    """The linkage with every number replaced by ``change(path, kind, number)``; directions are made unit vectors."""
    return _Walk(change).linkage(linkage)


def numbers(linkage: Linkage) -> dict[str, float]:
    """Every number of a linkage by its path, SI units."""
    by_path: dict[str, float] = {}

    def note(path: str, _: Kind, value: float) -> float:
        by_path[path] = value
        return value

    changed(linkage, note)
    return by_path


def with_numbers(linkage: Linkage, values: Mapping[str, float]) -> Linkage:
    """The linkage with other numbers (SI units) at these paths; raises UnknownNameError."""
    known = numbers(linkage)
    for path in values:
        if path not in known:
            raise UnknownNameError("number", path, known)
    return changed(linkage, lambda path, _, value: values.get(path, value))


def with_point(linkage: Linkage, body: str, point: str, place: Vector) -> Linkage:
    """The linkage with a named point of a link, or of the ground, at another place in the body's frame, m."""
    path = f"ground.{point}" if body == GROUND else f"links.{body}.points.{point}"
    return with_numbers(linkage, {f"{path}.x": place[0], f"{path}.y": place[1]})


def multiplied(linkage: Linkage, factor: float, *kinds: Kind, under: str = "") -> Linkage:
    """The linkage with its numbers of these kinds times a factor, all or those whose path begins with ``under``."""

    def times(path: str, kind: Kind, value: float) -> float:
        return value * factor if kind in kinds and path.startswith(under) else value

    return changed(linkage, times)


def scaled(linkage: Linkage, *, length: float = 1.0, mass: float = 1.0, time: float = 1.0) -> Linkage:
    """The same problem with every length, mass and time times a factor; without its thread."""
    factors = {kind: length**a * mass**b * time**c for kind, (a, b, c) in DIMENSIONS.items()}
    return changed(without(linkage, "thread"), lambda _, kind, value: value * factors[kind])


def without(linkage: Linkage, *parts: str) -> Linkage:
    """The linkage without these parts, names of ``NOTHING``; raises UnknownNameError."""
    for part in parts:
        if part not in NOTHING:
            raise UnknownNameError("part", part, NOTHING)
    nothing = {part: NOTHING[part] for part in parts}
    return replace(linkage, **nothing)  # type: ignore[arg-type]  # the table holds each part's own type


def with_bare_slots(linkage: Linkage, sliders: Collection[str]) -> Linkage:
    """The linkage with a pin in a slot in place of each of these sliders."""
    pins = [replace(pin, links=tuple(name for name in pin.links if name not in sliders)) for pin in linkage.pins]
    slots = [Slot(slider.point, slider.guide) for slider in linkage.sliders if slider.link in sliders]
    return replace(
        linkage,
        links={name: link for name, link in linkage.links.items() if name not in sliders},
        pins=tuple(pin for pin in pins if len(pin.links) > 1),
        sliders=tuple(slider for slider in linkage.sliders if slider.link not in sliders),
        slots=(*linkage.slots, *slots),
    )


@dataclass(frozen=True)
class _Walk:
    """Visits every number of a linkage and builds the linkage of what the change makes of them."""

    change: Change

    def linkage(self, old: Linkage) -> Linkage:
        return replace(
            old,
            ground=self.points("ground", old.ground),
            links={name: self.link(link) for name, link in old.links.items()},
            sliders=tuple(replace(s, guide=self.guide(f"links.{s.link}.slides", s.guide)) for s in old.sliders),
            slots=tuple(replace(s, guide=self.guide(f"slots.{n}", s.guide)) for n, s in enumerate(old.slots)),
            sketch=self.points("sketch.points", old.sketch),
            gravity=self.vector("gravity", old.gravity, "acceleration"),
            forces=tuple(
                replace(f, force=self.law(f"forces.{n}.force", f.force, "force")) for n, f in enumerate(old.forces)
            ),
            torques=tuple(
                replace(t, torque=self.law(f"torques.{n}.torque", t.torque, "torque"))
                for n, t in enumerate(old.torques)
            ),
            springs=tuple(self.spring(f"springs.{n}", spring) for n, spring in enumerate(old.springs)),
            dampers=tuple(
                replace(d, coefficient=self.change(f"dampers.{n}.coefficient", "turn_damping", d.coefficient))
                for n, d in enumerate(old.dampers)
            ),
            output=old.output and replace(old.output, along=self.direction("output.along", old.output.along)),
        )

    def vector(self, path: str, vector: Vector, kind: Kind = "length") -> Vector:
        return (self.change(f"{path}.x", kind, vector[0]), self.change(f"{path}.y", kind, vector[1]))

    def points(self, path: str, points: Mapping[str, Vector]) -> dict[str, Vector]:
        return {name: self.vector(f"{path}.{name}", place) for name, place in points.items()}

    def direction(self, path: str, old: Vector) -> Vector:
        new = self.vector(path, old, "direction")
        return old if new == old else unit(new)

    def link(self, link: Link) -> Link:
        path = f"links.{link.name}"
        return replace(
            link,
            points=self.points(f"{path}.points", link.points),
            mass=self.change(f"{path}.mass", "mass", link.mass),
            centre=self.vector(f"{path}.centre", link.centre),
            inertia=None if link.inertia is None else self.change(f"{path}.inertia", "inertia", link.inertia),
        )

    def guide(self, path: str, guide: Guide) -> Guide:
        through = self.vector(f"{path}.through", guide.through)
        return replace(guide, through=through, along=self.direction(f"{path}.along", guide.along))

    def law(self, path: str, law: Law, kind: Kind) -> Law:
        """A law with other values: ``path`` or ``path.x``, of a table with the row before: ``path.3.x``."""
        names = list(_components(path, law.values.shape))
        flat = [self.change(name, kind, float(value)) for name, value in zip(names, law.values.flat, strict=True)]
        values = np.array(flat).reshape(law.values.shape)
        return law if np.array_equal(values, law.values) else Law(values, law.angles)

    def spring(self, path: str, spring: Spring) -> Spring:
        return replace(
            spring,
            stiffness=self.change(f"{path}.stiffness", "stiffness", spring.stiffness),
            length=self.change(f"{path}.length", "length", spring.length),
            damping=self.change(f"{path}.damping", "damping", spring.damping),
        )


def _components(path: str, shape: tuple[int, ...]) -> Iterator[str]:
    """Paths of a law's values: of each row, if there are several, and of each component, if there are several."""
    rows = [f"{path}.{n}" for n in range(shape[0])] if len(shape) > 1 else [path]
    for row in rows:
        yield from (f"{row}.x", f"{row}.y") if shape[-1] > 1 else (row,)
