"""Joint forces in closed form: force analysis of the Assur groups, from the last one back to the crank.

Each group is statically determinate, so it is solved by itself (``group_wrenches``) once the loads on its two links are
known: inertia, weight, other loads on them (``analytic.dynamics.loads``), and the reactions of the groups that come
after it. Its reactions in its outer joints are loads on the links before it. The crank comes last; its balance gives
the reaction of its pivot and the torque of the drive. No system of equations of the whole linkage is solved.

Joints are named as in the engines' scenes. A pin of k bodies counts as k - 1 joints to one of them, its hub: the ground
where it has the pin, else the first body by name. Two bodies on a pin make the joint ``point``; more make one joint
``point:link`` for each link but the hub. A slider is ``link on host``, a pin in a slot ``point in host``.

A joint force acts on the link that is not the hub, on the slider, or in a slot on the pin; ground
frame, N. A force applied at a pin of several links acts on the link which ``PointForce.link`` names, a spring on those
in ``Spring.links``, and the joint forces of this pin hold that link in balance.

A *wrench* is (force x, force y, N, moment, N m), ground frame: that of a slide is about the reference point of its
``far`` link, a pin exerts its force at the pin and no moment. A link *needs* the wrench that its joints together must
exert on it, about the link's reference point, which is a pin of its group wherever it has one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from analytic.description.linkage import GROUND, Vector
from analytic.dynamics.loads import Load, all_loads, external_loads
from analytic.kinematics import frames
from analytic.kinematics.frames import Pair, Scalar, cross, dot
from analytic.kinematics.structure import (
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
)
from analytic.kinematics.sweep import Sweep
from analytic.numerics.arrays import Array

# Balance of a force analysis: the wrench that every link still needs from its joints, and the joints' wrenches.

Wrench = tuple[Scalar, Scalar, Scalar]


class LinkBalance:
    """The links at their poses under their loads, before any joint force is known.

    ``needs`` holds, by body, the wrench about its reference point that joints not yet entered must exert. ``at_pins``
    has the force of a pin on each of its bodies, by point and body; ``on_sliders`` that of the guide on each slider,
    those in slots included.
    """

    def __init__(self, sweep: Sweep, loads: Iterable[Load]) -> None:
        """Enter the ``loads`` on all links; raises AssemblyError where the linkage is in a dead position."""
        structure = sweep.structure
        self.structure = structure
        self.drive: Scalar = 0.0  # force of a cylinder
        for group in structure.groups:
            sweep.rates(group.first)  # refuses dead positions, in which the joints cannot hold the links
        self.poses = {body: sweep.poses(body) for body in (GROUND, *structure.bodies)}
        self.reference_points = reference_points(structure)
        self.needs: dict[str, Wrench] = dict.fromkeys(self.poses, (0.0, 0.0, 0.0))
        self.at_pins: dict[tuple[str, str], Pair] = {}
        self.on_sliders: dict[str, Pair] = {}
        for load in loads:
            if load.force is not None:
                self._add_load(load.body, load.force, self.arm(load.body, load.at))
            if load.torque is not None:
                self._add_load(load.body, (0.0, 0.0), (0.0, 0.0), load.torque)

    def enter_outer_wrench(self, joint: GroupJoint, wrench: Wrench) -> None:
        """Enter the wrench of an outer joint on its far link, and its reverse as a load in what the near link needs."""
        self.enter_wrench(joint, wrench)
        x, y, moment = wrench
        arm = self.arm(joint.near, joint.near_local) if isinstance(joint, Revolute) else self.gap(joint.near, joint.far)
        self._add_load(joint.near, (-x, -y), arm, -moment)

    def enter_wrench(self, joint: GroupJoint, wrench: Wrench) -> None:
        """Enter the force of a joint, and its reverse, where those of its kind are kept, none as a load.

        A pin's goes to ``at_pins`` for both bodies, a slide's to ``on_sliders``, the push of a cylinder, N, to
        ``drive``.
        """
        if isinstance(joint, DrivenDistance):
            self.drive = frames.dot(self.direction(joint), (wrench[0], wrench[1]))
        elif isinstance(joint, Revolute):
            self._add_pin_force(joint.point, joint.far, (wrench[0], wrench[1]))
            self._add_pin_force(joint.point, joint.near, (-wrench[0], -wrench[1]))
        else:
            x, y, _ = wrench
            self.on_sliders[joint.slider] = (x, y) if joint.far == joint.slider else (-x, -y)

    def _add_load(self, body: str, force: Pair, arm: Pair, torque: Scalar = 0.0) -> None:
        """Enter a load on a body: force, N, at an ``arm``, m, from the reference point, and torque, N m.

        None on the ground.
        """
        if body != GROUND:
            x, y, moment = self.needs[body]
            self.needs[body] = (x - force[0], y - force[1], moment - frames.cross(arm, force) - torque)

    def _add_pin_force(self, point: str, body: str, force: Pair) -> None:
        """Add a force, N, to that of a pin on a body, since several groups may share the pin."""
        x, y = self.at_pins.get((point, body), (0.0, 0.0))
        self.at_pins[point, body] = (x + force[0], y + force[1])

    def arm(self, body: str, to: Vector) -> Pair:
        """Vector, m, from the reference point of a body to another point of it, ground frame."""
        reference = self.reference_points[body]
        return frames.arm(self.poses[body], (to[0] - reference[0], to[1] - reference[1]))

    def direction(self, cylinder: DrivenDistance) -> Pair:
        """The unit vector along a cylinder, from its near end to its far end."""
        near, far = (self.poses[cylinder.near], self.poses[cylinder.far])
        x, y = frames.minus(frames.point(far, cylinder.far_local), frames.point(near, cylinder.near_local))
        length = np.hypot(x, y)
        return (x / length, y / length)

    def place(self, body: str) -> Pair:
        """Position of the reference point of a body, m, ground frame."""
        return frames.point(self.poses[body], self.reference_points[body])

    def gap(self, start: str, end: str) -> Pair:
        """Vector, m, ground frame, from the reference point of one body to that of another."""
        return frames.minus(self.place(end), self.place(start))


def reference_points(structure: Structure) -> dict[str, Vector]:
    """The reference point of every body, in its own frame, m: its outer pin, else its inner pin, else its mass centre.

    The ground's is its origin. With moments taken about pins, lengths are differences of points of one link, however
    far its frame's origin lies.
    """
    pivot = structure.pivot
    reference = {GROUND: (0.0, 0.0)}
    if pivot is not None:
        reference[pivot.far] = pivot.far_local if isinstance(pivot, Revolute) else structure.bodies[pivot.far].centre
    for group in structure.groups:
        reference.update({body: _pin_of_link(group, body) or structure.bodies[body].centre for body in group.links})
    return reference


def _pin_of_link(group: AnyGroup, body: str) -> Vector | None:
    """A pin of a link in its frame, m: one to a placed body if there is any; None where the link has slides alone."""
    pins = [joint for joint in group.joints if isinstance(joint, Revolute) and body in (joint.near, joint.far)]
    pins.sort(key=lambda joint: joint.near in group.links)
    return next((joint.far_local if body == joint.far else joint.near_local for joint in pins), None)


# Force analysis of the Assur groups: from the wrenches that links need to the forces in the group's joints.
#
# A group is statically determinate: its equations of equilibrium have the unknowns of its joints, two to a pin or a
# slide and one to a cylinder. A dyad is solved in closed form, by the columns d of its velocities: two sides that meet
# in a pin leave it a 2×2 system, the transpose of theirs, a slide between them one equation, and the determinants
# vanish in the same dead positions. (Kinetostatics of Assur groups: I. I. Artobolevskii, Theory of Mechanisms and
# Machines.) A group of class III or higher is solved
# as one system, the transpose of its velocities' too, with moments about the links' reference points.


JointWrenches = list[tuple[GroupJoint, Wrench]]


def group_wrenches(balance: LinkBalance, group: AnyGroup) -> JointWrenches:
    """The wrench of every joint of a group on its far body, as pairs (joint, wrench).

    All later groups have to be entered in the balance.
    """
    if isinstance(group, Group):
        return _wrenches_by_equilibrium(balance, group)
    if isinstance(group, DrivenLink):
        return _wrenches_of_driven_link(balance, group)
    assert isinstance(group, Dyad)
    return (
        _wrenches_of_pin_dyad(balance, group)
        if isinstance(group.inner_joint, Revolute)
        else _wrenches_of_slide_dyad(balance, group)
    )


def _wrenches_of_pin_dyad(balance: LinkBalance, dyad: Dyad) -> JointWrenches:
    """Wrenches of a dyad with an inner pin, whose force N follows from d₁·N = m₁ and −d₂·N = m₂.

    d and m are those of ``_left_by`` for its outer joints. The joints are in order first, inner, second.
    """
    first, inner, second = dyad.joints
    assert isinstance(inner, Revolute)
    d, m = _left_by(balance, first, inner.far_local)
    e, other = _left_by(balance, second, inner.near_local)
    scale = 1.0 / cross(d, e)
    n = ((m * e[1] + other * d[1]) * scale, -(m * e[0] + other * d[0]) * scale)
    outer = _outer_wrench(balance, first, (-n[0], -n[1])), _outer_wrench(balance, second, n)
    return [(first, outer[0]), (inner, (*n, 0.0)), (second, outer[1])]


def _wrenches_of_slide_dyad(balance: LinkBalance, dyad: Dyad) -> JointWrenches:
    """Wrenches of a dyad with an inner slide, which passes on the first link's moment and a force n f⊥.

    f is the unit vector along the slide. The joints are in order first, inner, second.
    """
    first, inner, second = dyad.joints
    f, gap, need = _slide_direction(balance, inner), balance.gap(dyad.second, dyad.first), balance.needs[dyad.second]
    passed = balance.needs[dyad.first][2]
    if isinstance(second, Revolute):
        size = -(passed + need[2]) / dot(gap, f)
    else:
        e = _slide_direction(balance, second)
        size = -dot(e, need[:2]) / cross(f, e)
    x, y, _ = slide = _slide_wrench(f, size, passed)
    outer = _outer_wrench(balance, second, (x, y), passed + cross(gap, (x, y)))
    return [(first, _outer_wrench(balance, first, (-x, -y))), (inner, slide), (second, outer)]


def _wrenches_of_driven_link(balance: LinkBalance, group: DrivenLink) -> JointWrenches:
    """Wrenches of a link that a cylinder drives; its push p, N, along its unit vector u follows from d·u p = m.

    d and m are those of ``_left_by`` for the outer joint, which comes first, then the cylinder.
    """
    u, at = balance.direction(group.cylinder), group.cylinder.far_local
    d, m = _left_by(balance, group.outer, at)
    push = m / dot(d, u)
    moment = push * cross(balance.arm(group.first, at), u)
    outer = _outer_wrench(balance, group.outer, (-push * u[0], -push * u[1]), -moment)
    return [(group.outer, outer), (group.cylinder, (push * u[0], push * u[1], moment))]


def _left_by(balance: LinkBalance, outer: Joint, at: Vector) -> tuple[Pair, Scalar]:
    """The direction d in which a link's point moves on its outer joint, and the load along it that joints must meet.

    The point, ``at``, is in the link's frame, m. Of a pin d is the arm turned by 90°, m, and the load a moment, N m; of
    a slide a unit vector and a force, N.
    """
    need = balance.needs[outer.far]
    if isinstance(outer, Revolute):
        return frames.across(balance.arm(outer.far, at)), need[2]
    e = _slide_direction(balance, outer)
    return e, dot(e, need[:2])


def _outer_wrench(balance: LinkBalance, outer: Joint, more: Pair, moment: Scalar = 0.0) -> Wrench:
    """The wrench of an outer joint on its far link: the load that the link still has to be given, and more.

    ``more`` is a force (x, y), N; of a slide there is also a ``moment``, N m.
    """
    x, y, turn = balance.needs[outer.far]
    force = (x + more[0], y + more[1])
    if isinstance(outer, Revolute):
        return (*force, 0.0)
    e = _slide_direction(balance, outer)
    return _slide_wrench(e, cross(e, force), turn + moment)


def _slide_direction(balance: LinkBalance, slide: Joint) -> Pair:
    """Unit vector along a slide, ground frame."""
    assert isinstance(slide, Prismatic)
    return frames.arm(balance.poses[slide.near], slide.along)


def _slide_wrench(direction: Pair, size: Scalar, moment: Scalar) -> Wrench:
    """The wrench of a slide: a force ``size``, N, to the left of the unit vector ``direction``, and a moment, N m."""
    return (-size * direction[1], size * direction[0], moment)


@dataclass(frozen=True)
class UnitReaction:
    """The wrenches of one unit of a joint's unknown on its far and on its near body."""

    far: Wrench
    near: Wrench


