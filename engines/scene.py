"""The scene an engine is given: rigid bodies in their start state, joints, loads, a drive, and what to record.

Everything is SI and planar. A body's frame sits at its mass centre; ``angle`` is the angle of the link's own
frame against the ground, so local anchors turn with it. Counter-clockwise is positive.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.crank_motion import CrankMotion
from analytic.description.law import Law, TimeLaw
from analytic.description.linkage import GROUND, Direction, DriverKind, Linkage, Position, Slider, Slot, Vector
from analytic.description.units import Kind


class Channel(StrEnum):
    """The channels that a run must return; an adapter records no others."""

    POSITION = "position"
    VELOCITY = "velocity"
    ACCELERATION = "acceleration"
    TORQUE = "torque"
    JOINT_FORCE = "joint_force"


LEVELS = (Channel.POSITION, Channel.VELOCITY, Channel.ACCELERATION)  # of bodies, each the rate of the one before


@dataclass(frozen=True)
class Body:
    """A moving rigid body in its start state; ``inertia`` is None where it cannot turn.

    ``position`` is the mass centre's; velocity and acceleration are its first and second time derivative.
    """

    name: str
    mass: Annotated[float, Kind.MASS]
    inertia: Annotated[float | None, Kind.INERTIA]
    position: Position
    angle: Annotated[float, Kind.ANGLE]
    velocity: Annotated[Vector, Kind.VELOCITY]
    angular_velocity: Annotated[float, Kind.ANGULAR_VELOCITY]
    acceleration: Annotated[Vector, Kind.ACCELERATION]
    angular_acceleration: Annotated[float, Kind.ANGULAR_ACCELERATION]


End = tuple[str, Vector]  # a body, or the ground, by its name, and a point of it in its frame


class TwoPoints:
    """What acts between a point of one body and a point of another; either may be the ground."""

    first: str
    second: str
    first_anchor: Position
    second_anchor: Position

    @property
    def ends(self) -> tuple[End, End]:
        """The first body's name and the point on it, in its frame, m; then the second's."""
        return (self.first, self.first_anchor), (self.second, self.second_anchor)


@dataclass(frozen=True)
class PinJoint(TwoPoints):
    """Revolute joint between two bodies; anchors in body frames, in ground coordinates for the ground.

    The joint force is the force the joint exerts on ``first``.
    """

    name: str
    first: str
    second: str
    first_anchor: Position
    second_anchor: Position


@dataclass(frozen=True)
class GuidedJoint:
    """Joint that keeps ``anchor`` of ``body`` on a line of ``host`` through a point, along a direction.

    Each is in the frame of its body; the joint force is the force the joint exerts on ``body``.
    """

    name: str
    body: str
    anchor: Position
    host: str
    through: Position
    along: Direction

    @property
    def ends(self) -> tuple[End, End]:
        """The body's name and its point, then the host's name and a point of the line; body frames, m."""
        return (self.body, self.anchor), (self.host, self.through)


class SliderJoint(GuidedJoint):
    """Prismatic joint: ``body`` does not turn against ``host``."""


class SlotJoint(GuidedJoint):
    """Pin in a slot: body and host turn freely."""


@dataclass(frozen=True)
class AppliedForce:
    """Force on a body at an anchor; two components in the ``frame`` of a body, and the reverse on the ``reaction``.

    ``body``, ``frame`` and ``reaction`` are names.
    """

    body: str
    anchor: Position
    force: Annotated[Law, Kind.FORCE]
    frame: str = GROUND
    reaction: str = GROUND


@dataclass(frozen=True)
class AppliedTorque:
    """Torque on a body, one component."""

    body: str
    torque: Annotated[Law, Kind.TORQUE]


@dataclass(frozen=True)
class PointSpring(TwoPoints):
    """Linear spring and dashpot between two anchors."""

    first: str
    second: str
    first_anchor: Position
    second_anchor: Position
    stiffness: Annotated[float, Kind.STIFFNESS]
    length: Annotated[float, Kind.LENGTH]
    damping: Annotated[float, Kind.DAMPING]


@dataclass(frozen=True)
class TurnDamper:
    """Viscous damper on the relative angular velocity of two bodies (either may be the ground)."""

    first: str
    second: str
    coefficient: Annotated[float, Kind.TURN_DAMPING]


@dataclass(frozen=True)
class TurnSpring:
    """Torsion spring of two bodies (either may be the ground), free where the first is at ``angle`` to the second.

    The difference from that counts within half a turn to either side.
    """

    first: str
    second: str
    stiffness: Annotated[float, Kind.TORQUE]
    angle: Annotated[float, Kind.ANGLE]


@dataclass(frozen=True)
class Cylinder(TwoPoints):
    """A massless driver between two anchors: its length is φ.

    Its force is positive where it pushes the two apart; it acts on ``first`` along the line from the second anchor.
    """

    first: str
    second: str
    first_anchor: Position
    second_anchor: Position


@dataclass(frozen=True)
class CoulombFriction:
    """Friction of a joint by its own force: M = μ r |F| of a pin of a radius, F = μ |N| along a guide, of radius 0.

    A guide's acts at the anchor of its body.
    """

    name: str
    coefficient: Annotated[float, Kind.RATIO]
    radius: Annotated[float, Kind.LENGTH] = 0.0


@dataclass(frozen=True)
class Travel:
    """The output's travel S: from ``zero``, m, back along a direction of the ground, of a point of a body."""

    body: str
    anchor: Position
    along: Direction
    zero: Annotated[float, Kind.LENGTH]


