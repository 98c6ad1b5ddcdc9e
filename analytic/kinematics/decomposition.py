"""Decomposition of a linkage into its driver and Assur groups, from the description alone.

The groups of two links come first. Where none fits, the next is the smallest group of a higher class.
"""

from __future__ import annotations

import heapq
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from analytic.description.linkage import GROUND, Link, Linkage, Pin, Slider
from analytic.errors import StructureError, listed
from analytic.kinematics.structure import (
    KINDS,
    AnyGroup,
    DrivenDistance,
    Dyad,
    Group,
    Joint,
    Prismatic,
    Revolute,
    Structure,
    prismatic_joint,
    revolute_joint,
    structural_formula,
)


def _with_slot_sliders(linkage: Linkage) -> Linkage:
    """The linkage with each pin in a slot replaced by a massless slider."""
    bodies = dict(linkage.links)
    sliders = list(linkage.sliders)
    carriers = {pin.point: set(pin.links) for pin in linkage.pins}
    owners = _carriers(linkage)
    for slot in linkage.slots:
        bodies[slot.name] = Link(slot.name, {slot.point: (0.0, 0.0)}, 0.0, (0.0, 0.0), None)
        sliders.append(Slider(slot.name, slot.point, slot.guide))
        pinned = set(owners[slot.point]) - {slot.guide.host}
        carriers.setdefault(slot.point, set()).update([slot.name, *pinned])
    pins = tuple(Pin(p, tuple(sorted(names))) for p, names in sorted(carriers.items()))
    return replace(linkage, links=bodies, pins=pins, sliders=tuple(sliders), slots=())


def _carriers(linkage: Linkage) -> Mapping[str, list[str]]:
    """The bodies that carry each point, the ground included."""
    carriers: dict[str, list[str]] = defaultdict(list)
    for body in linkage.links.values():
        for point in body.points:
            carriers[point].append(body.name)
    for point in linkage.ground:
        carriers[point].append(GROUND)
    return carriers


class _PlacedBodies:
    """The bodies already placed, and which of the others can be placed next.

    A body is visited once, when one of its joints gets a placed body on its other side: the work grows with the number
    of joints.
    """

    def __init__(self, linkage: Linkage) -> None:
        self.linkage = _with_slot_sliders(linkage)
        self.bodies = self.linkage.links
        self.pins_of: dict[str, list[Pin]] = defaultdict(list)
        for pin in self.linkage.pins:
            for name in pin.links:
                self.pins_of[name].append(pin)
        self.sliders_of: dict[str, list[Slider]] = defaultdict(list)
        for slider in self.linkage.sliders:
            for name in (slider.link, slider.guide.host):
                self.sliders_of[name].append(slider)
        self.placed: set[str] = set()
        self.holders: dict[str, str] = {}  # of each pin with a placed body: the one its joints are seen from
        self.reachable: set[str] = set()  # bodies with a joint to a placed one
        self.first_two: dict[str, list[str]] = defaultdict(list)  # of each pin: its first reachable bodies by name
        self.pairs: list[tuple[str, str]] = []  # heap of reachable pairs with a joint between them

    def revolute(self, point: str, near: str, far: str) -> Revolute:
        return revolute_joint(self.linkage, point, near, far)

    def prismatic(self, slider: Slider, near: str) -> Prismatic:
        return prismatic_joint(slider, self.linkage.local(slider.point, slider.link), near)

    def joints(self, near: str, far: str) -> Iterator[Joint]:
        """Every joint between two bodies, seen from ``near``."""
        for pin in self.pins_of[far]:
            if near in pin.links:
                yield self.revolute(pin.point, near, far)
        for slider in self.sliders_of[far]:
            if near in (slider.link, slider.guide.host):
                yield self.prismatic(slider, near)

    def outer_joints(self, body: str) -> list[Joint]:
        """Joints of an unplaced body to placed ones; several placed bodies on one pin are one joint."""
        points = [pin.point for pin in self.pins_of[body] if pin.point in self.holders]
        joints: list[Joint] = [self.revolute(point, self.holders[point], body) for point in points]
        for slider in self.sliders_of[body]:
            near = _other_end(slider, body)
            if near in self.placed:
                joints.append(self.prismatic(slider, near))
        return sorted(joints, key=lambda joint: _ground_first(joint.near))

    def inner_joints(self, second: str, first: str) -> list[Joint]:
        """Joints between two unplaced bodies; a pin that a placed body carries is an outer joint of both instead."""
        return [j for j in self.joints(second, first) if not (isinstance(j, Revolute) and j.point in self.holders)]

    def place(self, *names: str) -> None:
        """Add bodies to the placed ones; raises StructureError where another body gets too many joints by it."""
        self.placed.update(names)
        neighbours: set[str] = set()
        for name in names:
            for pin in self.pins_of[name]:
                if pin.point not in self.holders:
                    neighbours.update(pin.links)
                self.holders[pin.point] = min(self.holders.get(pin.point, name), name, key=_ground_first)
            neighbours.update(_other_end(slider, name) for slider in self.sliders_of[name])
        for name in sorted(neighbours - self.placed):
            outer = self.outer_joints(name)
            if len(outer) > 1:
                raise StructureError(self._overconstrained_text(name, outer))
            self._add_candidate_pairs(name)

    def _add_candidate_pairs(self, body: str) -> None:
        """Add the pairs that a body forms with the reachable ones, of a pin only the first pair by name."""
        self.reachable.add(body)
        for pin in self.pins_of[body]:
            if pin.point not in self.holders:
                first_two = sorted([*self.first_two[pin.point], body])[:2]
                self.first_two[pin.point] = first_two
                if len(first_two) > 1:
                    heapq.heappush(self.pairs, (first_two[0], first_two[1]))
        for slider in self.sliders_of[body]:
            partner = _other_end(slider, body)
            if partner in self.reachable:
                heapq.heappush(self.pairs, (min(body, partner), max(body, partner)))

    def next_dyad(self) -> Dyad | None:
        """Two unplaced bodies joined to each other and each to a placed one, the first such pair by name."""
        while self.pairs:
            first, second = heapq.heappop(self.pairs)
            if first in self.placed or second in self.placed:
                continue
            inner = self.inner_joints(second, first)
            if len(inner) > 1:
                raise StructureError(self._overconstrained_text(first, [*self.outer_joints(first), *inner]))
            if inner:
                return self._dyad(first, second, inner[0])
        return None

    def next_group(self) -> Group | None:
        """The first group of a higher class, where no dyad fits."""
        from analytic.kinematics.groups.finding import find_group  # noqa: PLC0415 - SciPy is for the linkages that need it

        return find_group(self.linkage, self.placed, self.holders, self.cylinder())

    def cylinder(self) -> DrivenDistance | None:
        """The cylinder that drives, seen from a placed body if one of its ends is on one; None once it is placed."""
        driver = self.linkage.cylinder
        if driver is None or {*driver.links} <= self.placed:
            return None
        near, far = zip(driver.points, driver.links, strict=True)
        if far[1] in self.placed:
            near, far = far, near
        return DrivenDistance(near[1], far[1], self.linkage.local(*near), self.linkage.local(*far))

    def _dyad(self, first: str, second: str, inner: Joint) -> Dyad:
        """The dyad of two bodies by the kinds of its joints, its links in the order of the kind's name."""
        joints = (self.outer_joints(first)[0], inner, self.outer_joints(second)[0])
        kind = "".join("R" if isinstance(joint, Revolute) else "P" for joint in joints)
        if kind in KINDS:
            return Dyad(kind, first, second, *joints)
        if kind[::-1] in KINDS:
            return Dyad(kind[::-1], second, first, joints[2], self.inner_joints(first, second)[0], joints[0])
        raise StructureError(
            f"'{first}' and '{second}' of '{self.linkage.name}' are held by three sliding joints (PPP), which fix no "
            "position: expected at least one revolute joint among the three; pin one of them instead"
        )

    def _overconstrained_text(self, name: str, joints: Sequence[Joint]) -> str:
        """The message for a body with too many joints to placed ones."""
        return (
            f"'{name}' of '{self.linkage.name}' is held by too many joints ({listed(joint.name for joint in joints)}), "
            "so the linkage is locked or not built of two-link groups: expected one joint to the links before it and "
            "one to its partner; leave one out"
        )


