"""Decomposition of a linkage into its driver and Assur groups, from the description alone.

The groups of two links come first. Where none fits, the next is the smallest group of a higher class.
"""

from __future__ import annotations

import heapq
import itertools
from collections import defaultdict, deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from analytic.description.linkage import GROUND, Link, Linkage, Pin, Slider
from analytic.errors import StructureError, listed
from analytic.kinematics.structure import (
    KINDS,
    PUSHED,
    TURNED,
    AnyGroup,
    DrivenDistance,
    DrivenLink,
    Dyad,
    Group,
    GroupJoint,
    Joint,
    Prismatic,
    Revolute,
    Structure,
    prismatic_joint,
    revolute_joint,
    structural_formula,
)

# Search for Assur groups of any class: the smallest sets of links that their joints place, by bipartite matching.
#
# Bodies not yet placed have three unknowns each, pins not yet placed two; a body on a pin, a slide, a cylinder are two
# equations, two, and one between them. A matching gives every equation an unknown of its own; what depends on what
# through it falls into strongly connected components, and one that depends on no other is a group of the least size.
# The division does not depend on the matching (A. L. Dulmage, N. S. Mendelsohn, Canadian Journal of Mathematics 10,
# 1958).


Edge = tuple[int, tuple[str, ...]]  # a number of equations, and the unplaced bodies and pins they are between


def find_group(
    linkage: Linkage, placed: set[str], holders: dict[str, str], cylinder: DrivenDistance | None
) -> Group | DrivenLink | None:
    """The first group of the remaining links by name; None where the joints do not fit the unknowns.

    ``holders`` are placed bodies of pins; a slot's pin is a slider of the linkage.
    """
    left = sorted(set(linkage.links) - placed)
    sizes = {**dict.fromkeys(left, 3), **{_pin_node(p): 2 for p in linkage.pins if p.point not in holders}}
    edges = [*_edges(linkage, placed, holders), *_cylinder_edge(cylinder, placed)]
    components = _components(sizes, edges)
    if components is None:
        return None
    links = min(tuple(sorted(set(names) & {*left})) for names in components)
    joints = tuple(_joints(linkage, links, placed, holders, cylinder))
    outer, driver = joints[0], joints[-1]
    if len(links) == 1 and isinstance(driver, DrivenDistance) and not isinstance(outer, DrivenDistance):
        return DrivenLink(TURNED if isinstance(outer, Revolute) else PUSHED, links[0], outer, driver)
    return Group(links, joints, _class_of_group(links, joints))


def _pin_node(pin: Pin) -> str:
    return f"pin {pin.point}\0"  # no body can be called so


def _edges(linkage: Linkage, placed: set[str], holders: dict[str, str]) -> Iterable[Edge]:
    """Joints as edges between the unplaced bodies and pins, each with the number of coordinates that it fixes."""
    for pin in linkage.pins:
        node = () if pin.point in holders else (_pin_node(pin),)
        yield from ((2, (body, *node)) for body in pin.links if body not in placed)
    for slider in linkage.sliders:
        ends = tuple(body for body in (slider.link, slider.guide.host) if body not in placed)
        if ends:
            yield 2, ends


def _cylinder_edge(cylinder: DrivenDistance | None, placed: set[str]) -> Iterable[Edge]:
    """The driving cylinder as an edge, if one of its bodies is not placed."""
    if cylinder is not None:
        yield 1, tuple(body for body in (cylinder.near, cylinder.far) if body not in placed)


def _components(sizes: dict[str, int], edges: Sequence[Edge]) -> list[tuple[str, ...]] | None:
    """The sets of bodies and pins that depend on no other set and hold a body; None where there is no matching."""
    from scipy.sparse import csr_matrix  # noqa: PLC0415 - SciPy is for the linkages that need it
    from scipy.sparse.csgraph import connected_components, maximum_bipartite_matching  # noqa: PLC0415

    names, starts = list(sizes), dict(zip(sizes, itertools.accumulate([0, *sizes.values()]), strict=False))
    equations = [ends for count, ends in edges for _ in range(count)]
    unknowns = sum(sizes.values())
    if len(equations) != unknowns:
        return None
    entries = [(row, starts[end] + k) for row, ends in enumerate(equations) for end in ends for k in range(sizes[end])]
    rows, columns = np.array(entries).T
    graph = csr_matrix((np.ones(len(entries), dtype=np.int8), (rows, columns)), shape=(unknowns, unknowns))
    matched = maximum_bipartite_matching(graph, perm_type="column")  # of each equation
    if np.any(matched < 0):
        return None
    owners = np.repeat(np.arange(len(names)), list(sizes.values()))[matched]
    number = {name: at for at, name in enumerate(names)}
    needs = {(int(owner), number[end]) for owner, ends in zip(owners, equations, strict=True) for end in ends}
    needs = {(first, other) for first, other in needs if first != other}
    values, other = np.array(sorted(needs)).reshape(-1, 2).T
    graph = csr_matrix((np.ones(len(values), dtype=np.int8), (values, other)), shape=(len(names), len(names)))
    count, labels = connected_components(graph, directed=True, connection="strong")
    waiting = {int(labels[a]) for a, b in needs if labels[a] != labels[b]}
    free = [
        tuple(name for name, label in zip(names, labels, strict=True) if label == part)
        for part in range(count) if part not in waiting
    ]  # fmt: skip
    return [part for part in free if any(sizes[name] == 3 for name in part)] or None


def _joints(
    linkage: Linkage, links: Sequence[str], placed: set[str], holders: dict[str, str], cylinder: DrivenDistance | None
) -> Iterable[GroupJoint]:
    """Outer joints seen from placed bodies, and inner ones."""
    for pin in linkage.pins:
        members = [body for body in pin.links if body in links]
        near = holders.get(pin.point) or (members[0] if members else GROUND)
        yield from (revolute_joint(linkage, pin.point, near, body) for body in members if body != near)
    for slider in linkage.sliders:
        yield from _slider_joint(linkage, slider, links, placed)
    if cylinder is not None and {cylinder.near, cylinder.far} & {*links}:
        yield cylinder


def _slider_joint(linkage: Linkage, slider: Slider, links: Sequence[str], placed: set[str]) -> Iterable[GroupJoint]:
    """A slider's joint if it is in the group or between the group and a placed body."""
    ends = (slider.link, slider.guide.host)
    known = {*links} | placed
    if {*ends} & {*links} and {*ends} <= known:
        near = slider.link if slider.link in placed else slider.guide.host
        yield prismatic_joint(slider, linkage.local(slider.point, slider.link), near)


def _class_of_group(links: Sequence[str], joints: Sequence[GroupJoint]) -> int:
    """The sides of the largest of the shortest closed contours through each joint between links of the group, or 3."""
    pairs = {(j.near, j.far) for j in joints if j.near in links and j.far in links}
    return max([3, *(_contour_length(pair, pairs) for pair in pairs)])


def _contour_length(pair: tuple[str, str], pairs: set[tuple[str, str]]) -> int:
    """Links in the shortest closed contour with a joint; 0 if there is none."""
    start, end = pair
    steps, queue = {start: 1}, deque([start])
    while queue:
        here = queue.popleft()
        for a, b in pairs - {pair}:
            neighbour = b if a == here else a if b == here else None
            if neighbour is not None and neighbour not in steps:
                steps[neighbour] = steps[here] + 1
                queue.append(neighbour)
    return steps.get(end, 0)


# Driver and groups.


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

    def next_group(self) -> Group | DrivenLink | None:
        """The first group of a higher class, or with the cylinder, where no dyad fits."""
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
