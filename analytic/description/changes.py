"""Copies of a linkage with other numbers: set, multiplied or scaled by dimension; or with a part left out.

A number has a kind, which says what it measures, and a name: ``rod.B.x``, ``rod.mass``, ``rod.centre.y``,
``rod.inertia``, ``bar.through.x``, ``bar.along.y``, ``E in rocker.through.x`` (of a slot), ``ground.O2.x``,
``gravity.y``, ``forces.E.x``, ``forces.E.3.x`` (of a table over the crank angle), ``torques.rod``,
``springs.A.B.stiffness``, ``dampers.crank.ground.coefficient``, ``output.along.x``, ``sketch.B.x``. A second number of
one name, such as that of another force at the point, is followed by `` #2``. Sketch angle, regimes, thread and
published figures have no such names. The given linkage itself is never altered.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, Final, Literal, NamedTuple

import numpy as np

from analytic.description.law import Law, LawOfNumbers
from analytic.description.linkage import GROUND, Guide, Link, Linkage, RotaryDamper, Spring, Vector, unit
from analytic.errors import UnknownNameError

Kind = Literal[
    "length", "direction", "mass", "inertia", "force", "torque", "acceleration", "stiffness", "damping", "turn_damping"
]
Change = Callable[[str, Kind, float], float]
Place = tuple[str | int, ...]


class Number(NamedTuple):
    """A number of a linkage, SI, its kind (what it measures), and the keys and indices that lead to it.

    Keys and indices are those of the linkage file, except for loads and slots, which are numbered in the linkage's
    order; a law's are followed by row and component.
    """

    value: float
    kind: Kind
    place: Place


# What can be left out, and what then stands in its place.
EMPTY_PARTS: Final[Mapping[str, object]] = {
    "gravity": (0.0, 0.0),
    "forces": (),
    "torques": (),
    "springs": (),
    "dampers": (),
    "output": None,
    "thread": None,
}
SPEED: Final = "speed"  # of the driver, in which designs may differ besides; no number has this name
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


def changed(linkage: Linkage, change: Change, direction: Callable[[Vector], Vector] = unit) -> Linkage:
    """The linkage with every number replaced by ``change(name, kind, number)``, and new directions by ``direction``."""
    return _NumberWalk(lambda name, number: change(name, number.kind, number.value), direction).changed_linkage(linkage)


def with_numbers(linkage: Linkage, numbers: Mapping[str, Any]) -> Linkage:
    """The linkage with numbers by name in place of its own, SI; they may be arrays.

    If it ``scales_mass``, mass, centre and inertia of a link follow the lengths of the link unless they are named.
    """
    result = changed(linkage, lambda name, _, value: numbers.get(name, value))
    if not linkage.scales_mass:
        return result
    bars = {name: _scaled_as_bar(link, linkage.links[name], numbers) for name, link in result.links.items()}
    return replace(result, links=bars)


def _scaled_as_bar(link: Link, old: Link, numbers: Mapping[str, Any]) -> Link:
    """A link that keeps its cross-section where its points move: the mass goes as its length, the inertia as the cube.

    The length is the sum of the points' distances from the frame's origin; a link without one stays as it is.
    """
    was, now = (sum(np.hypot(x, y) for x, y in body.points.values()) for body in (old, link))
    if not was:
        return link
    scale = now / was

    def scaled(name: str, value: Any, factor: Any) -> Any:  # noqa: ANN401 - plain, dual or traced
        return value if f"{link.name}.{name}" in numbers or not value else value * factor

    return replace(
        link,
        mass=scaled("mass", link.mass, scale),
        centre=(scaled("centre.x", link.centre[0], scale), scaled("centre.y", link.centre[1], scale)),
        inertia=scaled("inertia", link.inertia, scale * scale * scale),
    )


def named_numbers(linkage: Linkage) -> dict[str, Number]:
    """Every number of a linkage by its name, with its kind and its place in the linkage file."""
    result: dict[str, Number] = {}

    def note(name: str, number: Number) -> float:
        result[name] = number
        return number.value

    _NumberWalk(note, unit).changed_linkage(linkage)
    return result


def numbers(linkage: Linkage) -> dict[str, float]:
    """Every number of a linkage by its name, SI units."""
    return {name: number.value for name, number in named_numbers(linkage).items()}


def design_numbers(linkage: Linkage) -> dict[str, tuple[Kind, float]]:
    """Kind and value, SI, of every number in which designs may differ: all but the sketch's.

    The sketch says which assembly mode is meant, and is the same for all designs.
    """
    every = named_numbers(linkage).items()
    return {name: (number.kind, number.value) for name, number in every if not name.startswith("sketch.")}


def with_point(linkage: Linkage, body: str, point: str, place: Vector) -> Linkage:
    """The linkage with a named point of a link, or of the ground, at another place in the body's frame, m."""
    if body == GROUND:
        return replace(linkage, ground={**linkage.ground, point: place})
    link = linkage.links[body]
    return replace(linkage, links={**linkage.links, body: replace(link, points={**link.points, point: place})})


