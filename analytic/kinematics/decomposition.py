"""Decomposition of a linkage into its driver and Assur groups, from the description alone.

Bodies not yet placed have three unknowns each, pins not yet placed two; a body on a pin, a slide, a cylinder are two
equations, two, and one between them. A matching gives every equation an unknown of its own; what depends on what
through it falls into strongly connected components, each a group of the least size, which needs those before it. The
division does not depend on the matching (A. L. Dulmage, N. S. Mendelsohn, Canadian Journal of Mathematics 10, 1958).
An equation left over shows a body with too many joints, an unknown left over one with too few.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any, Final, NamedTuple

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
    Revolute,
    Structure,
    mobility,
    prismatic_joint,
    revolute_joint,
    structural_formula,
)

BODY, PIN = 3, 2  # unknowns of each
DYAD: Final = ("outer", "inner", "outer")  # joints
ORDINARY: Final = (0, 2)  # bodies of what is solved first: pins that hang on placed bodies, and dyads
Equation = tuple[str, ...]  # the one or two bodies and pins that it is between


class Division(NamedTuple):
    """Names of bodies divided into ``groups``, in an order in which they can be solved, and of what fits in none.

    ``locked`` bodies have a joint too many, ``loose`` ones too few; what hangs on these is left out.
    """

    groups: tuple[tuple[str, ...], ...]
    locked: tuple[str, ...]
    loose: tuple[str, ...]


@lru_cache(maxsize=64)  # the designs of a linkage share one
def divide(sizes: tuple[tuple[str, int], ...], equations: tuple[Equation, ...]) -> Division:
    """The division of bodies and pins into groups, in an order that can be solved, and what is locked or loose.

    ``sizes`` are their numbers of unknowns by name, 3 of a body and 2 of a pin, ``equations`` the one or two of them
    that each is between. Of what can be solved next dyads come first, before groups of a higher class, and of each kind
    the first by name. The latest 64 divisions are kept.
    """
    matching = Matching(dict(sizes), equations)
    loose, groups, done = matching.loose(), [], set[str]()
    bodies = {part: tuple(sorted(filter(matching.is_body, part))) for part in matching.components()}
    waiting = sorted(bodies, key=lambda part: (len(bodies[part]) not in ORDINARY, bodies[part]))
    while part := next((part for part in waiting if not part & loose and matching.needs(part) <= done | part), None):
        groups.append(bodies[part])
        done |= part
        waiting.remove(part)
    locked = filter(matching.is_body, matching.locked)
    return Division(tuple(filter(None, groups)), tuple(sorted(locked)), tuple(sorted(filter(matching.is_body, loose))))


class Matching:
    """As many equations as can be, each of a body or pin that it determines, which has an unknown for it.

    ``held`` has the numbers of a body's or pin's equations by its name, ``locked`` the names of those with one too
    many.
    """

    def __init__(self, sizes: Mapping[str, int], equations: Sequence[Equation]) -> None:
        """Match equations with unknowns, of which bodies and pins have ``sizes``, by name, from the driver outwards.

        An equation names the one or two bodies and pins that it is between.
        """
        self.sizes, self.equations = sizes, equations
        self.held: dict[str, set[int]] = {name: set() for name in sizes}  # numbers of the equations
        self.locked: set[str] = set()
        for number in self._from_driver():
            self._enter(number)

    def is_body(self, name: str) -> bool:
        """Whether this is the name of a body, with three unknowns, not of a pin."""
        return self.sizes[name] == BODY

    def _from_driver(self) -> Iterator[int]:
        """Yield numbers of the equations, the nearest to the driver first, so that no body they carry is locked."""
        left, known = dict(enumerate(self.equations)), set[str]()
        while near := [number for number, ends in left.items() if len(ends) == 1 or {*ends} & known] or [*left]:
            yield from near
            known |= {end for number in near for end in left.pop(number)}

    def _enter(self, number: int) -> None:
        """Match an equation, by number, with an unknown, moving others where that helps.

        Else lock the bodies and pins that it is between.
        """
        reached = dict.fromkeys(self.equations[number], number)  # each with the equation through which it is
        queue = deque(reached)
        while queue:
            name = queue.popleft()
            if len(self.held[name]) < self.sizes[name]:
                self._shift(name, reached)
                return
            for other in self.held[name]:
                new = [end for end in self.equations[other] if end not in reached]
                reached |= dict.fromkeys(new, other)
                queue.extend(new)
        self.locked |= {*self.equations[number]}

    def _shift(self, name: str, reached: Mapping[str, int]) -> None:
        """Move equations along the path that reached a body or pin, so that the new one is matched there.

        ``name`` is the body or pin, ``reached`` has the equation through which each on the path was reached; ``held``
        changes.
        """
        before: str | None = name
        while before is not None:
            name, equation = before, reached[before]
            before = next((end for end in self.equations[equation] if equation in self.held[end]), None)
            if before is not None:
                self.held[before].remove(equation)
            self.held[name].add(equation)

    def loose(self) -> set[str]:
        """Names of bodies and pins with unknowns left over, and of those that depend on such ones, however far."""
        loose = {name for name, size in self.sizes.items() if len(self.held[name]) < size}
        while more := {name for name in self.sizes if self.needs([name]) & loose} - loose:
            loose |= more
        return loose

    def needs(self, names: Iterable[str]) -> set[str]:
        """Names of the bodies and pins on which the equations that determine these ones depend."""
        return {end for name in names for number in self.held[name] for end in self.equations[number]}

    def components(self) -> list[frozenset[str]]:
        """The strongly connected components of the dependencies, as sets of names.

        Those that need a locked body are left out.
        """
        reach: dict[str, set[str]] = {}
        for name in self.sizes:
            reach[name], new = {name}, {name}
            while new := self.needs(new) - reach[name]:
                reach[name] |= new
        free = [name for name, seen in reach.items() if not seen & self.locked]
        return [*dict.fromkeys(frozenset(other for other in reach[name] if name in reach[other]) for name in free)]


# Driver and groups.


def _with_slot_sliders(linkage: Linkage) -> Linkage:
    """A copy of the linkage with each pin in a slot replaced by a massless slider of the slot's name."""
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
    """Names of the bodies that carry each point, the ground included, by point."""
    carriers: dict[str, list[str]] = defaultdict(list)
    for body in linkage.links.values():
        for point in body.points:
            carriers[point].append(body.name)
    for point in linkage.ground:
        carriers[point].append(GROUND)
    return carriers