def _wrenches_by_equilibrium(balance: LinkBalance, group: Group) -> list[tuple[GroupJoint, Wrench]]:
    """Wrenches of a group of class III or higher, from the equilibrium of all its links as one linear system.

    A wrench acts on the joint's far body, about that body's reference point (of a pin: at the pin).
    """
    units = [list(_unit_reactions(balance, joint)) for joint in group.joints]
    columns = [(joint, unit) for joint, both in zip(group.joints, units, strict=True) for unit in both]
    needs = [balance.needs[body] for body in group.links]
    shape = np.broadcast_shapes(*(np.shape(part) for need in needs for part in need), *_component_shapes(columns))
    matrix = np.zeros((*shape, len(columns), len(columns)))
    right = np.stack([np.broadcast_to(part, shape) for need in needs for part in need], axis=-1)
    rows = {body: 3 * number for number, body in enumerate(group.links)}
    for column, (joint, unit) in enumerate(columns):
        for body, wrench in ((joint.far, unit.far), (joint.near, unit.near)):
            for part, value in enumerate(wrench if body in rows else ()):
                matrix[..., rows[body] + part, column] = value
    solution = iter(np.moveaxis(np.linalg.solve(matrix, right[..., None])[..., 0], -1, 0))
    return [(joint, _combined_wrench(joint, [(next(solution), unit) for unit in both]))
            for joint, both in zip(group.joints, units, strict=True)]  # fmt: skip


