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

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.linkage import Vector
from analytic.dynamics.group_forces import group_wrenches
from analytic.dynamics.link_balance import LinkBalance, Wrench
from analytic.dynamics.link_loads import LoadedSweep, resultant
from analytic.kinematics import frames
from analytic.kinematics.frames import Pair, Scalar
from analytic.kinematics.structure import AnyGroup, Revolute
from analytic.kinematics.sweep import Sweep

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Reactions:
    """Forces and moments of the joints and of the drive, by joint name; arrays end in the shape of the sweep's angles.

    ``forces`` (2, ...), N; ``moments`` (...), N m, of guides on sliders about their ``Slider.point``; ``torque`` (...),
    N m, of the drive on the crank, or its force, N, along a slider's guide or a cylinder; it equals
    ``analytic.dynamics.reduced.drive_torque``, which comes from virtual work.
    """

    forces: Mapping[str, Array]
    moments: Mapping[str, Array]
    torque: Array


def reactions(sweep: Sweep, speed: ArrayLike, acceleration: ArrayLike) -> Reactions:
    """Forces and moments of all joints for a crank speed ω (rad/s) and acceleration ε (rad/s²).

    Both are signed, of the sweep's shape or scalar; zeros give the static forces. Raises AssemblyError where the
    linkage cannot be put together or stands in a dead position. Beside a change point that the linkage passes forces
    grow as the reciprocal of the distance, unless nothing loads the group; at the point itself they are nan.
    """
    structure, linkage = sweep.structure, sweep.linkage
    balance = LinkBalance(LoadedSweep(sweep, speed, acceleration))
    for group in reversed(structure.groups):
        _book_group(balance, group)
    torque = _book_driver(balance)
    forces = {joint: balance.at_pins[pin.point, link] for pin in linkage.pins for joint, link in pin.joints.items()}
    moments = {}
    for slider in linkage.sliders:
        x, y, moments[slider.name] = balance.on_sliders[slider.link]
        forces[slider.name] = (x, y)
    for slot in linkage.slots:
        forces[slot.name] = balance.on_sliders[slot.name][:2]
    singular = structure.changes_at(sweep.angle)
    if singular.any():
        forces = {name: _undefined(singular, force) for name, force in forces.items()}
    return Reactions(
        {name: _vector(sweep, force) for name, force in forces.items()},
        {name: _full(sweep, moment) for name, moment in moments.items()},
        _full(sweep, torque),
    )


def _book_group(balance: LinkBalance, group: AnyGroup) -> None:
    """Enter the forces of a group's joints."""
    for joint, wrench in group_wrenches(balance, group):
        if joint.near in group.links and joint.far in group.links:
            balance.book(joint, wrench)
        else:
            balance.book_outer(joint, wrench)


def _book_driver(balance: LinkBalance) -> Scalar:
    """Enter the wrench of the driver's joint to the ground; the rest is the drive's: a torque, or a force."""
    pivot = balance.structure.pivot
    if pivot is None:
        return balance.drive
    x, y, moment = balance.needs[pivot.far]
    if isinstance(pivot, Revolute):
        balance.book(pivot, (x, y, 0.0))
        return moment
    push = frames.dot(pivot.along, (x, y))
    balance.book(pivot, (x - push * pivot.along[0], y - push * pivot.along[1], moment))
    return push


def joint_forces(sweep: Sweep, speed: ArrayLike, acceleration: ArrayLike) -> dict[str, Array]:
    """Force of every joint by name, (2, *angle.shape), N, ground frame; names and signs as described above."""
    return dict(reactions(sweep, speed, acceleration).forces)


def shaking_force(sweep: Sweep, speed: ArrayLike, acceleration: ArrayLike) -> Array:
    """Force of the linkage on its frame, (2, *angle.shape), N, ground frame: Σ weights + Σ applied forces − Σ m S̈.

    It is the reverse of all that the ground exerts: by its joints, and by springs fastened to it. The links' weights
    count. Forces at points come from outside; their reactions do not act on this frame.
    """
    x, y, _ = _on_frame(sweep, speed, acceleration, (0.0, 0.0))
    return _vector(sweep, (x, y))


def shaking_moment(sweep: Sweep, speed: ArrayLike, acceleration: ArrayLike, about: Vector = (0.0, 0.0)) -> Array:
    """Moment of the linkage on its frame about a point of the ground, (*angle.shape), N m, counter-clockwise positive.

    The drive stands on the frame: the reverse of its torque is part of the moment, and so are dampers fastened to the
    ground. Torques on links come from outside, as forces at points do (``shaking_force``).
    """
    return _full(sweep, _on_frame(sweep, speed, acceleration, about)[2])


def _on_frame(sweep: Sweep, speed: ArrayLike, acceleration: ArrayLike, about: Vector) -> Wrench:
    """By d'Alembert's principle the frame takes all that acts on the links from outside; inner forces cancel."""
    return resultant(sweep, LoadedSweep(sweep, speed, acceleration).from_outside(), about)


def _undefined(singular: NDArray[np.bool_], force: Pair) -> Pair:
    """A joint's force without its values at change points."""
    return (np.where(singular, np.nan, force[0]), np.where(singular, np.nan, force[1]))


def _full(sweep: Sweep, values: Scalar) -> Array:
    return np.copy(np.broadcast_to(values, sweep.angle.shape))


def _vector(sweep: Sweep, pair: Pair) -> Array:
    return np.stack([_full(sweep, part) for part in pair])
