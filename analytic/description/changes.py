"""Copies of a linkage with other numbers: set, multiplied or scaled by dimension; or with a part left out.

A number has a kind, which says what it measures, and a name: ``rod.B.x``, ``rod.mass``, ``rod.centre.y``,
``rod.inertia``, ``bar.through.x``, ``bar.along.y``, ``E in rocker.through.x`` (of a slot), ``ground.O2.x``,
``gravity.y``, ``forces.E.x``, ``forces.E.3.x`` (of a table over the crank angle), ``torques.rod``,
``springs.A.B.stiffness``, ``dampers.crank.ground.coefficient``, ``output.along.x``, ``sketch.B.x``. A second number of
one name, such as that of another force at the point, is followed by `` #2``. Sketch angle, regimes, thread and
published figures have no such names. The given linkage itself is never altered.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

import numpy as np

from analytic.description.law import Law
from analytic.description.linkage import GROUND, Link, Linkage, Vector
from analytic.description.units import Kind
from analytic.description.walk import Keys, Number, number_fields, walk, with_values
from analytic.errors import UnknownNameError

Change = Callable[[str, Kind, float], float]
# The parts with numbers that have names, in the order of the names.
NAMED_PARTS: Final = (
    "ground", "links", "sliders", "slots", "gravity", "forces", "torques", "springs", "dampers", "output", "sketch",
)  # fmt: skip
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


def changed(linkage: Linkage, change: Change) -> Linkage:
    """The linkage with every number that has a name replaced by ``change(name, kind, number)``."""
    numbers = named_numbers(linkage).items()
    new = {number.path: change(name, number.kind, number.value) for name, number in numbers}
    old = {number.path: number.value for _, number in numbers}
    result: Linkage = with_values(linkage, {path: value for path, value in new.items() if value is not old[path]})
    return result


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


def _numbers_of(linkage: Linkage, part: str) -> Iterator[Number]:
    """The numbers of one field of a linkage, with or without names."""
    return walk(getattr(linkage, part), number_fields(Linkage)[part], (part,))


def named_numbers(linkage: Linkage) -> dict[str, Number]:
    """Every number of a linkage by its name, with its kind and its path; a name already taken is followed by a count.

    Masses come before points, lest a point called ``centre`` take the mass centre's name.
    """
    result: dict[str, Number] = {}
    every = [number for part in NAMED_PARTS for number in _numbers_of(linkage, part)]
    for number in sorted(every, key=lambda number: number.path[0] != "links" or number.path[2] == "points"):
        if number.kind is Kind.COORDINATE:
            continue
        name = _name(linkage, number.path)
        counted = (f"{name} #{count}" for count in itertools.count(2))
        result[name if name not in result else next(free for free in counted if free not in result)] = number
    return result


def _name(linkage: Linkage, path: Keys) -> str:
    """The name of the number at a path: what the number is of, and which it is."""
    keys: Sequence[str | int] = path
    match path:
        case ("links", link, "points", *rest) | ("links", link, *rest):
            keys = link, *rest
        case ("sliders", int(index), _, *rest):
            keys = linkage.sliders[index].link, *rest
        case ("slots", int(index), _, *rest):
            keys = linkage.slots[index].name, *rest
        case ("forces", int(index), _, row, axis):
            force = linkage.forces[index]
            keys = "forces", force.point, *_row(force.force, row), axis
        case ("torques", int(index), _, row, _):
            torque = linkage.torques[index]
            keys = "torques", torque.link, *_row(torque.torque, row)
        case ("springs", int(index), what):
            keys = "springs", *linkage.springs[index].points, what
        case ("dampers", int(index), what):
            keys = "dampers", *linkage.dampers[index].links, what
    return ".".join("xy"[key] if isinstance(key, int) else key for key in keys)


def _row(law: Law, row: str | int) -> tuple[str, ...]:
    """The row of a load's table in a name; a constant load has none."""
    return () if law.is_constant else (str(row),)


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


def multiplied(linkage: Linkage, factor: float, *kinds: str, under: str = "") -> Linkage:
    """The linkage with its numbers of these kinds times a factor, all or those whose name begins with ``under``."""

    def times(name: str, kind: Kind, value: float) -> float:
        return value * factor if kind in kinds and name.startswith(under) else value

    return changed(linkage, times)


def scaled(linkage: Linkage, *, length: float = 1.0, mass: float = 1.0, time: float = 1.0) -> Linkage:
    """A similar linkage: every length, mass and time times a factor; without its thread."""
    similar = without(linkage, "thread")

    new = {
        path: value * kind.of_driver(is_linear=linkage.is_linear).size(length, mass, time)
        for part in (*NAMED_PARTS, "sketch_angle")
        for path, kind, value in _numbers_of(similar, part)
    }
    result: Linkage = with_values(similar, new)
    return result


def without(linkage: Linkage, *parts: str) -> Linkage:
    """The linkage without these parts, names of ``EMPTY_PARTS``; raises UnknownNameError."""
    for part in parts:
        if part not in EMPTY_PARTS:
            raise UnknownNameError("part", part, EMPTY_PARTS)
    nothing = {part: EMPTY_PARTS[part] for part in parts}
    return replace(linkage, **nothing)  # type: ignore[arg-type]  # the table holds each part's own type
