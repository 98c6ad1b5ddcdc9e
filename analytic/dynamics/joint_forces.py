"""Joint forces in closed form: force analysis of the Assur groups, from the last one back to the crank.

Each group is statically determinate, so it is solved by itself (``group_forces``) once the loads on its two links are
known: inertia, weight, other loads on them (``link_loads``), and the reactions of the groups that come after it.
Its reactions in its outer joints are loads on the links before it. The crank comes last; its balance gives the
reaction of its pivot and the torque of the drive. No system of equations of the whole linkage is solved.

Joints are named as in the engines' scenes. A pin of k bodies counts as k - 1 joints to one of them, its hub: the ground
where it has the pin, else the first body by name. Two bodies on a pin make the joint ``point``; more make one joint
``point:link`` for each link but the hub. A slider is ``link on host``, a pin in a slot ``point in host``.

A joint force acts on the link that is not the hub, on the slider, or in a slot on the pin; ground
frame, N. A force applied at a pin of several links acts on the link which ``PointForce.link`` names, a spring on those
in ``Spring.links``, and the joint forces of this pin hold that link in balance.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.linkage import Vector
from analytic.dynamics.link_loads import LinkBalance, LoadedSweep, Wrench, resultant
from analytic.kinematics import frames
from analytic.kinematics.frames import Pair, Scalar, cross, dot
from analytic.kinematics.structure import AnyGroup, DrivenDistance, Dyad, Group, GroupJoint, Joint, Prismatic, Revolute
from analytic.kinematics.sweep import Sweep

Array = NDArray[np.float64]

# Force analysis of the Assur groups: from the wrenches that links need to the forces in the group's joints.
#
# A group is statically determinate: its equations of equilibrium have the unknowns of its joints, two to a pin or a
# slide and one to a cylinder. A dyad is solved in closed form: each kind reduces to a 2×2 system at most, the
# transpose of the one which its velocities solve; its determinant vanishes in the same dead positions. (Kinetostatics
# of Assur groups: I. I. Artobolevskii, Theory of Mechanisms and Machines.) A group of class III or higher is solved
# as one system, the transpose of its velocities' too, with moments about the links' reference points.
#
# The moment of a slide is about the reference point of its ``far`` link; a pin exerts its force at the pin and no
# moment.


JointWrenches = tuple[Wrench, Wrench, Wrench]


def group_wrenches(balance: LinkBalance, group: AnyGroup) -> list[tuple[GroupJoint, Wrench]]:
    """The wrench of every joint of a group on its far body, once all later groups are entered."""
    if isinstance(group, Dyad):
        needs = balance.needs[group.first], balance.needs[group.second]
        return list(zip(group.joints, _DYADS[group.kind](balance, group, *needs), strict=True))
    return _wrenches_by_equilibrium(balance, group)


def _rrr(balance: LinkBalance, dyad: Dyad, first: Wrench, two: Wrench) -> JointWrenches:
    """By r × N = M₁ and −q × N = M₂ about the outer pins, r and q from them to the inner one, N is its force."""
    r, q = _inner_arms(balance, dyad)
    scale = 1.0 / cross(r, q)
    n = ((first[2] * q[0] + two[2] * r[0]) * scale, (first[2] * q[1] + two[2] * r[1]) * scale)
    return (first[0] - n[0], first[1] - n[1], 0.0), (n[0], n[1], 0.0), (two[0] + n[0], two[1] + n[1], 0.0)


def _rrp(balance: LinkBalance, dyad: Dyad, first: Wrench, two: Wrench) -> JointWrenches:
    """By r × N = M₁ about the outer pin and −N·e = F₂·e along the slide the inner force is N = a e + b e⊥."""
    (r, _), e = _inner_arms(balance, dyad), _slide_direction(balance, dyad.second_joint)
    f = (two[0], two[1])
    a = -dot(e, f)
    b = (first[2] - a * cross(r, e)) / dot(r, e)
    n = (a * e[0] - b * e[1], a * e[1] + b * e[0])
    return (first[0] - n[0], first[1] - n[1], 0.0), (n[0], n[1], 0.0), _slide_wrench(e, cross(e, f) + b, two[2])


def _rpr(balance: LinkBalance, dyad: Dyad, first: Wrench, two: Wrench) -> JointWrenches:
    """The moments about both outer pins, M₁ + M₂ = −n d·e with d from the second to the first, give n e⊥."""
    e, d = _slide_direction(balance, dyad.inner_joint), balance.gap(dyad.second, dyad.first)
    n = _slide_wrench(e, -(first[2] + two[2]) / dot(d, e), first[2])
    return (first[0] - n[0], first[1] - n[1], 0.0), n, (two[0] + n[0], two[1] + n[1], 0.0)


def _rpp(balance: LinkBalance, dyad: Dyad, first: Wrench, two: Wrench) -> JointWrenches:
    """F₂ = n e⊥ − k f⊥ across the outer and the inner slide; the moments are passed on."""
    e, f = _slide_direction(balance, dyad.second_joint), _slide_direction(balance, dyad.inner_joint)
    scale = 1.0 / cross(e, f)
    force = (two[0], two[1])
    inner = _slide_wrench(f, dot(force, e) * scale, first[2])
    moment = two[2] + (first[2] + cross(balance.gap(dyad.second, dyad.first), (inner[0], inner[1])))
    return (first[0] - inner[0], first[1] - inner[1], 0.0), inner, _slide_wrench(e, dot(force, f) * scale, moment)


def _prp(balance: LinkBalance, dyad: Dyad, row: Wrench, two: Wrench) -> JointWrenches:
    """N·e = F₁·e and −N·f = F₂·f along the slides give the inner force N = a e⊥ + b f⊥."""
    e, f = _slide_direction(balance, dyad.first_joint), _slide_direction(balance, dyad.second_joint)
    scale = 1.0 / cross(e, f)
    first, second = (row[0], row[1]), (two[0], two[1])
    a, b = -dot(second, f) * scale, -dot(first, e) * scale
    both = dot(e, f)
    n = (-a * e[1] - b * f[1], a * e[0] + b * f[0], 0.0)
    return (
        _slide_wrench(e, cross(e, first) - a - b * both, row[2]),
        n,
        _slide_wrench(f, cross(f, second) + a * both + b, two[2]),
    )


_DYADS: Mapping[str, Callable[[LinkBalance, Dyad, Wrench, Wrench], JointWrenches]] = {
    "RRR": _rrr,
    "RRP": _rrp,
    "RPR": _rpr,
    "RPP": _rpp,
    "PRP": _prp,
}


def _inner_arms(balance: LinkBalance, dyad: Dyad) -> tuple[Pair, Pair]:
    """Vectors, m, from the reference points of both links to the inner pin."""
    inner = dyad.inner_joint
    assert isinstance(inner, Revolute)
    return balance.arm(dyad.first, inner.far_local), balance.arm(dyad.second, inner.near_local)


def _slide_direction(balance: LinkBalance, slide: Joint) -> Pair:
    """Unit vector along a slide."""
    assert isinstance(slide, Prismatic)
    return frames.arm(balance.poses[slide.near], slide.along)


def _slide_wrench(direction: Pair, size: Scalar, moment: Scalar) -> Wrench:
    """The wrench of a slide: a force square to it, on its left where ``size`` is positive, and a moment."""
    return (-size * direction[1], size * direction[0], moment)


@dataclass(frozen=True)
class UnitReaction:
    """The wrenches of one unit of a joint's unknown on its far and on its near body."""

    far: Wrench
    near: Wrench


