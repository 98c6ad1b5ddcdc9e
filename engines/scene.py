"""The scene an engine is given: rigid bodies in their start state, joints, loads, a drive, and what to record.

Everything is SI and planar. A body's frame sits at its mass centre; ``angle`` is the angle of the link's own
frame against the ground, so local anchors turn with it. Counter-clockwise is positive.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from analytic.description.crank_motion import CrankMotion
from analytic.description.law import Law
from analytic.description.linkage import GROUND, Vector


class Channel(StrEnum):
    """What a run must hand back; an adapter records nothing that is not asked for."""

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


GUIDES: frozenset[type] = frozenset({SliderJoint, SlotJoint})  # every type of joint beside the pin
LOADS: frozenset[type] = frozenset({AppliedForce, AppliedTorque, PointSpring, TurnDamper})  # every type beside gravity


@dataclass(frozen=True)
class Prescribed:
    """The crank follows ``motion`` exactly; the torque this takes is the drive torque."""

    motion: CrankMotion


@dataclass(frozen=True)
class Free:
    """The crank is moved by a constant torque (and the scene's loads) for ``duration`` seconds.

    ``pace``, rad/s, is about how fast it will turn or swing, for the choice of a step; 0 where nobody knows.
    """

    torque: float
    duration: float
    pace: float = 0.0


Drive = Prescribed | Free


@dataclass(frozen=True)
class Scene:
    """All an engine is told. ``crank`` names the driven body, which is pinned to the ground.

    ``crank_angle`` is φ at the start (the crank body's ``angle``, unwrapped).
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
        """φ at the start, rad."""
        return next(body.angle for body in self.bodies if body.name == self.crank)