def _component_shapes(columns: list[tuple[GroupJoint, UnitReaction]]) -> Iterator[tuple[int, ...]]:
    """Yield the array shapes of all components of unit reactions, so that they can be broadcast together."""
    yield from (np.shape(part) for _, unit in columns for part in (*unit.far, *unit.near))


def _unit_reactions(balance: LinkBalance, joint: GroupJoint) -> Iterator[UnitReaction]:
    """Yield a unit reaction for each unknown of a joint.

    They are a pin's x and y, a slide's force and moment, a cylinder's push, each of 1 N or 1 N m, as wrenches about the
    bodies' reference points.
    """
    if isinstance(joint, Revolute):
        far, near = (balance.arm(b, at) for b, at in ((joint.far, joint.far_local), (joint.near, joint.near_local)))
        for force in ((1.0, 0.0), (0.0, 1.0)):
            yield UnitReaction((*force, cross(far, force)), _reverse(force, cross(near, force)))
    elif isinstance(joint, DrivenDistance):
        far, near = (balance.arm(b, at) for b, at in ((joint.far, joint.far_local), (joint.near, joint.near_local)))
        u = balance.direction(joint)
        yield UnitReaction((*u, cross(far, u)), _reverse(u, cross(near, u)))
    else:
        x, y, _ = unit = _slide_wrench(_slide_direction(balance, joint), 1.0, 0.0)
        yield UnitReaction(unit, _reverse((x, y), cross(balance.gap(joint.near, joint.far), (x, y))))
        yield UnitReaction((0.0, 0.0, 1.0), (0.0, 0.0, -1.0))


