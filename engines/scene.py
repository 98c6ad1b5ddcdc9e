"""The scene an engine is given: rigid bodies in their start state, joints, loads, a drive, and what to record.

Everything is SI and planar. A body's frame sits at its mass centre; ``angle`` is the angle of the link's own
frame against the ground, so local anchors turn with it. Counter-clockwise is positive.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.crank_motion import CrankMotion
from analytic.description.law import Law, TimeLaw
from analytic.description.linkage import GROUND, DriverKind, Vector, rotate


class Channel(StrEnum):
    """The channels that a run must return; an adapter records no others."""

    POSITION = "position"
    VELOCITY = "velocity"
    ACCELERATION = "acceleration"
    TORQUE = "torque"
    JOINT_FORCE = "joint_force"


@dataclass(frozen=True)
class Body:
    """A moving rigid body in its start state; ``inertia`` is None where it cannot turn.

    ``position`` is the mass centre's; velocity and acceleration are its first and second time derivative.
    """

    name: str
    mass: float
    inertia: float | None
    position: Vector
    angle: float
    velocity: Vector
    angular_velocity: float
    acceleration: Vector
    angular_acceleration: float


@dataclass(frozen=True)
class PinJoint:
    """Revolute joint between two bodies; anchors in body frames, in ground coordinates for the ground.

    The joint force is the force the joint exerts on ``first``.
    """

    name: str
    first: str
    second: str
    first_anchor: Vector
    second_anchor: Vector


@dataclass(frozen=True)
class GuidedJoint:
    """Joint that keeps ``anchor`` of ``body`` on a line of ``host`` through a point, along a direction."""

    name: str
    body: str
    anchor: Vector
    host: str
    through: Vector
    along: Vector


class SliderJoint(GuidedJoint):
    """Prismatic joint: ``body`` does not turn against ``host``."""


class SlotJoint(GuidedJoint):
    """Pin in a slot: body and host turn freely."""


@dataclass(frozen=True)
class AppliedForce:
    """Force on a body at an anchor; two components in the ground frame over the crank angle."""

    body: str
    anchor: Vector
    force: Law


@dataclass(frozen=True)
class AppliedTorque:
    """Torque on a body over the crank angle, one component."""

    body: str
    torque: Law


@dataclass(frozen=True)
class PointSpring:
    """Linear spring and dashpot between two anchors (either body may be the ground)."""

    first: str
    second: str
    first_anchor: Vector
    second_anchor: Vector
    stiffness: float
    length: float
    damping: float


@dataclass(frozen=True)
class TurnDamper:
    """Viscous damper on the relative angular velocity of two bodies (either may be the ground)."""

    first: str
    second: str
    coefficient: float


@dataclass(frozen=True)
class Cylinder:
    """A massless driver between two anchors (either body may be the ground): its length is φ.

    Its force is positive where it pushes the two apart; it acts on ``first`` along the line from the second anchor.
    """

    first: str
    second: str
    first_anchor: Vector
    second_anchor: Vector


GUIDES: frozenset[type] = frozenset({SliderJoint, SlotJoint})  # every type of joint beside the pin
LOADS: frozenset[type] = frozenset({AppliedForce, AppliedTorque, PointSpring, TurnDamper})  # every type beside gravity


@dataclass(frozen=True)
class Prescribed:
    """The driver follows ``motion`` exactly; the torque this takes is the drive torque.

    Of a linear driver the motion's angle is φ in m, speed and acceleration are in m/s and m/s², and the recorded
    torque is the force along it, N.
    """

    motion: CrankMotion


@dataclass(frozen=True)
class Free:
    """The driver is moved by a constant torque (and the scene's loads) for ``duration`` seconds.

    Of a linear driver ``torque`` is a force along it, N. ``pace``, rad/s or m/s, is the approximate speed of turning or
    swinging, for the choice of a step; 0 if unknown.
    """

    torque: float
    duration: float
    pace: float = 0.0
    over_time: TimeLaw | None = None

    def torque_at(self, time: ArrayLike) -> NDArray[np.float64]:
        """The drive's whole torque at any time, s."""
        over_time = 0.0 if self.over_time is None else self.over_time(time)
        return np.asarray(np.full(np.shape(time), self.torque) + over_time)


Drive = Prescribed | Free


@dataclass(frozen=True)
class Scene:
    """The whole input of an engine. ``crank`` names the driven body.

    It is pinned to the ground and turns, or slides on the ground and is pushed along its guide; empty where a
    ``cylinder`` drives. ``driver_kind`` is the kind.
    """

    crank: str
    bodies: tuple[Body, ...]
    pins: tuple[PinJoint, ...]
    sliders: tuple[SliderJoint, ...]
    slots: tuple[SlotJoint, ...]
    gravity: Vector
    drive: Drive
    channels: frozenset[Channel]
    forces: tuple[AppliedForce, ...] = ()
    torques: tuple[AppliedTorque, ...] = ()
    springs: tuple[PointSpring, ...] = ()
    dampers: tuple[TurnDamper, ...] = ()
    cylinder: Cylinder | None = None

    @property
    def driver_kind(self) -> DriverKind:
        """Kind of the driver: a crank (φ in rad, a torque), a slider or a cylinder (φ in m, a force)."""
        if self.cylinder is not None:
            return DriverKind.CYLINDER
        rides = any(slider.body == self.crank and slider.host == GROUND for slider in self.sliders)
        return DriverKind.SLIDER if rides else DriverKind.CRANK

    @property
    def driven_slider(self) -> SliderJoint:
        """The slider that is pushed."""
        return next(slider for slider in self.sliders if slider.body == self.crank)

    @property
    def driver_ends(self) -> tuple[str, str, Vector, Vector]:
        """The bodies at the first and second end of a linear driver, and the anchors there.

        φ counts from the second anchor to the first, along the guide of a slider or along the cylinder.
        """
        if self.cylinder is not None:
            ends = self.cylinder
            return ends.first, ends.second, ends.first_anchor, ends.second_anchor
        slider = self.driven_slider
        return slider.body, slider.host, slider.anchor, slider.through

    @property
    def guided(self) -> tuple[SliderJoint | SlotJoint, ...]:
        """The joints that keep a point of a body on a line of its host: sliders, then slots."""
        return (*self.sliders, *self.slots)

    def can_turn(self, body: Body) -> bool:
        """Whether a body can turn: it has an inertia and does not slide on something that cannot."""
        hosts = {slider.body: slider.host for slider in self.sliders}
        name = body.name
        while name in hosts:
            name = hosts[name]
        return body.inertia is not None and name != GROUND

    @property
    def crank_angle(self) -> float:
        """φ at the start: the crank body's angle, unwrapped, rad, or the travel or length of a linear driver, m."""
        if self.driver_kind is DriverKind.CRANK:
            return next(body.angle for body in self.bodies if body.name == self.crank)
        first, second, here, there = self.driver_ends
        span = [a - b for a, b in zip(self._start_place(first, here), self._start_place(second, there), strict=True)]
        if self.cylinder is not None:
            return math.hypot(*span)
        along = self.driven_slider.along
        return span[0] * along[0] + span[1] * along[1]

    def _start_place(self, body: str, anchor: Vector) -> Vector:
        """Where a body's anchor is at the start."""
        if body == GROUND:
            return anchor
        state = next(each for each in self.bodies if each.name == body)
        turned = rotate(anchor, (math.cos(state.angle), math.sin(state.angle)))
        return state.position[0] + turned[0], state.position[1] + turned[1]
