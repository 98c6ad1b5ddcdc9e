"""The structure of a linkage: its driver and its Assur groups, in an order in which they can be solved.

Every joint is one of two kinds. A *revolute* joint (R) joins all bodies that carry a point of one name. A *prismatic*
joint (P) lets a body translate along a line of its host without turning against it; a pin in a slot is a massless
slider with an R joint at the pin. A dyad is two unknown links joined to each other by one joint and by one joint each
to bodies already placed; its kind names the three joints in order (outer, inner, outer).
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import GROUND, Link, Linkage, Slider, Vector, rotate
from analytic.kinematics.branch import ChangePoints, GroupBranch

AT_A_CHANGE = 1e-7  # rad
# Kinds of class II groups whose two links can be placed; PPP cannot turn and is no group.
KINDS = ("RRR", "RRP", "RPR", "RPP", "PRP")
# Kinds of links that the driving cylinder places, on a pin and on a slide.
TURNED, PUSHED = "turned by the cylinder", "pushed by the cylinder"
TWO_MODES = ("RRR", "RRP", "RPR", TURNED, PUSHED)
ROMAN = {1: "I", 2: "II", 3: "III", 4: "IV", 5: "V", 6: "VI"}


@dataclass(frozen=True)
class Revolute:
    """An R joint between two bodies, by name: the ``point``'s coordinates, m, in the frame of each."""

    point: str
    near: str
    far: str
    near_local: Vector
    far_local: Vector

    @property
    def name(self) -> str:
        """The joint's name for a reader, such as "pin 'A'"."""
        return f"pin '{self.point}'"


@dataclass(frozen=True)
class Prismatic:
    """A P joint seen from ``near``: the frame of ``far`` lies at ``origin + t·along``, turned by ``turn``.

    All three are in the frame of ``near``: the origin in m, a unit vector, and the cosine and sine of the constant
    angle. ``slider`` is the name of the body that slides.
    """

    slider: str
    near: str
    far: str
    turn: Vector
    origin: Vector
    along: Vector

    @property
    def name(self) -> str:
        """The joint's name for a reader, such as "slide of 'frame' and 'slider'"."""
        return f"slide of '{self.near}' and '{self.far}'"


@dataclass(frozen=True)
class DrivenDistance:
    """The distance between a point of ``near`` and a point of ``far``, which is φ, m: the driver of a linkage.

    Bodies are by name, each point is in its body's frame, m.
    """

    near: str
    far: str
    near_local: Vector
    far_local: Vector


Joint = Revolute | Prismatic
GroupJoint = Joint | DrivenDistance


@dataclass(frozen=True)
class ClosedGroup(ABC):
    """A group that is solved in closed form, known by its ``first`` link.

    ``sign`` (W of the articles, +1 or -1) picks the assembly mode; 0 where there is only one. With ``changes`` it is
    the sign at the sketch's crank angle.
    """

    kind: str
    first: str
    sign: int = field(default=0, kw_only=True)
    changes: ChangePoints | None = field(default=None, compare=False, repr=False, kw_only=True)

    @property
    def has_two_modes(self) -> bool:
        """Whether the closure equations of this kind are quadratic, so that the group has two assembly modes."""
        return self.kind in TWO_MODES

    @property
    def name(self) -> str:
        """The group's links and kind, for a reader, such as "coupler + rocker (RRR)"."""
        return f"{' + '.join(self.links)} ({self.kind})"

    @property
    def words(self) -> str:
        """The group's links, quoted, for a sentence, such as "'coupler' and 'rocker'"."""
        return " and ".join(f"'{link}'" for link in self.links)

    @property
    @abstractmethod
    def links(self) -> tuple[str, ...]:
        """Names of the links that the group places, a pin in a slot by its massless slider, which is no link."""

    @property
    @abstractmethod
    def joints(self) -> tuple[GroupJoint, ...]:
        """The group's joints, outer ones seen from a placed body."""


@dataclass(frozen=True)
class DrivenLink(ClosedGroup):
    """A link on a placed body, by its ``outer`` joint, and at one end of the driving cylinder: the law of cosines."""

    outer: Joint
    cylinder: DrivenDistance

    @property
    def links(self) -> tuple[str, ...]:
        """The name of the link, as the only member."""
        return (self.first,)

    @property
    def joints(self) -> tuple[GroupJoint, ...]:
        """The joint to the placed body, then the cylinder; the other way round where that joint is a slide."""
        return (self.outer, self.cylinder) if self.kind == TURNED else (self.cylinder, self.outer)