def _class_of_group(links: Sequence[str], joints: Sequence[GroupJoint]) -> int:
    """A group's class: the links in the shortest closed contour through an inner joint, of the joint with most of them.

    It is at least 3. ``links`` are the names of the group's links, ``joints`` all its joints.
    """
    pairs = {(j.near, j.far) for j in joints if j.near in links and j.far in links}
    return max([3, *(_contour_length(pair, pairs) for pair in pairs)])


def _contour_length(pair: tuple[str, str], pairs: set[tuple[str, str]]) -> int:
    """Links in the shortest closed contour with the joint of a ``pair`` of bodies; 0 if there is none.

    ``pairs`` are those of all inner joints, by the names of their bodies.
    """
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


class _PlacedBodies:
    """The bodies ``placed`` so far, and the groups that others form with them."""

    def __init__(self, linkage: Linkage) -> None:
        """Begin with the ground alone; each pin in a slot is replaced by a massless slider."""
        self.linkage = _with_slot_sliders(linkage)
        self.bodies = self.linkage.links
        self.pins_of: dict[str, list[Pin]] = defaultdict(list)
        for pin in self.linkage.pins:
            for name in pin.links:
                self.pins_of[name].append(pin)
        self.placed = {GROUND}

    def division(self) -> Division:
        """The division of the bodies not yet placed, and of the pins between these alone."""
        pins = {pin.point: f"pin {pin.point}\0" for pin in self.linkage.pins if not self.placed.intersection(pin.links)}
        bodies = sorted({*self.bodies} - self.placed)
        sizes = {**dict.fromkeys(bodies, BODY), **dict.fromkeys(pins.values(), PIN)}
        ends = [(body, pins.get(pin.point, "")) for pin in self.linkage.pins for body in pin.links]
        ends = 2 * [*ends, *((slider.link, slider.guide.host) for slider in self.linkage.sliders)]
        if self.linkage.cylinder is not None:
            ends.append(self.linkage.cylinder.links)
        unknown = (tuple(end for end in pair if end in sizes) for pair in ends)
        return divide(tuple(sizes.items()), tuple(filter(None, unknown)))

    def joints(self, *bodies: str) -> Iterator[Any]:
        """Yield the joints of these bodies with placed ones, seen from the placed ones, and with each other.

        Those with each other are seen from the first. They are pins, then slides, then the cylinder; the bodies are
        given by name.
        """
        order = {name: number for number, name in enumerate(bodies, start=2)}
        known = self.placed | {*bodies}

        def placed_first(names: Iterable[str]) -> list[str]:
            """Names sorted: the ground, other placed bodies by name, then the given bodies in their order."""
            return sorted(names, key=lambda name: (order.get(name, name != GROUND), name))

        for pin in sorted({pin for body in bodies for pin in self.pins_of[body]}, key=lambda pin: pin.point):
            near, *others = placed_first(known.intersection(pin.links))
            yield from (revolute_joint(self.linkage, pin.point, near, body) for body in others if body in bodies)
        for slider in self.linkage.sliders:
            near, far = placed_first((slider.link, slider.guide.host))
            if far in bodies and near in known:
                yield prismatic_joint(slider, self.linkage.local(slider.point, slider.link), near)
        if self.linkage.cylinder is not None:
            ends = zip(self.linkage.cylinder.points, self.linkage.cylinder.links, strict=True)
            near_end, far_end = sorted(ends, key=lambda end: end[1] in bodies)
            if far_end[1] in bodies and near_end[1] in known:
                locals_ = (self.linkage.local(*end) for end in (near_end, far_end))
                yield DrivenDistance(near_end[1], far_end[1], *locals_)

    def group(self, *links: str) -> AnyGroup:
        """The group that these links, by name, form with the placed bodies: a dyad, or a link with the cylinder.

        Any other is a ``Group`` of its class. Raises StructureError for two links that three slides hold, or that have
        no joint where a dyad needs it.
        """
        joints = tuple(self.joints(*links))
        outer, driver = joints[0], joints[-1]
        if isinstance(driver, DrivenDistance) and len(links) == 1 and not isinstance(outer, DrivenDistance):
            return DrivenLink(TURNED if isinstance(outer, Revolute) else PUSHED, links[0], outer, driver)
        if len(joints) == len(DYAD) and not isinstance(driver, DrivenDistance):
            return self._dyad(*links)
        return Group(links, joints, _class_of_group(links, joints))

    def _dyad(self, *links: str) -> Dyad:
        """The dyad of two links, by name, by the kinds of its joints, its links in the order of the kind's name.

        Raises StructureError for joints between them that make none.
        """
        for first, second in (links, links[::-1]):
            found: dict[Any, Any] = {(j.near in self.placed, j.far): j for j in self.joints(second, first)}
            joints: list[Any] = [found.get(key) for key in ((True, first), (False, first), (True, second))]
            if None in joints:
                raise StructureError(self._overconstrained_text(links))
            kind = "".join("R" if isinstance(joint, Revolute) else "P" for joint in joints)
            if kind in KINDS:
                return Dyad(kind, first, second, *joints)
        raise StructureError(
            f"{_quoted(links)} of '{self.linkage.name}' are held by three sliding joints (PPP), which fix no "
            "position: expected at least one revolute joint among the three; pin one of them instead"
        )

    def fault(self, division: Division) -> str:
        """The sentence why bodies are left over in a ``division``: too many joints, or too few."""
        if division.locked:
            return self._overconstrained_text(division.locked)
        carriers = _carriers(self.linkage)
        single = sorted(f"'{p}'" for name in division.loose for p in self.bodies[name].points if len(carriers[p]) == 1)
        points = f"; on one link only: {listed(single)}" if single else ""
        return (
            f"'{self.linkage.name}': expected mobility 1, got {mobility(self.linkage).formula}; add a joint to "
            f"{_quoted(division.loose)} (a point of one name on two links is a "
            f"joint{points})"
        )

    def _overconstrained_text(self, links: Sequence[str]) -> str:
        """The message for links, by name, with too many joints to placed ones, or to each other."""
        names = [joint.name for joint in self.joints(*links) if not isinstance(joint, DrivenDistance)]
        return (
            f"{_quoted(links)} of '{self.linkage.name}' {'is' if len(links) == 1 else 'are'} held by too many joints "
            f"({listed(names)}), so the linkage is locked: expected one joint to the links before and one to a "
            "partner; leave one out"
        )