GUIDES: frozenset[type] = frozenset({SliderJoint, SlotJoint})  # every type of joint beside the pin
Load = AppliedForce | AppliedTorque | PointSpring | TurnDamper | TurnSpring
LOADS: frozenset[type] = frozenset({AppliedForce, AppliedTorque, PointSpring, TurnDamper})  # what engines mostly have


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

    torque: Annotated[float, Kind.DRIVE]
    duration: Annotated[float, Kind.TIME]
    pace: Annotated[float, Kind.COORDINATE_SPEED] = 0.0
    over_time: TimeLaw | None = None

    def torque_at(self, time: ArrayLike) -> NDArray[np.float64]:
        """The drive's whole torque, N m, or force, N, at times, s, in their shape."""
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
    gravity: Annotated[Vector, Kind.ACCELERATION]
    drive: Drive
    channels: frozenset[Channel]
    forces: tuple[AppliedForce, ...] = ()
    torques: tuple[AppliedTorque, ...] = ()
    springs: tuple[PointSpring, ...] = ()
    dampers: tuple[TurnDamper, ...] = ()
    turn_springs: tuple[TurnSpring, ...] = ()
    cylinder: Cylinder | None = None
    travel: Travel | None = None  # where a load depends on it
    friction: tuple[CoulombFriction, ...] = ()

    @property
    def driver_kind(self) -> DriverKind:
        """Kind of the driver: a crank (φ in rad, a torque), a slider or a cylinder (φ in m, a force)."""
        if self.cylinder is not None:
            return DriverKind.CYLINDER
        rides = any(slider.body == self.crank and slider.host == GROUND for slider in self.sliders)
        return DriverKind.SLIDER if rides else DriverKind.CRANK

    @property
    def loads(self) -> tuple[Load, ...]:
        """All loads except gravity and friction: forces, torques, springs, dampers, torsion springs."""
        return (*self.forces, *self.torques, *self.springs, *self.dampers, *self.turn_springs)

    @property
    def driven_slider(self) -> SliderJoint:
        """The slider whose body is the driven one, ``crank``; raises StopIteration where there is none."""
        return next(slider for slider in self.sliders if slider.body == self.crank)

    @property
    def driver_ends(self) -> tuple[End, End]:
        """The two ends, each a body's name and a point of it, of a linear driver; raises StopIteration for a crank.

        φ counts from the second anchor to the first, along the guide of a slider or along the cylinder.
        """
        return (self.cylinder or self.driven_slider).ends

    @property
    def guided(self) -> tuple[SliderJoint | SlotJoint, ...]:
        """The joints that keep a point of a body on a line of its host: sliders, then slots."""
        return (*self.sliders, *self.slots)

    @property
    def joints(self) -> tuple[PinJoint | SliderJoint | SlotJoint, ...]:
        """All joints: pins, sliders, slots."""
        return (*self.pins, *self.guided)

    def can_turn(self, body: Body) -> bool:
        """Whether a body of the scene can turn: it has an inertia and does not slide on something that cannot."""
        return body.inertia is not None and turns(body.name, {each.body: each.host for each in self.sliders})