@dataclass(frozen=True)
class Dyad(ClosedGroup):
    """An Assur group of class II.

    ``first_joint`` is seen from a placed body to ``first``, ``inner_joint`` from ``second`` to ``first``,
    ``second_joint`` from a placed body to ``second``.
    """

    second: str
    first_joint: Joint
    inner_joint: Joint
    second_joint: Joint

    @property
    def links(self) -> tuple[str, str]:
        """Names of the two links, in the order of the kind's name."""
        return (self.first, self.second)

    @property
    def joints(self) -> tuple[Joint, Joint, Joint]:
        """The three joints in the order of the letters in the kind's name."""
        return (self.first_joint, self.inner_joint, self.second_joint)


@dataclass(frozen=True)
class Group:
    """An Assur group of class III or higher, or with the driving cylinder in it: solved by Newton's method.

    ``joints`` are outer ones, seen from a placed body, and inner ones. ``grade`` is its class by Artobolevskii: the
    sides of its largest closed contour, at least three. ``branch`` is the configuration that the sketch means, followed
    over φ; None until it is.
    """

    links: tuple[str, ...]
    joints: tuple[GroupJoint, ...]
    grade: int
    branch: GroupBranch | None = field(default=None, compare=False, repr=False)

    @property
    def first(self) -> str:
        """The first of its links by name; it identifies the group."""
        return self.links[0]

    @property
    def hosts(self) -> tuple[str, ...]:
        """Names of the placed bodies that its outer joints connect it to, each once."""
        return tuple(dict.fromkeys(body for j in self.joints for body in (j.near, j.far) if body not in self.links))

    @property
    def kind(self) -> str:
        """The group's class in words, or that the driving cylinder is part of it, and that it is solved numerically.

        For example "III, numerical".
        """
        if any(isinstance(joint, DrivenDistance) for joint in self.joints):
            return "with the cylinder, numerical"
        return f"{ROMAN.get(self.grade, str(self.grade))}, numerical"

    @property
    def name(self) -> str:
        """The group's links and kind, for a reader, such as "a + b + c + d (III, numerical)"."""
        return f"{' + '.join(self.links)} ({self.kind})"


AnyGroup = ClosedGroup | Group