def _ground_first(body: str) -> tuple[bool, str]:
    """Sort key of bodies: the ground first, then by name."""
    return (body != GROUND, body)


def _other_end(slider: Slider, body: str) -> str:
    return slider.guide.host if body == slider.link else slider.link


def find_structure(linkage: Linkage) -> Structure:
    """The driver and the Assur groups of a linkage, in an order in which they can be solved; signs are left 0.

    Raises StructureError where the crank has not exactly one joint, its pivot, or where the other links form no group.
    """
    search = _PlacedBodies(linkage)
    pivots = list(search.joints(GROUND, linkage.crank)) if linkage.crank else []
    if linkage.crank and len(pivots) != 1:
        raise StructureError(
            f"crank '{linkage.crank}' of '{linkage.name}': expected one pin to the ground, or one slide on it, and no "
            f"other joint to it, got {listed(joint.name for joint in pivots)}; give it just one point that [ground] "
            "has too"
        )
    groups: list[AnyGroup] = []
    pivot = pivots[0] if pivots else None
    try:
        search.place(*([GROUND, linkage.crank] if linkage.crank else [GROUND]))
        while len(search.placed) <= len(search.bodies):
            group = search.next_dyad() or search.next_group()
            if group is None:
                raise StructureError(_why_no_group(search))
            groups.append(group)
            search.place(*group.links)
    except StructureError as error:
        error.so_far = structural_formula(pivot, groups)
        raise
    return Structure(dict(sorted(search.bodies.items())), pivot, tuple(groups))


def _why_no_group(search: _PlacedBodies) -> str:
    """Why the remaining bodies form no group: too many or too few joints, in all or in a part of the linkage."""
    left = sorted(set(search.bodies) - search.placed)
    moving = len(search.bodies)
    lower_pairs = sum(len(pin.links) - 1 for pin in search.linkage.pins) + len(search.linkage.sliders)
    mobility = 3 * moving - 2 * lower_pairs
    names = listed(f"'{name}'" for name in left)
    if mobility != 1:
        carriers = _carriers(search.linkage)
        single = sorted(f"'{p}'" for name in left for p in search.bodies[name].points if len(carriers[p]) == 1)
        loose = f"; on one link only: {listed(single)}" if single and mobility > 1 else ""
        cure = "add a joint to" if mobility > 1 else "leave out a joint of"
        return (
            f"'{search.linkage.name}': expected mobility 1, got {mobility} (3·{moving} links - 2·{lower_pairs} joints)"
            f"; {cure} {names} (a point of one name on two links is a joint{loose})"
        )
    return (
        f"{names} of '{search.linkage.name}' form no group: a part of them is locked by its joints and another is "
        "loose; check for a missing or misspelt point"
    )
