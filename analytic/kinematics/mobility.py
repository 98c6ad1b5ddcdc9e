"""Mobility of a linkage from its joints and lengths alone: Grübler's count and Grashof's rule."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass

from analytic.description.linkage import GROUND, Linkage
from analytic.kinematics.structure import Revolute, Structure

# Sums of lengths that differ by less than this share are equal: a change point.
EQUAL = 1e-12


@dataclass(frozen=True)
class Mobility:
    """Grübler's count F = 3n - 2j - h of moving links n, pins and slides j, and pins in slots h."""

    links: int
    joints: int
    slots: int

    @property
    def degrees(self) -> int:
        """Degrees of freedom that the count gives."""
        return 3 * self.links - 2 * self.joints - self.slots

    @property
    def formula(self) -> str:
        """The count written out."""
        slots = f" - {self.slots} pin{'s' if self.slots > 1 else ''} in slots" if self.slots else ""
        return f"{self.degrees} = 3·{self.links} links - 2·{self.joints} pins and slides{slots}"


def mobility(linkage: Linkage) -> Mobility:
    """The count of a linkage; a pin that k bodies share is k - 1 joints."""
    joints = len(linkage.joint_names) - len(linkage.slots)
    return Mobility(len(linkage.links), joints, len(linkage.slots))


def loose_points(linkage: Linkage) -> tuple[str, ...]:
    """Points of links that are on no joint, sorted."""
    shared = {pin.point for pin in linkage.pins} | {slot.point for slot in linkage.slots}
    shared |= {slider.point for slider in linkage.sliders} | {*(linkage.cylinder.points if linkage.cylinder else ())}
    counts = Counter(point for link in linkage.links.values() for point in link.points)
    return tuple(sorted(point for point in counts if point not in shared))


def grashof(linkage: Linkage, structure: Structure) -> str | None:
    """The class of a four-bar by Grashof's rule, with its lengths; None for any other linkage.

    The frame and the three links turn fully against each other where shortest + longest < the sum of the other two;
    the shortest link then decides which links turn.
    """
    pivot = structure.pivot
    if len(structure.dyads) != 1 or structure.dyads[0].kind != "RRR" or not isinstance(pivot, Revolute):
        return None
    dyad = structure.dyads[0]
    ends = {joint.near: joint for joint in (dyad.first_joint, dyad.second_joint) if isinstance(joint, Revolute)}
    if set(ends) != {GROUND, linkage.crank}:
        return None
    inner = dyad.inner_joint
    assert isinstance(inner, Revolute)
    local = {inner.near: inner.near_local, inner.far: inner.far_local}
    lengths = {
        "frame": math.dist(pivot.near_local, ends[GROUND].near_local),
        "crank": math.dist(pivot.far_local, ends[linkage.crank].near_local),
        "coupler": math.dist(ends[linkage.crank].far_local, local[ends[linkage.crank].far]),
        "rocker": math.dist(ends[GROUND].far_local, local[ends[GROUND].far]),
    }
    return _class(lengths, linkage)


def _class(lengths: dict[str, float], linkage: Linkage) -> str:
    shortest, *middle, longest = sorted(lengths, key=lambda name: lengths[name])
    ends, others = lengths[shortest] + lengths[longest], sum(lengths[name] for name in middle)
    sums = f"shortest + longest {linkage.written(ends)}, the other two {linkage.written(others)}"
    if abs(ends - others) <= EQUAL * others:
        return f"change-point four-bar ({sums})"
    if ends > others:
        return f"four-bar in which nothing turns fully, a triple rocker ({sums})"
    kinds = {"frame": "double-crank", "crank": "crank-rocker", "coupler": "double-rocker", "rocker": "rocker-crank"}
    return f"Grashof {kinds[shortest]} ({sums}; the {shortest} is the shortest)"
