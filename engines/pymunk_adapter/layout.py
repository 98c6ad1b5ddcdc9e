"""A scene cut into parts and their joints: again a scene, whose grooves pymunk solves exactly.

pymunk's ``GrooveJoint`` solves both directions of its contact and then drops the part along the groove. That is right
only where the two do not couple: the mass centre of the groove's body has to lie on the groove's line, and that of the
pin's body at the pin (or the body must not turn). Elsewhere it settles on a wrong velocity, silently. So every body
that turns has its pins in grooves on *shoes*, point masses that are cut off it and pinned to it, and each of its
grooves on a *rail*, a part with its mass centre on the groove's line that is pinned and geared to it. The parts
together have the mass, mass centre and inertia of the body, so the motion is the same.

pymunk's solver visits joint after joint, and what it leaves undone shrinks the more slowly, the smaller a body's
inertia is about a mass centre far from its pins. Mass that rests at a pivot on the ground takes part in nothing. So a
body that turns about the ground is carried by a heavy part whose centre is that pivot, and a point mass near the pivot
has the moment of the body's mass about it; a spring that hangs the pivot up takes off what they weigh too much. Without
it the six-bars of the literature come apart near their toggles.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np

from analytic.description.linkage import GROUND, Vector
from engines.mechanics.joints import JointEquations
from engines.mechanics.states import Reals, body_numbers, driven, point_velocity, pose_of, start_motion
from engines.scene import Cylinder, PinJoint, PointSpring, Scene, SliderJoint, SlotJoint

# Mass that rests on a pivot, over the scene's, and the share of a body's inertia about its pivot in the point mass.
RESTING, POINT = 10.0, 0.25
CLOSE = 1e-12  # of a body's inertia: moments smaller than this are rounding

Fastened = TypeVar("Fastened", PinJoint, PointSpring, Cylinder)
Groove = TypeVar("Groove", SliderJoint, SlotJoint)


@dataclass(frozen=True)
class BodyPart:
    """One body of the engine: what carries a scene body, or a shoe or rail cut off it.

    ``offset`` is its centre from the owner's mass centre, in the owner's frame, m; ``inertia`` is None where the part
    cannot turn.
    """

    owner: str
    mass: float
    inertia: float | None
    offset: Vector = (0.0, 0.0)


@dataclass(frozen=True)
class PartLayout:
    """A scene cut into parts.

    ``scene`` has the parts as its bodies: first, under their own names, the ``carried`` that carry the bodies of the
    scene that was cut, then what was cut off them; and the joints in the order in which pymunk visits them, those that
    fasten what was cut off after the scene's own pins. ``gears`` are pairs of bodies that keep their angle.
    """

    scene: Scene
    parts: tuple[BodyPart, ...]
    gears: tuple[tuple[str, str], ...]
    carried: int

    @cached_property
    def equations(self) -> JointEquations:
        """The equations of all joints between the parts."""
        return JointEquations(self.scene, geared=self.gears)

    @property
    def freedom(self) -> int:
        """Degrees of freedom by count of the joints, drive left out, without the turning of parts without inertia."""
        coordinates = sum(2 if part.inertia is None else 3 for part in self.parts)
        return coordinates - 2 * len(self.scene.pins) - len(self.scene.guided) - len(self.gears)

    def tangent(self, scene: Scene) -> tuple[list[Vector], list[float]]:
        """Velocities of all parts, m, and spins, rad, per rad or m of φ, at the start of the uncut ``scene``.

        Of a start from rest they are along the accelerations.
        """
        position, rate, second = start_motion(scene)
        _, speed, gain = (float(value[0]) for value in driven(scene, position, rate, second))
        # Whatever starts from rest sets off along its acceleration.
        motion = (rate / speed if speed else second / (gain or 1.0))[0]
        owners = motion[[body_numbers(scene)[part.owner] for part in self.parts]]
        velocity = point_velocity(_arms(scene, self.parts), owners)
        return velocity.tolist(), owners[:, 2].tolist()


def split_point_mass(part: BodyPart, point: Vector) -> tuple[BodyPart, BodyPart]:
    """Cut a point mass off a part with an inertia; returns the rest, with half the inertia or more, and the mass.

    ``point`` is from the owner's mass centre, in its frame, m.
    """
    assert part.inertia is not None
    away = _minus(part.offset, point)
    moment = part.mass * (away[0] ** 2 + away[1] ** 2)
    ratio = max(1.0, 2.0 * moment / part.inertia)  # mass left over mass cut off
    cut = part.mass / (1.0 + ratio)
    centre = (part.offset[0] + away[0] / ratio, part.offset[1] + away[1] / ratio)
    rest = replace(part, mass=part.mass - cut, inertia=part.inertia - moment / ratio, offset=centre)
    return rest, BodyPart(part.owner, cut, None, point)


def split_on_pivot(part: BodyPart, pivot: Vector, resting: float) -> tuple[BodyPart, BodyPart | None]:
    """A body with an inertia as two parts with its moments about a pivot: one there, and a point mass.

    ``pivot`` is from the owner's mass centre, in its frame, m. The part there has the mass ``resting``, kg; the point
    is None for a body that is balanced about the pivot.
    """
    assert part.inertia is not None
    away = _minus(part.offset, pivot)
    distance = math.hypot(*away)
    whole = part.inertia + part.mass * distance**2
    if part.mass * distance**2 <= CLOSE * whole:
        return replace(part, mass=resting, inertia=whole, offset=pivot), None
    share = POINT * whole / (part.mass * distance**2)  # of the way to the mass centre
    point = BodyPart(part.owner, part.mass / share, None, (pivot[0] + share * away[0], pivot[1] + share * away[1]))
    return replace(part, mass=resting, inertia=(1.0 - POINT) * whole, offset=pivot), point


def split_rail(part: BodyPart, centre: Vector) -> tuple[BodyPart, BodyPart]:
    """Cut a part that can turn, a rail, off a part with an inertia; returns the rest and the rail.

    ``centre``, the rail's, is from the owner's mass centre, in its frame, m.
    """
    assert part.inertia is not None
    share = part.inertia / 4.0
    rest, point = split_point_mass(replace(part, inertia=part.inertia - share), centre)
    return rest, replace(point, inertia=share)


def plain_layout(scene: Scene) -> PartLayout:
    """The layout of one part per body and one constraint per joint, as a newcomer would write it."""
    return _layout_of_parts(scene, _uncut_parts(scene))


def exact_layout(scene: Scene) -> PartLayout:
    """The layout of the scene cut into parts so that every groove is exact.

    Bodies pinned to the ground rest on their pivots, which springs hang up if there is gravity.
    """
    parts, shoes, rails = _uncut_parts(scene), dict[str, str](), dict[str, str]()
    lifts, resting = list[PointSpring](), RESTING * sum(body.mass for body in scene.bodies)
    gravity, height = math.hypot(*scene.gravity), reach(scene)
    down = (height * scene.gravity[0] / (gravity or 1.0), height * scene.gravity[1] / (gravity or 1.0))
    for pin in scene.pins:
        if GROUND not in (pin.first, pin.second):
            continue
        (name, pivot), (_, foot) = pin.ends if pin.second == GROUND else pin.ends[::-1]
        if parts[name].inertia is None or any(lift.second == name for lift in lifts):
            continue
        before = parts[name].mass
        parts[name], point = split_on_pivot(parts[name], pivot, resting)
        if point is not None:
            parts[f"point of {name}"] = point
        surplus = resting + (point.mass if point else 0.0) - before
        lifts.append(PointSpring(GROUND, name, _minus(foot, down), pivot, surplus * gravity / height, 0.0, 0.0))
    for joint in scene.guided:
        if joint.body != GROUND and parts[joint.body].inertia is not None:
            shoes[joint.name] = name = f"shoe of {joint.name}"
            parts[joint.body], parts[name] = split_point_mass(parts[joint.body], joint.anchor)
    for joint in scene.guided:
        if joint.host != GROUND and parts[joint.host].inertia is not None:
            rails[joint.name] = name = f"rail of {joint.name}"
            centre = _foot(joint, parts[joint.host].offset)
            parts[joint.host], parts[name] = split_rail(parts[joint.host], centre)
    hung = replace(scene, springs=(*scene.springs, *lifts)) if gravity else scene
    return _layout_of_parts(hung, parts, shoes, rails)


def _uncut_parts(scene: Scene) -> dict[str, BodyPart]:
    """One part for every body, by its name; without inertia where the body cannot turn."""
    return {
        body.name: BodyPart(body.name, body.mass, body.inertia if scene.can_turn(body) else None)
        for body in scene.bodies
    }


def _layout_of_parts(
    scene: Scene, parts: dict[str, BodyPart], shoes: Mapping[str, str] = {}, rails: Mapping[str, str] = {}
) -> PartLayout:
    """The parts as a scene, in the positions their owners start in, with anchors from the parts' own centres.

    A part that is cut off is pinned to its owner; sliders and rails are geared to what they keep their angle with.
    ``shoes`` and ``rails`` name the parts that stand for a joint's body and host, by joint.
    """

    def place(name: str, anchor: Vector) -> Vector:
        """A point of a body or part, or of the ground, from the centre of the part of that name, m."""
        return anchor if name == GROUND else _minus(anchor, parts[name].offset)

    def fastened(joint: Fastened) -> Fastened:
        """A copy of a pin, spring or cylinder with its anchors from the parts' own centres."""
        first, second = (place(*end) for end in joint.ends)
        return replace(joint, first_anchor=first, second_anchor=second)

    def grooved(joint: Groove) -> Groove:
        """A copy of a slider or slot between the parts that stand for its bodies: their shoe and rail, if any."""
        body, host = shoes.get(joint.name, joint.body), rails.get(joint.name, joint.host)
        anchor, through = place(body, joint.anchor), place(host, joint.through)
        return replace(joint, body=body, anchor=anchor, host=host, through=through)

    cut_off = [*parts][len(scene.bodies) :]
    pins = [fastened(pin) for pin in scene.pins]
    pins += [
        PinJoint(name, name, parts[name].owner, (0.0, 0.0), place(parts[name].owner, parts[name].offset))
        for name in cut_off
    ]
    gears = [(joint.body, joint.host) for joint in scene.sliders if parts[joint.body].inertia is not None]
    gears += [(name, parts[name].owner) for name in rails.values()]
    owners = {body.name: body for body in scene.bodies}
    arms = _arms(scene, [*parts.values()])
    bodies = [
        replace(
            owners[part.owner],
            name=name,
            mass=part.mass,
            inertia=part.inertia,
            position=(owners[part.owner].position[0] + x, owners[part.owner].position[1] + y),
        )
        for (name, part), (x, y) in zip(parts.items(), arms.tolist(), strict=True)
    ]
    placed = replace(
        scene,
        bodies=tuple(bodies),
        pins=tuple(pins),
        sliders=tuple(map(grooved, scene.sliders)),
        slots=tuple(map(grooved, scene.slots)),
        forces=tuple(replace(force, anchor=place(force.body, force.anchor)) for force in scene.forces),
        springs=tuple(map(fastened, scene.springs)),
        cylinder=scene.cylinder and fastened(scene.cylinder),
    )
    return PartLayout(placed, tuple(parts.values()), tuple(gears), len(scene.bodies))


