"""From a linkage and a start state to the scene an engine is given, with nothing in it that its motion can spare."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from analytic.description.linkage import GROUND, Guide, Linkage, Slider, Vector
from engines.scene import (
    AppliedForce,
    AppliedTorque,
    Body,
    Channel,
    Drive,
    PinJoint,
    PointSpring,
    Scene,
    SliderJoint,
    SlotJoint,
    TurnDamper,
)


@dataclass(frozen=True)
class LinkState:
    """Where a link is at the start: its mass centre and frame angle with their first two time derivatives."""

    position: Vector
    angle: float
    velocity: Vector
    angular_velocity: float
    acceleration: Vector
    angular_acceleration: float


def build_scene(linkage: Linkage, start: Mapping[str, LinkState], drive: Drive, channels: frozenset[Channel]) -> Scene:
    """Everything an engine is told of a linkage; ``start`` holds the state of every link."""
    merged: dict[str, Slider] = {slider.link: slider for slider in linkage.sliders if is_pin_mass(linkage, slider)}
    bodies = tuple(_body(linkage, name, start[name], merged) for name in linkage.links)
    pins = tuple(
        PinJoint(name, link, pin.hub, _anchor(linkage, pin.point, link), _anchor(linkage, pin.point, pin.hub))
        for pin in linkage.pins
        for name, link in pin.joints.items()
    )
    sliders = tuple(
        SliderJoint(
            s.name,
            s.link,
            _anchor(linkage, s.point, s.link),
            s.guide.host,
            _from_centre(linkage, s.guide.host, s.guide.through),
            s.guide.along,
        )
        for s in linkage.sliders
        if s.link not in merged
    )
    return Scene(
        crank=linkage.crank,
        bodies=bodies,
        pins=pins,
        sliders=sliders,
        slots=_slot_joints(linkage, merged),
        gravity=linkage.gravity,
        drive=drive,
        channels=channels,
        forces=tuple(AppliedForce(f.link, _anchor(linkage, f.point, f.link), f.force) for f in linkage.forces),
        torques=tuple(AppliedTorque(t.link, t.torque) for t in linkage.torques),
        springs=tuple(
            PointSpring(
                first=s.links[0],
                second=s.links[1],
                first_anchor=_anchor(linkage, s.points[0], s.links[0]),
                second_anchor=_anchor(linkage, s.points[1], s.links[1]),
                stiffness=s.stiffness,
                length=s.length,
                damping=s.damping,
            )
            for s in linkage.springs
        ),
        dampers=tuple(TurnDamper(*damper.links, damper.coefficient) for damper in linkage.dampers),
    )


def is_pin_mass(linkage: Linkage, slider: Slider) -> bool:
    """Whether a slider in a moving slot acts as a point mass at its pin: its inertia can then be given to the host."""
    link = linkage.links[slider.link]
    return (
        slider.guide.host != GROUND
        and link.points[slider.point] == link.centre
        and len(link.points) == 1
        and any(slider.link in pin.links for pin in linkage.pins)
        and not any(slider.link == other.guide.host for other in linkage.sliders)
        and not any(slider.link == slot.guide.host for slot in linkage.slots)
        and not any(slider.link == torque.link for torque in linkage.torques)
        and not any(slider.link in damper.links for damper in linkage.dampers)
    )


def _body(linkage: Linkage, name: str, state: LinkState, merged: Mapping[str, Slider]) -> Body:
    link = linkage.links[name]
    inertia = None if name in merged or not _can_turn(linkage, name) else link.inertia
    for slider in merged.values():
        if slider.guide.host == name and inertia is not None:
            inertia += linkage.links[slider.link].inertia or 0.0
    turns = inertia is not None  # a pin mass in a turning slot is told not to, so it may not start as if it did
    return Body(
        name,
        link.mass,
        inertia,
        state.position,
        state.angle,
        state.velocity,
        state.angular_velocity if turns else 0.0,
        state.acceleration,
        state.angular_acceleration if turns else 0.0,
    )


def _can_turn(linkage: Linkage, name: str) -> bool:
    hosts = {slider.link: slider.guide.host for slider in linkage.sliders}
    while name in hosts:
        name = hosts[name]
    return name != GROUND


def _from_centre(linkage: Linkage, body: str, local: Vector) -> Vector:
    """A point of a body relative to its mass centre; the ground keeps its own frame."""
    if body == GROUND:
        return local
    centre = linkage.links[body].centre
    return (local[0] - centre[0], local[1] - centre[1])


def _anchor(linkage: Linkage, point: str, body: str) -> Vector:
    return _from_centre(linkage, body, linkage.local(point, body))


def _slot_joints(linkage: Linkage, merged: Mapping[str, Slider]) -> tuple[SlotJoint, ...]:
    joints = []
    for slot in linkage.slots:
        owners = [name for name, link in linkage.links.items() if slot.point in link.points and name != slot.guide.host]
        body = GROUND if slot.point in linkage.ground else owners[0]
        joints.append(_slot(linkage, slot.name, body, slot.point, slot.guide))
    joints += [_slot(linkage, s.name, s.link, s.point, s.guide) for s in merged.values()]
    return tuple(joints)


def _slot(linkage: Linkage, name: str, body: str, point: str, guide: Guide) -> SlotJoint:
    through = _from_centre(linkage, guide.host, guide.through)
    return SlotJoint(name, body, _anchor(linkage, point, body), guide.host, through, guide.along)