def _reverse(force: tuple[Scalar, Scalar], moment: Scalar) -> Wrench:
    """The reaction to a force and a moment: both with the other sign."""
    return (-force[0], -force[1], -moment)


def _combined_wrench(joint: GroupJoint, shares: list[tuple[Scalar, UnitReaction]]) -> Wrench:
    """The wrench of a joint on its far body, as the sum of unit reactions times their sizes, the ``shares``.

    A pin's has no moment.
    """
    x = sum(size * unit.far[0] for size, unit in shares)
    y = sum(size * unit.far[1] for size, unit in shares)
    moment = 0.0 if isinstance(joint, Revolute) else sum(size * unit.far[2] for size, unit in shares)
    return (x, y, moment)


@dataclass(frozen=True)
class Reactions:
    """Forces of the joints by name, (2, ...), N, ground frame, and the drive's ``torque``; in the sweep's shape.

    ``torque`` (...), N m, is that of the drive on the crank, or its force, N, along a slider's guide or a cylinder; it
    equals ``analytic.dynamics.reduced.drive_torque``, which comes from virtual work, and the share of ``friction``.
    """

    forces: Mapping[str, Array]
    torque: Array
    friction: Array | float = 0.0


def reactions(sweep: Sweep, speed: ArrayLike, acceleration: ArrayLike) -> Reactions:
    """Forces of all joints and the drive's torque, without friction, at a crank speed ω and acceleration ε.

    These, rad/s and rad/s², are signed, of the sweep's shape or scalar; zeros give the static forces. Raises
    AssemblyError where the linkage cannot be put together or stands in a dead position.
    """
    return reactions_to(sweep, all_loads(sweep, speed, acceleration))


