"""Taking a linkage apart: a class I driver, then Assur groups of two links, found from the description alone.

Every joint is one of two kinds. A *revolute* joint (R) joins all bodies that carry a point of one name. A *prismatic*
joint (P) lets a body translate along a line of its host without turning against it; a pin in a slot is a massless
slider with an R joint at the pin. A dyad is two unknown links joined to each other by one joint and by one joint each
to bodies already placed; its kind names the three joints in order (outer, inner, outer).
"""

from __future__ import annotations

import heapq
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import GROUND, Link, Linkage, Pin, Slider, Vector, rotate
from analytic.errors import StructureError, listed

if TYPE_CHECKING:
    from analytic.kinematics.change_points import ChangePoints
    from analytic.kinematics.groups.branch import Branch

AT_A_CHANGE = 1e-7  # rad
# Kinds of class II groups whose two links can be placed; PPP cannot turn and is no group.
KINDS = ("RRR", "RRP", "RPR", "RPP", "PRP")
ROMAN = {1: "I", 2: "II", 3: "III", 4: "IV", 5: "V", 6: "VI"}


@dataclass(frozen=True)
class Revolute:
    """An R joint between two bodies: the point's coordinates in the frame of each."""

    point: str
    near: str
    far: str
    near_local: Vector
    far_local: Vector

    @property
    def name(self) -> str:
        """The joint, for a reader."""
        return f"pin '{self.point}'"


@dataclass(frozen=True)
class Prismatic:
    """A P joint seen from ``near``: the frame of ``far`` lies at ``origin + t·along``, turned by ``turn``.

    All three are in the frame of ``near``.
    """

    slider: str
    near: str
    far: str
    turn: Vector
    origin: Vector
    along: Vector

    @property
    def name(self) -> str:
        """The joint, for a reader."""
        return f"slide of '{self.near}' and '{self.far}'"


@dataclass(frozen=True)
class Cylinder:
    """The distance between a point of ``near`` and a point of ``far``, which is φ: the driver of a linkage."""

    near: str
    far: str
    near_local: Vector
    far_local: Vector


Joint = Revolute | Prismatic
GroupJoint = Joint | Cylinder


@dataclass(frozen=True)
class Dyad:
    """An Assur group of class II.

    ``first_joint`` is seen from a placed body to ``first``, ``inner_joint`` from ``second`` to ``first``,
    ``second_joint`` from a placed body to ``second``. ``sign`` (W of the articles, +1 or -1) picks the assembly
    mode; 0 where there is only one. With ``changes`` it is the sign at the sketch's crank angle.
    """

    kind: str
    first: str
    second: str
    first_joint: Joint
    inner_joint: Joint
    second_joint: Joint
    sign: int = 0
    changes: ChangePoints | None = field(default=None, compare=False, repr=False)

    @property
    def has_two_modes(self) -> bool:
        """Whether the closure equations of this kind are quadratic."""
        return self.kind in ("RRR", "RRP", "RPR")

    @property
    def links(self) -> tuple[str, str]:
        """The two links."""
        return (self.first, self.second)

    @property
    def joints(self) -> tuple[Joint, Joint, Joint]:
        """The three joints in the order of the kind's name."""
        return (self.first_joint, self.inner_joint, self.second_joint)

    @property
    def name(self) -> str:
        """Links and kind, for a reader."""
        return f"{self.first} + {self.second} ({self.kind})"


@dataclass(frozen=True)
class Group:
    """An Assur group that is no dyad, or one that a cylinder is part of: solved by Newton's method.

    ``joints`` are outer ones, seen from a placed body, and inner ones. ``grade`` is its class by Artobolevskii: the
    sides of its largest closed contour, three of a rigid one. ``branch`` is the configuration that the sketch means,
    followed over φ; None until it is.
    """

    links: tuple[str, ...]
    joints: tuple[GroupJoint, ...]
    grade: int
    branch: Branch | None = field(default=None, compare=False, repr=False)

    @property
    def first(self) -> str:
        """The first link by name, by which the group is known."""
        return self.links[0]

    @property
    def hosts(self) -> tuple[str, ...]:
        """The placed bodies that it hangs on."""
        return tuple(dict.fromkeys(body for j in self.joints for body in (j.near, j.far) if body not in self.links))

    @property
    def kind(self) -> str:
        """Its class, or that the driving cylinder is part of it, and that it is solved by numbers."""
        if any(isinstance(joint, Cylinder) for joint in self.joints):
            return "with the cylinder, numerical"
        return f"{ROMAN.get(self.grade, str(self.grade))}, numerical"

    @property
    def name(self) -> str:
        """Links and kind, for a reader."""
        return f"{' + '.join(self.links)} ({self.kind})"


AnyGroup = Dyad | Group