# From a linkage and a start state to the scene an engine is given, with nothing in it that its motion can spare.


def build_scene(
    linkage: Linkage, start: Mapping[str, Body], drive: Drive, channels: frozenset[Channel], zero_of_s: float = 0.0
) -> Scene:
    """The scene, which is all that an engine is given of a linkage; ``start`` has each link by name, as a body.

    A slider that acts as a point mass becomes a pin in a slot, and its inertia its host's; a body that cannot turn has
    no inertia. ``channels`` are those to record. ``zero_of_s`` is the output's coordinate, m, from which loads over S
    count. Raises KeyError for a link that ``start`` lacks.
    """
    merged = {slider.link: slider for slider in linkage.sliders if is_pin_mass(linkage, slider)}
    pins = tuple(
        PinJoint(
            name,
            link,
            pin.hub,
            _anchor_of_point(linkage, pin.point, link),
            _anchor_of_point(linkage, pin.point, pin.hub),
        )
        for pin in linkage.pins
        for name, link in pin.joints.items()
    )
    sliders = [slider for slider in linkage.sliders if slider.link not in merged]
    slots: list[tuple[Slider | Slot, str]] = [(slot, _slot_body(linkage, slot)) for slot in linkage.slots]
    slots += [(slider, slider.link) for slider in merged.values()]
    return Scene(
        crank=linkage.crank,
        bodies=tuple(_body(linkage, start[name], merged) for name in linkage.links),
        pins=pins,
        sliders=tuple(SliderJoint(*_line(linkage, slider, slider.link)) for slider in sliders),
        slots=tuple(SlotJoint(*_line(linkage, joint, body)) for joint, body in slots),
        gravity=linkage.gravity,
        drive=drive,
        channels=channels,
        forces=tuple(
            AppliedForce(f.link, _anchor_of_point(linkage, f.point, f.link), f.force, f.frame, f.reaction or GROUND)
            for f in linkage.forces
        ),
        torques=tuple(
            AppliedTorque(body, law)
            for t in linkage.torques
            for body, law in ((t.link, t.torque), (t.reaction or GROUND, replace(t.torque, values=-t.torque.values)))
            if body != GROUND
        ),
        springs=tuple(
            PointSpring(
                first=s.links[0],
                second=s.links[1],
                first_anchor=_anchor_of_point(linkage, s.points[0], s.links[0]),
                second_anchor=_anchor_of_point(linkage, s.points[1], s.links[1]),
                stiffness=s.stiffness,
                length=s.length,
                damping=s.damping,
            )
            for s in linkage.springs
        ),
        dampers=tuple(TurnDamper(*damper.links, damper.coefficient) for damper in linkage.dampers),
        turn_springs=tuple(TurnSpring(*coil.links, coil.stiffness, coil.angle) for coil in linkage.torsion_springs),
        cylinder=_cylinder(linkage),
        travel=_travel(linkage, zero_of_s),
        friction=tuple(_friction(linkage)),
    )


def _friction(linkage: Linkage) -> Iterator[CoulombFriction]:
    """Yield the friction of each joint that has any, named as the joint is."""
    joints = [(name, pin.point) for pin in linkage.pins for name in pin.joints]
    joints += [(slider.name, slider.link) for slider in linkage.sliders]
    joints += [(slot.name, slot.name) for slot in linkage.slots]
    for name, key in joints:
        if key in linkage.friction:
            yield CoulombFriction(name, linkage.friction[key].coefficient, linkage.friction[key].radius)


def _travel(linkage: Linkage, zero: float) -> Travel | None:
    """The output's travel S, which counts from ``zero``, m; None without an output or a load that depends on it."""
    output = linkage.output
    if output is None or not linkage.has_loads_of_output:
        return None
    return Travel(output.link, _anchor_of_point(linkage, output.point, output.link), output.along, zero)


