"""From a linkage and a start state to the scene an engine is given, with nothing in it that its motion can spare."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from analytic.description.linkage import GROUND, Linkage, Slider, Slot, Vector
from engines.scene import (
    AppliedForce,
    AppliedTorque,
    Body,
    Channel,
    Cylinder,
    Drive,
    PinJoint,
    PointSpring,
    Scene,
    SliderJoint,
    SlotJoint,
    TurnDamper,
)


def build_scene(linkage: Linkage, start: Mapping[str, Body], drive: Drive, channels: frozenset[Channel]) -> Scene:
    """The whole input of an engine for a linkage; ``start`` holds every link as a body in its state."""
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
        forces=tuple(AppliedForce(f.link, _anchor_of_point(linkage, f.point, f.link), f.force) for f in linkage.forces),
        torques=tuple(AppliedTorque(t.link, t.torque) for t in linkage.torques),
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
        cylinder=_cylinder(linkage),
    )


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
        and not (linkage.cylinder is not None and slider.link in linkage.cylinder.links)
    )


def _body(linkage: Linkage, start: Body, merged: Mapping[str, Slider]) -> Body:
    """A body of the scene: without inertia where it cannot turn, with those of the pin masses in its slots."""
    if start.inertia is None or start.name in merged or not _can_turn(linkage, start.name):
        # A pin mass in a turning slot cannot turn, so its initial angular velocity is zero.
        return replace(start, inertia=None, angular_velocity=0.0, angular_acceleration=0.0)
    pinned = [linkage.links[name].inertia or 0.0 for name, s in merged.items() if s.guide.host == start.name]
    return replace(start, inertia=sum(pinned, start.inertia))


def _can_turn(linkage: Linkage, name: str) -> bool:
    """Whether a link turns: a slider does where its host does."""
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


def _anchor_of_point(linkage: Linkage, point: str, body: str) -> Vector:
    return _from_centre(linkage, body, linkage.local(point, body))


def _slot_body(linkage: Linkage, slot: Slot) -> str:
    """The body, or the ground, that carries the point of a slot, beside the slot's host."""
    if slot.point in linkage.ground:
        return GROUND
    return next(name for name, link in linkage.links.items() if slot.point in link.points and name != slot.guide.host)


def _line(linkage: Linkage, joint: Slider | Slot, body: str) -> tuple[str, str, Vector, str, Vector, Vector]:
    """The fields of a scene's slider or slot whose point is on ``body``."""
    guide = joint.guide
    through = _from_centre(linkage, guide.host, guide.through)
    return joint.name, body, _anchor_of_point(linkage, joint.point, body), guide.host, through, guide.along
