"""Which numbers change where a point of a moving linkage is pulled: lengths about placed pins, places in a frame."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, NamedTuple

from analytic.description.linkage import GROUND
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.structure import Revolute


class Pull(NamedTuple):
    """Effect of pulling at a point on a ``body`` that has it.

    "place" moves the point in the body's frame, "length" its distance from the point ``about`` there, and "crank" that
    distance while the crank turns with it.
    """

    body: str
    way: Literal["place", "length", "crank"]
    about: str = ""


def pulls(mechanism: Mechanism) -> Mapping[str, list[Pull]]:
    """Of each point what changes where it is pulled; a pin that two links place changes their two lengths.

    A point by which a group hangs on placed links belongs to those.
    """
    linkage, structure = mechanism.linkage, mechanism.structure
    groups = {point: [Pull(GROUND, "place")] for point in linkage.ground}

    def put(point: str, body: str, way: Literal["place", "length", "crank"], about: str = "") -> None:
        if point not in linkage.ground:
            groups.setdefault(point, []).append(Pull(body, way, about))

    if isinstance(structure.pivot, Revolute):
        for point in linkage.links[linkage.crank].points:
            put(point, linkage.crank, "crank", structure.pivot.point)
    own = {slider.link: slider.point for slider in linkage.sliders}
    for dyad in structure.dyads:
        inner = dyad.inner_joint.point if isinstance(dyad.inner_joint, Revolute) else ""
        for name, outer in ((dyad.first, dyad.first_joint), (dyad.second, dyad.second_joint)):
            hangs = outer.point if isinstance(outer, Revolute) else ""
            for point in linkage.links[name].points if name in linkage.links else ():
                if point == inner:
                    if hangs:
                        put(point, name, "length", hangs)
                elif point not in (hangs, own.get(name)):
                    put(point, name, "place")
    return groups