@dataclass(frozen=True)
class Structure:
    """The linkage's bodies, the driver's joint to the ground, and the groups in an order in which they can be solved.

    ``bodies`` are the moving ones by name, with a massless slider for each pin in a slot. ``pivot`` is None where a
    cylinder drives: it is a joint of one of the groups.
    """

    bodies: Mapping[str, Link]
    pivot: Revolute | Prismatic | None
    groups: tuple[AnyGroup, ...]

    @property
    def dyads(self) -> tuple[ClosedGroup, ...]:
        """The groups that are solved in closed form: of class II, and a link that the cylinder drives."""
        return tuple(group for group in self.groups if isinstance(group, ClosedGroup))

    @property
    def is_numerical(self) -> bool:
        """Whether a group is solved by Newton's method, so that the reference is a numerical one."""
        return len(self.dyads) < len(self.groups)

    def with_signs(self, signs: tuple[int, ...]) -> Structure:
        """The same structure with the dyads' assembly signs filled in, in order, the same at every crank angle.

        Change points are left out. Raises ValueError for a wrong number of signs.
        """
        if len(signs) != len(self.dyads):
            raise ValueError(f"expected {len(self.dyads)} signs, got {len(signs)}")
        left = iter(signs)
        groups = tuple(
            replace(g, sign=next(left), changes=None) if isinstance(g, ClosedGroup) else g for g in self.groups
        )
        return replace(self, groups=groups)

    def changes_at(self, angle: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Whether crank angles, rad, are change points of a dyad, within 1e-7 rad, for each of them."""
        result = np.zeros(np.shape(angle), dtype=bool)
        for change in {change for dyad in self.dyads if dyad.changes for change in dyad.changes.angles}:
            result |= np.abs(np.mod(angle - change + np.pi, 2.0 * np.pi) - np.pi) < AT_A_CHANGE
        return result

    @property
    def formula(self) -> str:
        """The structural formula as text, the class I driver first, as in "I (crank) -> coupler + rocker (RRR)"."""
        return structural_formula(self.pivot, self.groups)


def revolute_joint(linkage: Linkage, point: str, near: str, far: str) -> Revolute:
    """The R joint of two bodies, by name, that carry a point; raises KeyError if one does not."""
    return Revolute(point, near, far, linkage.local(point, near), linkage.local(point, far))


def prismatic_joint(slider: Slider, anchor: Vector, near: str) -> Prismatic:
    """The P joint of a slider, seen from its host or, if ``near`` is the slider's link, from that.

    ``anchor`` is its point in its frame, m; ``near`` is a name.
    """
    guide = slider.guide
    turn = guide.along
    arm = rotate(anchor, turn)
    origin = (guide.through[0] - arm[0], guide.through[1] - arm[1])
    if near == guide.host:
        return Prismatic(slider.link, guide.host, slider.link, turn, origin, guide.along)
    back = (turn[0], -turn[1])
    home = rotate(origin, back)
    return Prismatic(slider.link, slider.link, guide.host, back, (-home[0], -home[1]), (1.0, 0.0))


def structural_formula(pivot: Joint | None, groups: Sequence[AnyGroup]) -> str:
    """The structural formula as text: driver and groups, as in "I (crank) -> coupler + rocker (RRR)"."""
    driver = "cylinder" if pivot is None else "crank" if isinstance(pivot, Revolute) else "slider"
    return " -> ".join([f"I ({driver})", *(group.name for group in groups)])


# Mobility of a linkage from its joints and lengths alone: Grübler's count and Grashof's rule.


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
        """The degrees of freedom of the linkage by count."""
        return 3 * self.links - 2 * self.joints - self.slots

    @property
    def formula(self) -> str:
        """The count of degrees of freedom written out, as text, such as "1 = 3·3 links - 2·4 pins and slides"."""
        slots = f" - {self.slots} pin{'s' if self.slots > 1 else ''} in slots" if self.slots else ""
        return f"{self.degrees} = 3·{self.links} links - 2·{self.joints} pins and slides{slots}"


def mobility(linkage: Linkage) -> Mobility:
    """The count of degrees of freedom of a linkage; a pin that k bodies share counts as k - 1 joints."""
    joints = len(linkage.joint_names) - len(linkage.slots)
    return Mobility(len(linkage.links), joints, len(linkage.slots))


def loose_points(linkage: Linkage) -> tuple[str, ...]:
    """Names, sorted, of points of links that are on no joint."""
    shared = {pin.point for pin in linkage.pins} | {slot.point for slot in linkage.slots}
    shared |= {slider.point for slider in linkage.sliders} | {*(linkage.cylinder.points if linkage.cylinder else ())}
    counts = Counter(point for link in linkage.links.values() for point in link.points)
    return tuple(sorted(point for point in counts if point not in shared))


def grashof(linkage: Linkage, structure: Structure) -> str | None:
    """The class of a four-bar by Grashof's rule, with its lengths, in words; None for any other linkage.

    The frame and the three links turn fully against each other where shortest + longest < the sum of the other two;
    the shortest link then decides which links turn.
    """
    pivot = structure.pivot
    dyad = structure.dyads[0] if len(structure.dyads) == 1 else None
    if not isinstance(dyad, Dyad) or dyad.kind != "RRR" or not isinstance(pivot, Revolute):
        return None
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
    return _grashof_class(lengths, linkage)


def _grashof_class(lengths: dict[str, float], linkage: Linkage) -> str:
    """The class of a four-bar with these lengths, m, and the two sums that decide it, in words.

    The lengths are by name: frame, crank, coupler and rocker.
    """
    shortest, *middle, longest = sorted(lengths, key=lambda name: lengths[name])
    ends, others = lengths[shortest] + lengths[longest], sum(lengths[name] for name in middle)
    sums = f"shortest + longest {linkage.written(ends)}, the other two {linkage.written(others)}"
    if abs(ends - others) <= EQUAL * others:
        return f"change-point four-bar ({sums})"
    if ends > others:
        return f"four-bar in which nothing turns fully, a triple rocker ({sums})"
    kinds = {"frame": "double-crank", "crank": "crank-rocker", "coupler": "double-rocker", "rocker": "rocker-crank"}
    return f"Grashof {kinds[shortest]} ({sums}; the {shortest} is the shortest)"