def multiplied(linkage: Linkage, factor: float, *kinds: Kind, under: str = "") -> Linkage:
    """The linkage with its numbers of these kinds times a factor, all or those whose name begins with ``under``."""

    def times(name: str, kind: Kind, value: float) -> float:
        return value * factor if kind in kinds and name.startswith(under) else value

    return changed(linkage, times)


def scaled(linkage: Linkage, *, length: float = 1.0, mass: float = 1.0, time: float = 1.0) -> Linkage:
    """A similar linkage: every length, mass and time times a factor; without its thread."""
    factors = {kind: length**a * mass**b * time**c for kind, (a, b, c) in DIMENSIONS.items()}
    result = changed(without(linkage, "thread"), lambda _, kind, value: value * factors[kind])
    if not linkage.is_linear:
        return result

    def over_length(law: Law) -> Law:
        return law if law.angles is None else replace(law, angles=law.angles * length)

    return replace(
        result,
        sketch_angle=result.sketch_angle * length,
        forces=tuple(replace(load, force=over_length(load.force)) for load in result.forces),
        torques=tuple(replace(load, torque=over_length(load.torque)) for load in result.torques),
    )


def without(linkage: Linkage, *parts: str) -> Linkage:
    """The linkage without these parts, names of ``EMPTY_PARTS``; raises UnknownNameError."""
    for part in parts:
        if part not in EMPTY_PARTS:
            raise UnknownNameError("part", part, EMPTY_PARTS)
    nothing = {part: EMPTY_PARTS[part] for part in parts}
    return replace(linkage, **nothing)  # type: ignore[arg-type]  # the table holds each part's own type