def reactions_to(sweep: Sweep, loads: Iterable[Load]) -> Reactions:
    """Forces of all joints, N, and the drive's torque, N m, or force, N, that hold these loads on the links.

    Raises AssemblyError where the linkage cannot be put together or stands in a dead position. Beside a change point
    that the linkage passes forces grow as the reciprocal of the distance, unless nothing loads the group; at the point
    itself they are nan.
    """
    structure, linkage = sweep.structure, sweep.linkage
    balance = LinkBalance(sweep, loads)
    for group in reversed(structure.groups):
        _enter_group(balance, group)
    torque = _enter_driver(balance)
    forces = {joint: balance.at_pins[pin.point, link] for pin in linkage.pins for joint, link in pin.joints.items()}
    forces |= {slider.name: balance.on_sliders[slider.link] for slider in linkage.sliders}
    forces |= {slot.name: balance.on_sliders[slot.name] for slot in linkage.slots}
    singular = structure.changes_at(sweep.angle)
    if singular.any():
        forces = {
            name: (np.where(singular, np.nan, x), np.where(singular, np.nan, y)) for name, (x, y) in forces.items()
        }
    return Reactions({name: _filled(sweep, *force) for name, force in forces.items()}, _filled(sweep, torque)[0])


def _enter_group(balance: LinkBalance, group: AnyGroup) -> None:
    """Compute and enter the forces of a group's joints, once those of later groups are entered."""
    for joint, wrench in group_wrenches(balance, group):
        if joint.near in group.links and joint.far in group.links:
            balance.enter_wrench(joint, wrench)
        else:
            balance.enter_outer_wrench(joint, wrench)


def _enter_driver(balance: LinkBalance) -> Scalar:
    """Enter the wrench of the driver's pin or guide to the ground; returns the drive's torque, N m, or force, N."""
    pivot = balance.structure.pivot
    if pivot is None:
        return balance.drive
    x, y, moment = balance.needs[pivot.far]
    if isinstance(pivot, Revolute):
        balance.enter_wrench(pivot, (x, y, 0.0))
        return moment
    push = frames.dot(pivot.along, (x, y))
    balance.enter_wrench(pivot, (x - push * pivot.along[0], y - push * pivot.along[1], moment))
    return push


def shaking(sweep: Sweep, speed: ArrayLike, acceleration: ArrayLike, about: Vector = (0.0, 0.0)) -> Array:
    """Force of the linkage on its frame, N, and its moment ``about`` a point of the ground, N m: (3, *angle.shape).

    The point is in m; the crank's speed, rad/s, and acceleration, rad/s², are signed, of the sweep's shape or scalar.
    By d'Alembert's principle the frame takes all that acts on the links from outside, Σ weights + Σ applied forces − Σ
    m S̈; inner forces cancel. That is the reverse of what the ground exerts, by joints and by springs and dampers
    fastened to it. The drive stands on the frame: the reverse of its torque is part of the moment. Forces at points and
    torques on links come from outside; their reactions do not act on this frame. Raises AssemblyError where the linkage
    cannot be assembled or moved.
    """
    x: Scalar = 0.0
    y: Scalar = 0.0
    moment: Scalar = 0.0
    for load in external_loads(sweep, speed, acceleration):
        if load.torque is not None:
            moment = moment + load.torque
        if load.force is not None:
            arm = frames.minus(sweep.local_point(load.body, load.at), about)
            x, y, moment = x + load.force[0], y + load.force[1], moment + frames.cross(arm, load.force)
    return _filled(sweep, x, y, moment)


def _filled(sweep: Sweep, *parts: Scalar) -> Array:
    """Numbers, each in the shape of the sweep's angles, as one array (parts, *angle.shape)."""
    return np.stack([np.copy(np.broadcast_to(part, sweep.angle.shape)) for part in parts])