@dataclass(frozen=True)
class Structure:
    """The linkage's bodies, the driver's joint to the ground, and the groups in an order in which they can be solved.

    ``pivot`` is None where a cylinder drives: it is a joint of one of the groups.
    """

    bodies: Mapping[str, Link]
    pivot: Revolute | Prismatic | None
    groups: tuple[AnyGroup, ...]

    @property
    def dyads(self) -> tuple[Dyad, ...]:
        """The groups of class II, solved in closed form."""
        return tuple(group for group in self.groups if isinstance(group, Dyad))

    @property
    def is_numerical(self) -> bool:
        """Whether a group is solved by Newton's method, so that the reference is a numerical one."""
        return len(self.dyads) < len(self.groups)

    def with_signs(self, signs: tuple[int, ...]) -> Structure:
        """The same structure with the dyads' assembly signs filled in, the same at every crank angle."""
        left = iter(signs)
        groups = tuple(replace(g, sign=next(left), changes=None) if isinstance(g, Dyad) else g for g in self.groups)
        if len(signs) != len(self.dyads):
            raise ValueError(f"expected {len(self.dyads)} signs, got {len(signs)}")
        return replace(self, groups=groups)

    def changes_at(self, angle: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether crank angles, rad, are change points of a dyad, to the digits that such are known with."""
        result = np.zeros(np.shape(angle), dtype=bool)
        for dyad in self.dyads:
            for change in dyad.changes.angles if dyad.changes else ():
                result |= np.abs(np.mod(angle - change + np.pi, 2.0 * np.pi) - np.pi) < AT_A_CHANGE
        return result

    @property
    def formula(self) -> str:
        """The structural formula, class I driver first."""
        return _formula(self.pivot, self.groups)


def revolute_joint(linkage: Linkage, point: str, near: str, far: str) -> Revolute:
    """The R joint of two bodies that carry a point."""
    return Revolute(point, near, far, linkage.local(point, near), linkage.local(point, far))


def prismatic_joint(slider: Slider, anchor: Vector, near: str) -> Prismatic:
    """The P joint of a slider, seen from its host or (the other way round) from the slider itself."""
    guide = slider.guide
    turn = guide.along
    arm = rotate(anchor, turn)
    origin = (guide.through[0] - arm[0], guide.through[1] - arm[1])
    if near == guide.host:
        return Prismatic(slider.link, guide.host, slider.link, turn, origin, guide.along)
    back = (turn[0], -turn[1])
    home = rotate(origin, back)
    return Prismatic(slider.link, slider.link, guide.host, back, (-home[0], -home[1]), (1.0, 0.0))


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


class _Search:
    """The bodies already placed, and which of the others can be placed next.

    A body is looked at when one of its joints gets a placed body on its other side, and never again: the work grows
    with the number of joints.
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
        return sorted(joints, key=lambda joint: _rank(joint.near))

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
                self.holders[pin.point] = min(self.holders.get(pin.point, name), name, key=_rank)
            neighbours.update(_other_end(slider, name) for slider in self.sliders_of[name])
        for name in sorted(neighbours - self.placed):
            outer = self.outer_joints(name)
            if len(outer) > 1:
                raise StructureError(self._overconstrained(name, outer))
            self._reach(name)

    def _reach(self, body: str) -> None:
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
                raise StructureError(self._overconstrained(first, [*self.outer_joints(first), *inner]))
            if inner:
                return self._dyad(first, second, inner[0])
        return None

    def next_group(self) -> Group | None:
        """The first group of a higher class, where no dyad fits."""
        from analytic.kinematics.groups.finding import find_group  # noqa: PLC0415 - SciPy is for the linkages that need it

        return find_group(self.linkage, self.placed, self.holders, self.cylinder())

    def cylinder(self) -> Cylinder | None:
        """The cylinder that drives, seen from a placed body if one of its ends is on one; None once it is placed."""
        driver = self.linkage.cylinder
        if driver is None or {*driver.links} <= self.placed:
            return None
        near, far = zip(driver.points, driver.links, strict=True)
        if far[1] in self.placed:
            near, far = far, near
        return Cylinder(near[1], far[1], self.linkage.local(*near), self.linkage.local(*far))

    def _dyad(self, first: str, second: str, inner: Joint) -> Dyad:
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

    def _overconstrained(self, name: str, joints: Sequence[Joint]) -> str:
        return (
            f"'{name}' of '{self.linkage.name}' is held by too many joints ({listed(joint.name for joint in joints)}), "
            "so the linkage is locked or not built of two-link groups: expected one joint to the links before it and "
            "one to its partner; leave one out"
        )


def _rank(body: str) -> tuple[bool, str]:
    """The ground first, then by name."""
    return (body != GROUND, body)


def _other_end(slider: Slider, body: str) -> str:
    return slider.guide.host if body == slider.link else slider.link


def find_structure(linkage: Linkage) -> Structure:
    """Take the linkage apart; signs are left 0.

    Raises StructureError where the crank has not exactly one joint, its pivot, or where no further group can be found.
    """
    search = _Search(linkage)
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
                raise StructureError(_leftover(search))
            groups.append(group)
            search.place(*group.links)
    except StructureError as error:
        error.so_far = _formula(pivot, groups)
        raise
    return Structure(dict(sorted(search.bodies.items())), pivot, tuple(groups))


def _formula(pivot: Joint | None, groups: Sequence[AnyGroup]) -> str:
    """The driver and the groups behind it."""
    driver = "cylinder" if pivot is None else "crank" if isinstance(pivot, Revolute) else "slider"
    return " -> ".join([f"I ({driver})", *(group.name for group in groups)])


def _leftover(search: _Search) -> str:
    """Why the bodies that are left form no group: too many or too few joints, in all or in a part of the linkage."""
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