def _wrenches_by_equilibrium(balance: LinkBalance, group: Group) -> list[tuple[GroupJoint, Wrench]]:
    """As ``group_wrenches``, for a group of class III or higher: the equilibrium of all its links as one linear system.

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
    yield from (np.shape(part) for _, unit in columns for part in (*unit.far, *unit.near))


def _unit_reactions(balance: LinkBalance, joint: GroupJoint) -> Iterator[UnitReaction]:
    """A unit of each unknown: a pin's force along x and y, a slide's across its line and moment, a cylinder's push."""
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
    return (-force[0], -force[1], -moment)


def _combined_wrench(joint: GroupJoint, shares: list[tuple[Scalar, UnitReaction]]) -> Wrench:
    """The wrench of a joint on its far body: unit reactions times their sizes, added up."""
    x = sum(size * unit.far[0] for size, unit in shares)
    y = sum(size * unit.far[1] for size, unit in shares)
    moment = 0.0 if isinstance(joint, Revolute) else sum(size * unit.far[2] for size, unit in shares)
    return (x, y, moment)


@dataclass(frozen=True)
class Reactions:
    """Forces of the joints by name, (2, ...), N, ground frame, and the drive's ``torque``; in the sweep's shape.

    ``torque`` (...), N m, is that of the drive on the crank, or its force, N, along a slider's guide or a cylinder; it
    equals ``analytic.dynamics.reduced.drive_torque``, which comes from virtual work.
    """

    forces: Mapping[str, Array]
    torque: Array


def reactions(sweep: Sweep, speed: ArrayLike, acceleration: ArrayLike) -> Reactions:
    """Forces of all joints for a crank speed ω (rad/s) and acceleration ε (rad/s²).

    Both are signed, of the sweep's shape or scalar; zeros give the static forces. Raises AssemblyError where the
    linkage cannot be put together or stands in a dead position. Beside a change point that the linkage passes forces
    grow as the reciprocal of the distance, unless nothing loads the group; at the point itself they are nan.
    """
    structure, linkage = sweep.structure, sweep.linkage
    balance = LinkBalance(LoadedSweep(sweep, speed, acceleration))
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
    """Enter the forces of a group's joints."""
    for joint, wrench in group_wrenches(balance, group):
        if joint.near in group.links and joint.far in group.links:
            balance.enter_wrench(joint, wrench)
        else:
            balance.enter_outer_wrench(joint, wrench)


def _enter_driver(balance: LinkBalance) -> Scalar:
    """Enter the wrench of the driver's joint to the ground; the rest is the drive's: a torque, or a force."""
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
    """Force of the linkage on its frame, N, and its moment about a point of the ground, N m: (3, *angle.shape).

    By d'Alembert's principle the frame takes all that acts on the links from outside, Σ weights + Σ applied forces −
    Σ m S̈; inner forces cancel. That is the reverse of what the ground exerts, by joints and by springs and dampers
    fastened to it. The drive stands on the frame: the reverse of its torque is part of the moment. Forces at points and
    torques on links come from outside; their reactions do not act on this frame.
    """
    return _filled(sweep, *resultant(sweep, LoadedSweep(sweep, speed, acceleration).external_loads(), about))


def _filled(sweep: Sweep, *parts: Scalar) -> Array:
    """Numbers, each in the shape of the sweep's angles, as one array."""
    return np.stack([np.copy(np.broadcast_to(part, sweep.angle.shape)) for part in parts])