class _NumberWalk:
    """Visits every number of a linkage and builds the linkage with the changed numbers.

    Masses come before points, lest a point called ``centre`` take the mass centre's name.
    """

    def __init__(self, change: Callable[[str, Number], float], unit: Callable[[Vector], Vector]) -> None:
        self.change, self.unit = change, unit
        self.names: set[str] = set()

    def number(self, name: str, kind: Kind, value: float, *place: str | int) -> float:
        """The number that replaces this one; a name already taken is followed by a count."""
        free, count = name, 2
        while free in self.names:
            free, count = f"{name} #{count}", count + 1
        self.names.add(free)
        return self.change(free, Number(value, kind, place))

    def vector(self, name: str, vector: Vector, *place: str | int, kind: Kind = "length") -> Vector:
        """A vector with both components replaced."""
        x, y = vector
        return self.number(f"{name}.x", kind, x, *place, 0), self.number(f"{name}.y", kind, y, *place, 1)

    def direction(self, name: str, old: Vector, *place: str | int) -> Vector:
        """A direction replaced and made a unit vector; exactly the old one where no component changes."""
        new = self.vector(name, old, *place, kind="direction")
        same = all(isinstance(value, float) and value == other for value, other in zip(new, old, strict=True))
        return old if same else self.unit(new)

    def points(self, body: str, points: Mapping[str, Vector], *place: str | int) -> dict[str, Vector]:
        """Named points of a body, or of the sketch, with replaced coordinates."""
        return {point: self.vector(f"{body}.{point}", at, *place, point) for point, at in points.items()}

    def changed_linkage(self, old: Linkage) -> Linkage:
        """The linkage with every number replaced, in the order that fixes the names of numbers."""
        bodies = {name: self.mass(link) for name, link in old.links.items()}
        return replace(
            old,
            ground=self.points(GROUND, old.ground, GROUND),
            links={
                name: replace(link, points=self.points(name, link.points, "links", name, "points"))
                for name, link in bodies.items()
            },
            sliders=tuple(
                replace(slider, guide=self.guide(slider.link, slider.guide, "links", slider.link, "slides"))
                for slider in old.sliders
            ),
            slots=tuple(
                replace(slot, guide=self.guide(slot.name, slot.guide, "slots", index))
                for index, slot in enumerate(old.slots)
            ),
            gravity=self.vector("gravity", old.gravity, "gravity", kind="acceleration"),
            forces=tuple(
                replace(force, force=self.law(f"forces.{force.point}", force.force, "force", "forces", index))
                for index, force in enumerate(old.forces)
            ),
            torques=tuple(
                replace(torque, torque=self.law(f"torques.{torque.link}", torque.torque, "torque", "torques", index))
                for index, torque in enumerate(old.torques)
            ),
            springs=tuple(self.spring(index, spring) for index, spring in enumerate(old.springs)),
            dampers=tuple(self.damper(index, damper) for index, damper in enumerate(old.dampers)),
            output=old.output
            and replace(old.output, along=self.direction("output.along", old.output.along, "output", "along")),
            sketch=self.points("sketch", old.sketch, "sketch", "points"),
        )

    def mass(self, link: Link) -> Link:
        """The link with mass, mass centre and inertia replaced."""
        name, place, inertia = link.name, ("links", link.name), link.inertia
        return replace(
            link,
            mass=self.number(f"{name}.mass", "mass", link.mass, *place, "mass"),
            centre=self.vector(f"{name}.centre", link.centre, *place, "centre"),
            inertia=inertia
            if inertia is None
            else self.number(f"{name}.inertia", "inertia", inertia, *place, "inertia"),
        )

    def guide(self, name: str, guide: Guide, *place: str | int) -> Guide:
        """The guide with its point and its direction replaced."""
        through = self.vector(f"{name}.through", guide.through, *place, "through")
        return replace(guide, through=through, along=self.direction(f"{name}.along", guide.along, *place, "along"))

    def law(self, name: str, law: Law, kind: Literal["force", "torque"], *place: str | int) -> Law:
        """A load's law with its values replaced; in names of a table's numbers the row stands before the component."""
        ends = ("",) if law.values.shape[-1] == 1 else (".x", ".y")
        rows = [name] if law.angles is None else [f"{name}.{row}" for row in range(len(law.values))]
        names = [(f"{key}{end}", row, k) for row, key in enumerate(rows) for k, end in enumerate(ends)]
        flat = [
            self.number(key, kind, float(value), *place, kind, row, k)
            for (key, row, k), value in zip(names, law.values.flat, strict=True)
        ]
        if not all(isinstance(value, float | int) for value in flat):
            return LawOfNumbers(law.values, law.angles, law.periodic, law.linear, tuple(flat))
        changed = np.reshape(flat, law.values.shape)
        return law if np.array_equal(changed, law.values) else replace(law, values=changed)

    def spring(self, index: int, spring: Spring) -> Spring:
        """The spring with stiffness, length and damping replaced."""
        name, place = f"springs.{'.'.join(spring.points)}", ("springs", index)
        return replace(
            spring,
            stiffness=self.number(f"{name}.stiffness", "stiffness", spring.stiffness, *place, "stiffness"),
            length=self.number(f"{name}.length", "length", spring.length, *place, "length"),
            damping=self.number(f"{name}.damping", "damping", spring.damping, *place, "damping"),
        )

    def damper(self, index: int, damper: RotaryDamper) -> RotaryDamper:
        """The rotary damper with its coefficient replaced."""
        name = f"dampers.{'.'.join(damper.links)}.coefficient"
        place = ("dampers", index, "coefficient")
        return replace(damper, coefficient=self.number(name, "turn_damping", damper.coefficient, *place))
