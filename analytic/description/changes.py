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
from typing import Any, Final

import numpy as np

from analytic.description.linkage import GROUND, LOADS, NAMED_PARTS, Link, Linkage, Vector
from analytic.description.units import Kind
from analytic.description.walk import Number, with_values
from analytic.errors import UnknownNameError

Change = Callable[[str, Kind, float], float]
# What can be left out, and what then stands in its place.
EMPTY_PARTS: Final[Mapping[str, object]] = {
    "gravity": (0.0, 0.0),
    **dict.fromkeys(LOADS, ()),
    "output": None,
    "thread": None,
}
SPEED: Final = "speed"  # of the driver, in which designs may differ besides; no number has this name


def changed(linkage: Linkage, change: Change) -> Linkage:
    """The linkage with every number that has a name replaced by ``change(name, kind, number)``, SI.

    A direction that is changed becomes a unit vector; raises ZeroDivisionError for one of no length.
    """
    new = {
        number.path: value
        for name, number in linkage.named_numbers.items()
        if (value := change(name, number.kind, number.value)) is not number.value
    }
    result: Linkage = with_values(linkage, new)
    return result


def with_numbers(linkage: Linkage, numbers: Mapping[str, Any]) -> Linkage:
    """The linkage with numbers, SI, by name in place of its own; they may be arrays.

    Names that the linkage does not have are ignored, and a direction that is changed becomes a unit vector; raises
    ZeroDivisionError for one of plain zeros. If the linkage's ``scales_mass`` is set, mass, centre and inertia of a
    link follow its lengths unless they are named.
    """
    result = changed(linkage, lambda name, _, value: numbers.get(name, value))
    if not linkage.scales_mass:
        return result
    bars = {name: _scaled_as_bar(link, linkage.links[name], numbers) for name, link in result.links.items()}
    return replace(result, links=bars)


def _scaled_as_bar(link: Link, old: Link, numbers: Mapping[str, Any]) -> Link:
    """A link that keeps its cross-section where its points move: the mass goes as its length, the inertia as the cube.

    Its mass centre goes as the length. ``old`` is the link before, ``numbers`` are those given by name, which stay. The
    length is the sum of the points' distances from the frame's origin; a link without one stays as it is.
    """
    was, now = (sum(np.hypot(x, y) for x, y in body.points.values()) for body in (old, link))
    if not was:
        return link
    scale = now / was

    def scaled(name: str, value: Any, factor: Any) -> Any:  # noqa: ANN401 - plain or traced
        """A value of the link times a factor; unchanged if it is zero or ``numbers`` give it themselves.

        ``name`` is the value's within the link, as "centre.x".
        """
        return value if f"{link.name}.{name}" in numbers or not value else value * factor

    return replace(
        link,
        mass=scaled("mass", link.mass, scale),
        centre=(scaled("centre.x", link.centre[0], scale), scaled("centre.y", link.centre[1], scale)),
        inertia=scaled("inertia", link.inertia, scale * scale * scale),
    )


def named_numbers(linkage: Linkage) -> dict[str, Number]:
    """Every number of a linkage by its name, with its kind, its path and its value, SI; a new dictionary."""
    return dict(linkage.named_numbers)


def numbers(linkage: Linkage) -> dict[str, float]:
    """Values, SI, of all numbers of a linkage, by name."""
    return {name: number.value for name, number in named_numbers(linkage).items()}


def design_numbers(linkage: Linkage) -> dict[str, tuple[Kind, float]]:
    """Kind and value, SI, of every number in which designs may differ: all but the sketch's.

    The sketch says which assembly mode is meant, and is the same for all designs.
    """
    every = named_numbers(linkage).items()
    return {name: (number.kind, number.value) for name, number in every if not name.startswith("sketch.")}


def with_point(linkage: Linkage, body: str, point: str, place: Vector) -> Linkage:
    """A copy of the linkage with a named point of a link, or of the ground, at another place in the body's frame, m.

    A new name adds a point. Raises KeyError for an unknown link.
    """
    if body == GROUND:
        return replace(linkage, ground={**linkage.ground, point: place})
    link = linkage.links[body]
    return replace(linkage, links={**linkage.links, body: replace(link, points={**link.points, point: place})})


def multiplied(linkage: Linkage, factor: float, *kinds: str, under: str = "") -> Linkage:
    """The linkage with its numbers of these kinds times a factor, all or those whose name begins with ``under``.

    ``kinds`` are values of ``Kind``, as "length"; a direction stays a unit vector.
    """

    def times(name: str, kind: Kind, value: float) -> float:
        """A number times the ``factor``, if it is of the ``kinds`` and its name begins with ``under``."""
        return value * factor if kind in kinds and name.startswith(under) else value

    return changed(linkage, times)


def scaled(linkage: Linkage, *, length: float = 1.0, mass: float = 1.0, time: float = 1.0) -> Linkage:
    """A similar linkage: every length, mass and time times a factor; without its thread.

    What is given in several of these, as an inertia, is scaled to match. Regimes stay as they are.
    """
    similar = without(linkage, "thread")

    new = {
        path: value * linkage.phi.kind(kind).size(length, mass, time)
        for part in (*NAMED_PARTS, "sketch_angle", "cylinder")
        for path, kind, value in similar.numbers_of(part)
    }
    result: Linkage = with_values(similar, new)
    return result


def without(linkage: Linkage, *parts: str) -> Linkage:
    """The linkage without these parts, names of ``EMPTY_PARTS`` such as "gravity".

    Raises UnknownNameError for others.
    """
    for part in parts:
        if part not in EMPTY_PARTS:
            raise UnknownNameError("part", part, EMPTY_PARTS)
    nothing = {part: EMPTY_PARTS[part] for part in parts}
    return replace(linkage, **nothing)  # type: ignore[arg-type]  # the table holds each part's own type