def _cylinder(linkage: Linkage) -> Cylinder | None:
    """The driving cylinder of the scene; None for another driver."""
    driver = linkage.cylinder
    if driver is None:
        return None
    here, there = (
        _anchor_of_point(linkage, point, link) for point, link in zip(driver.points, driver.links, strict=True)
    )
    return Cylinder(*driver.links, here, there)


def is_pin_mass(linkage: Linkage, slider: Slider) -> bool:
    """Whether a slider in a moving slot acts as a point mass, so that its inertia can be added to the host's.

    Its one point is its centre, which is pinned, and nothing turns it or turns with it: no friction, guide, damper,
    cylinder, torque, and no force in its frame or with its reaction on it.
    """
    link = linkage.links[slider.link]
    return (
        slider.guide.host != GROUND
        and link.points[slider.point] == link.centre
        and len(link.points) == 1
        and any(slider.link in pin.links for pin in linkage.pins)
        and not any(slider.link == other.guide.host for other in linkage.sliders)
        and not any(slider.link == slot.guide.host for slot in linkage.slots)
        and not any(slider.link in (torque.link, torque.reaction) for torque in linkage.torques)
        and not any(slider.link in (force.frame, force.reaction) for force in linkage.forces)
        and slider.point not in linkage.friction
        and not any(slider.link in damper.links for damper in linkage.dampers)
        and not (linkage.cylinder is not None and slider.link in linkage.cylinder.links)
    )


def _body(linkage: Linkage, start: Body, merged: Mapping[str, Slider]) -> Body:
    """A copy of a body's start for the scene: without inertia and turning if it cannot turn, else with its pin masses.

    These are the sliders on it among ``merged``, by link, whose inertias are added to its own.
    """
    hosts = {slider.link: slider.guide.host for slider in linkage.sliders}
    if start.inertia is None or start.name in merged or not turns(start.name, hosts):
        # A pin mass in a turning slot cannot turn, so its initial angular velocity is zero.
        return replace(start, inertia=None, angular_velocity=0.0, angular_acceleration=0.0)
    pinned = [linkage.links[name].inertia or 0.0 for name, s in merged.items() if s.guide.host == start.name]
    return replace(start, inertia=sum(pinned, start.inertia))


def turns(name: str, hosts: Mapping[str, str]) -> bool:
    """Whether a body, by its name, can turn: a slider if its host can, any other if it is not the ground.

    ``hosts`` names each slider's host by the slider. Bodies that slide on each other in a circle count as turning.
    """
    left = dict(hosts)
    while name in left:
        name = left.pop(name)
    return name != GROUND


def _from_centre(linkage: Linkage, body: str, local: Vector) -> Vector:
    """A point of a body, given in its link's frame, from its mass centre, m; one of the ground comes back as it is."""
    if body == GROUND:
        return local
    centre = linkage.links[body].centre
    return (local[0] - centre[0], local[1] - centre[1])


def _anchor_of_point(linkage: Linkage, point: str, body: str) -> Vector:
    """A named point of a body, from its mass centre, in its frame, m; raises KeyError where it has no such point."""
    return _from_centre(linkage, body, linkage.local(point, body))


def _slot_body(linkage: Linkage, slot: Slot) -> str:
    """Name of the body, or GROUND, that carries the pin of a slot and is not the slot's host."""
    if slot.point in linkage.ground:
        return GROUND
    return next(name for name, link in linkage.links.items() if slot.point in link.points and name != slot.guide.host)


def _line(linkage: Linkage, joint: Slider | Slot, body: str) -> tuple[str, str, Vector, str, Vector, Vector]:
    """The fields of a scene's slider or slot that moves ``body``: names, anchor and guide, from mass centres, m.

    They are the joint's name, the body and its anchor, the host, a point of the guide and its direction.
    """
    guide = joint.guide
    through = _from_centre(linkage, guide.host, guide.through)
    return joint.name, body, _anchor_of_point(linkage, joint.point, body), guide.host, through, guide.along