def _quoted(names: Iterable[str]) -> str:
    """Names in quotes, as an enumeration."""
    return listed(f"'{name}'" for name in names)


def find_structure(linkage: Linkage) -> Structure:
    """The driver and the Assur groups of a linkage, in an order in which they can be solved; signs are left 0.

    Raises StructureError where the crank has not exactly one joint to the ground, its pivot, or where the other links
    form no group; then it has the formula of the groups before as ``so_far``.
    """
    search = _PlacedBodies(linkage)
    pivots = [joint for joint in search.joints(linkage.crank) if joint.near == GROUND] if linkage.crank else []
    if linkage.crank and len(pivots) != 1:
        raise StructureError(
            f"crank '{linkage.crank}' of '{linkage.name}': expected one pin to the ground, or one slide on it, and no "
            f"other joint to it, got {listed(joint.name for joint in pivots)}; give it just one point that [ground] "
            "has too"
        )
    pivot = pivots[0] if pivots else None
    search.placed |= {linkage.crank} - {""}
    division, groups = search.division(), list[AnyGroup]()
    try:
        for links in division.groups:
            groups.append(search.group(*links))
            search.placed |= {*links}
        if division.locked or division.loose:
            raise StructureError(search.fault(division))
    except StructureError as error:
        error.so_far = structural_formula(pivot, groups)
        raise
    return Structure(dict(sorted(search.bodies.items())), pivot, tuple(groups))