def _arms(scene: Scene, parts: list[BodyPart] | tuple[BodyPart, ...]) -> Reals:
    """The vectors from the owners' mass centres to the parts', in the ground frame at the start, (parts, 2), m."""
    owners = np.array([body_numbers(scene)[part.owner] for part in parts])
    arms = pose_of(start_motion(scene)[0]).turned(np.array([part.offset for part in parts]), owners)
    return np.asarray(arms[0])


def _foot(joint: SliderJoint | SlotJoint, centre: Vector) -> Vector:
    """The point of a joint's line nearest to a centre, in its host's frame, m."""
    (x, y), size = joint.along, math.hypot(*joint.along)
    away = _minus(centre, joint.through)
    share = (away[0] * x + away[1] * y) / size**2
    return joint.through[0] + share * x, joint.through[1] + share * y


def _minus(a: Vector, b: Vector) -> Vector:
    """The vector from ``b`` to ``a``."""
    return (a[0] - b[0], a[1] - b[1])


def reach(scene: Scene) -> float:
    """A length, m, beyond which no joint of the scene can travel: all anchors and start positions added up."""
    anchors = [anchor for joint in scene.joints for _, anchor in joint.ends]
    return sum(math.hypot(*v) for v in (*anchors, *(body.position for body in scene.bodies)))
