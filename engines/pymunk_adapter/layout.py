"""How a scene is cut into parts and their joints: again a scene, whose grooves pymunk solves exactly.

pymunk's ``GrooveJoint`` solves both directions of its contact and then drops the part along the groove. That is right
only where the two do not couple: the mass centre of the groove's body has to lie on the groove's line, and that of the
pin's body at the pin (or the body must not turn). Elsewhere it settles on a wrong velocity, silently. A body that
breaks this loses a point mass that is pinned to it, chosen so that the rest has its mass centre where the groove wants
it. A host of several grooves gets a rail for each line its centre cannot be put on: a part of its own, pinned and
geared to it. The parts together have the mass, mass centre and inertia of the body, so the motion is the same.

pymunk's solver visits joint after joint, and what it leaves undone shrinks the more slowly, the lighter a body is
beside its neighbours and the smaller its inertia is about a mass centre far from its pins. At a pivot on the ground
there is a cure: mass that rests there takes part in nothing. So a body that turns about the ground is carried by a
heavy part whose centre is that pivot and which has most of its inertia, and a point mass near the pivot has the moment
of the body's mass about it; a constant force on the pivot takes off what they weigh too much. A driven crank
gets a flywheel besides, whose share of the torque is taken off where it is read. Measured on random linkages: five to
thirty times fewer iterations.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeAlias, TypeVar

import numpy as np

from analytic.description.law import Law
from analytic.description.linkage import GROUND, DriverKind, Vector, rotate, unit
from engines.mechanics.joints import JointEquations
from engines.mechanics.states import body_numbers, point_acceleration, point_velocity, pose_of, start_motion
from engines.scene import (
    AppliedForce,
    Body,
    Cylinder,
    GuidedJoint,
    PinJoint,
    PointSpring,
    Prescribed,
    Scene,
    SliderJoint,
    SlotJoint,
)

# Distances below this share of the scene's size are zero.
CLOSE = 1e-12

# Mass that rests on a pivot, over the scene's; a flywheel, over its mass at the crank's joint; and the shares of a
# body's inertia about its pivot that go to the pins of slots, and to the point mass. Measured on random linkages: five
# times as much of the first three changes the iterations by a tenth, and more makes the torque noisier.
RESTING, FLYWHEEL, SHOES, POINT = 10.0, 3.0, 0.25, 0.25


@dataclass(frozen=True)
class BodyPart:
    """One body of the engine: what carries a scene body, or a point mass or rail cut off it.

    ``offset`` is its centre from the owner's mass centre, in the owner's frame, m; ``inertia`` is None where the part
    cannot turn.
    """

    owner: int
    mass: float
    inertia: float | None
    offset: Vector


@dataclass(frozen=True)
class Gear:
    """What keeps the angle of ``body`` against ``host`` as it is at the start: that of a slider, or of a rail."""

    name: str
    body: str
    host: str


Hold: TypeAlias = PinJoint | GuidedJoint | Gear
Fastened = TypeVar("Fastened", PinJoint, PointSpring, Cylinder)
Groove = TypeVar("Groove", SliderJoint, SlotJoint)


@dataclass(frozen=True)
class PartLayout:
    """A scene cut into parts.

    ``scene`` has the parts as its bodies: first, under their own names, those that carry the bodies of the scene that
    was cut, then what was cut off them. ``inner`` names the latter and the joints that fasten them; all other joints
    keep their names. ``holds`` are pymunk's constraints in its order: a slider's is its groove alone.
    ``reach`` is a length, m, that no joint can travel beyond.
    """

    scene: Scene
    parts: tuple[BodyPart, ...]
    holds: tuple[Hold, ...]
    inner: frozenset[str]
    reach: float
    flywheel: float = 0.0

    @cached_property
    def equations(self) -> JointEquations:
        """The equations of all joints between parts."""
        gears = [(hold.body, hold.host) for hold in self.holds if isinstance(hold, Gear)]
        return JointEquations(self.scene, geared=gears)

    @property
    def freedom(self) -> int:
        """Degrees of freedom that the joints leave by count; the free turning of parts without inertia is none."""
        coordinates = sum(2 if part.inertia is None else 3 for part in self.parts)
        return coordinates - sum(2 if isinstance(hold, PinJoint) else 1 for hold in self.holds)

    @property
    def carried(self) -> int:
        """Number of the bodies of the scene that was cut."""
        return len(self.parts) - len(self.inner)


def plain_layout(scene: Scene) -> PartLayout:
    """One part per body and one hold per joint, as a newcomer would write it, grooves off their lines included."""
    return _Cutter(scene, cut=False).layout()


def exact_layout(scene: Scene) -> PartLayout:
    """The scene cut so that every groove is exact."""
    return _Cutter(scene, cut=True).layout()


def _ends(joint: PinJoint | GuidedJoint) -> tuple[tuple[str, Vector], tuple[str, Vector]]:
    """The two bodies of a joint, each with the place of the joint in its frame."""
    if isinstance(joint, PinJoint):
        return (joint.first, joint.first_anchor), (joint.second, joint.second_anchor)
    return (joint.body, joint.anchor), (joint.host, joint.through)


def _minus(a: Vector, b: Vector) -> Vector:
    return (a[0] - b[0], a[1] - b[1])


def without_point(part: BodyPart, point: Vector) -> tuple[BodyPart, BodyPart]:
    """Cut a point mass off at ``point``; the rest keeps at least half the inertia. Returns the rest and the point."""
    assert part.inertia is not None
    away = _minus(part.offset, point)
    moment = part.mass * (away[0] ** 2 + away[1] ** 2)
    ratio = max(1.0, 2.0 * moment / part.inertia)  # mass left over mass cut off
    cut = part.mass / (1.0 + ratio)
    centre = (part.offset[0] + away[0] / ratio, part.offset[1] + away[1] / ratio)
    rest = replace(part, mass=part.mass - cut, inertia=part.inertia - moment / ratio, offset=centre)
    return rest, BodyPart(part.owner, cut, None, point)


def without_rail(part: BodyPart, centre: Vector) -> tuple[BodyPart, BodyPart]:
    """Cut off a part that can turn, its centre at ``centre``. Returns the rest and the rail."""
    assert part.inertia is not None
    share = part.inertia / 4.0
    rest, point = without_point(replace(part, inertia=part.inertia - share), centre)
    return rest, replace(point, inertia=share)


def with_centre(part: BodyPart, centre: Vector) -> tuple[BodyPart, BodyPart]:
    """Cut a point mass off so that the centre of what is left lies at ``centre``. Returns the rest and the point."""
    assert part.inertia is not None
    shift = _minus(centre, part.offset)
    moment = part.mass * (shift[0] ** 2 + shift[1] ** 2)
    ratio = min(1.0, part.inertia / (2.0 * moment))  # mass left over mass cut off
    cut = part.mass / (1.0 + ratio)
    point = (part.offset[0] - ratio * shift[0], part.offset[1] - ratio * shift[1])
    rest = replace(part, mass=part.mass - cut, inertia=part.inertia - ratio * moment, offset=centre)
    return rest, BodyPart(part.owner, cut, None, point)


class _Cutter:
    """The work of cutting one scene; holds what has been cut so far."""

    def __init__(self, scene: Scene, *, cut: bool) -> None:
        self.scene = scene
        self.cut = cut
        self.number = body_numbers(scene)
        self.reach = reach(scene)
        self.carriers: dict[str, BodyPart] = {}
        self.cut_off: dict[str, BodyPart] = {}
        self.shoes: dict[str, str] = {}  # slot name -> the point mass that is its pin
        self.rails: dict[str, str] = {}  # slot or slider name -> the rail that has its line
        self.lifts: list[AppliedForce] = []  # what takes off too much weight
        driven = cut and isinstance(scene.drive, Prescribed) and scene.driver_kind is DriverKind.CRANK
        self.flywheel = FLYWHEEL * sum(body.mass for body in scene.bodies) * self._throw() ** 2 if driven else 0.0

    def layout(self) -> PartLayout:
        parts = {body.name: self.carrier(body.name) for body in self.scene.bodies} | self.cut_off
        pins = [self._fastened(pin) for pin in self.scene.pins]
        sliders = [self._slider(slider) for slider in self.scene.sliders]
        slots = [self._slot(slot) for slot in self.scene.slots]
        holds: list[Hold] = [*pins]
        for slider, uncut in zip(sliders, self.scene.sliders, strict=True):
            holds.append(slider)
            if parts[slider.body].inertia is not None:
                holds.append(Gear(slider.name, slider.body, uncut.host))  # not its rail: the solver would be slower
        holds += slots
        for name, part in self.cut_off.items():
            owner = self.scene.bodies[part.owner].name
            pins.append(PinJoint(name, name, owner, (0.0, 0.0), _minus(part.offset, parts[owner].offset)))
            holds.append(pins[-1])
            if part.inertia is not None:
                holds.append(Gear(name, name, owner))
        scene = replace(
            self.scene,
            bodies=self._bodies(parts),
            pins=tuple(pins),
            sliders=tuple(sliders),
            slots=tuple(slots),
            forces=tuple(replace(f, anchor=self._anchor(f.body, f.anchor)) for f in (*self.scene.forces, *self.lifts)),
            springs=tuple(map(self._fastened, self.scene.springs)),
            cylinder=self.scene.cylinder and self._fastened(self.scene.cylinder),
        )
        inner = frozenset(self.cut_off)
        return PartLayout(scene, tuple(parts.values()), tuple(holds), inner, self.reach, self.flywheel)

    def _bodies(self, parts: Mapping[str, BodyPart]) -> tuple[Body, ...]:
        """The parts as bodies, in the state their owners start in."""
        owners = np.array([part.owner for part in parts.values()])
        position, velocity, acceleration = (state[:, owners] for state in start_motion(self.scene))
        arms = pose_of(position).turned(np.array([part.offset for part in parts.values()]), np.arange(len(owners)))[0]
        rates, seconds = point_velocity(arms, velocity[0]), point_acceleration(arms, velocity[0], acceleration[0])
        rows = np.concatenate([position[0, :, :2] + arms, rates, seconds], axis=1).tolist()
        return tuple(
            replace(
                self.scene.bodies[part.owner],
                name=name,
                mass=part.mass,
                inertia=part.inertia,
                position=(x, y),
                velocity=(vx, vy),
                acceleration=(ax, ay),
            )
            for (name, part), (x, y, vx, vy, ax, ay) in zip(parts.items(), rows, strict=True)
        )

    def carrier(self, name: str) -> BodyPart:
        """The part that carries a body; sliders come before their hosts, whose lines depend on them."""
        if name not in self.carriers:
            body = self.scene.bodies[self.number[name]]
            turning = self.scene.can_turn(body)
            part = BodyPart(self.number[name], body.mass, body.inertia if turning else None, (0.0, 0.0))
            if self.cut and turning:
                if name == self.scene.crank:
                    part = replace(part, inertia=(part.inertia or 0.0) + self.flywheel)
                pivot = self._pivot(name)
                part = self._cut(name, part) if pivot is None else self._pivoted(name, part, pivot)
            self.carriers[name] = part
        return self.carriers[name]

    def _throw(self) -> float:
        """Largest distance between joints of the crank, m."""
        anchors = [
            anchor
            for joint in (*self.scene.pins, *self.scene.guided)
            for body, anchor in _ends(joint)
            if body == self.scene.crank
        ]
        return max(math.dist(one, other) for one in anchors for other in anchors)

    def _pivot(self, name: str) -> Vector | None:
        """Where a body turns about the ground, in its frame, if grooves allow for a part that is carried there."""
        pivots = [dict(_ends(pin))[name] for pin in self.scene.pins if {pin.first, pin.second} == {name, GROUND}]
        if not pivots:
            return None
        nearest = self._nearest(list(self._lines(name).values()), pivots[0])
        return pivots[0] if nearest is not None and math.dist(nearest, pivots[0]) <= CLOSE * self.reach else None

    def _pivoted(self, name: str, part: BodyPart, pivot: Vector) -> BodyPart:
        """The heavy part at a pivot; what else the body consists of is cut off."""
        assert part.inertia is not None
        arm = _minus(part.offset, pivot)
        inertia = whole = part.inertia + part.mass * (arm[0] ** 2 + arm[1] ** 2)
        moment = np.multiply(part.mass, arm)
        slots = [s for s in self.scene.slots if s.body == name and math.dist(s.anchor, pivot) > CLOSE * self.reach]
        points = []
        for slot in slots:
            away = np.subtract(slot.anchor, pivot)
            points.append(SHOES / len(slots) * whole / float(away @ away))
            moment -= points[-1] * away
            self.shoes[slot.name] = self._keep(BodyPart(part.owner, points[-1], None, slot.anchor))
            inertia -= SHOES / len(slots) * whole
        size = float(np.hypot(*moment))
        if size * self.reach > CLOSE * whole:
            near = POINT * whole / size
            points.append(size / near)
            x, y = (near / size * moment).tolist()
            self._keep(BodyPart(part.owner, points[-1], None, (pivot[0] + x, pivot[1] + y)))
            inertia -= POINT * whole
        mass = RESTING * (sum(points) + sum(body.mass for body in self.scene.bodies))
        if any(self.scene.gravity):
            lift = np.multiply(part.mass - mass - sum(points), self.scene.gravity)
            self.lifts.append(AppliedForce(name, pivot, Law(lift)))
        return BodyPart(part.owner, mass, inertia, pivot)

    def _cut(self, name: str, part: BodyPart) -> BodyPart:
        for slot in self.scene.slots:
            if slot.body == name and math.dist(slot.anchor, part.offset) > CLOSE * self.reach:
                part, shoe = without_point(part, slot.anchor)
                self.shoes[slot.name] = self._keep(shoe)
        lines = self._lines(name)
        while (centre := self._nearest(list(lines.values()), part.offset)) is None:
            joint, line = lines.popitem()
            own = self._nearest([line], part.offset)
            assert own is not None
            part, rail = without_rail(part, own)
            self.rails[joint] = self._keep(rail)
        if math.dist(centre, part.offset) > CLOSE * self.reach:
            part, point = with_centre(part, centre)
            self._keep(point)
        return part

    def _keep(self, part: BodyPart) -> str:
        name = f"part {len(self.cut_off) + 1} of {self.scene.bodies[part.owner].name}"
        self.cut_off[name] = part
        return name

    def _lines(self, host: str) -> dict[str, tuple[Vector, Vector]]:
        """A point and the direction of every groove's line on a host, by joint."""
        lines = {j.name: (j.through, j.along) for j in self.scene.slots if j.host == host}
        return lines | {j.name: (self._groove_point(j), j.along) for j in self.scene.sliders if j.host == host}

    def _nearest(self, lines: Sequence[tuple[Vector, Vector]], centre: Vector) -> Vector | None:
        """The point nearest to ``centre`` that lies on all lines; None where they have none in common."""
        if not lines:
            return centre
        normals = np.array([rotate(unit(along), (0.0, 1.0)) for _, along in lines])
        distances = np.einsum("ik,ik->i", normals, np.subtract([through for through, _ in lines], centre))
        shift = np.linalg.lstsq(normals, distances, rcond=1e-9)[0]
        if len(lines) > 1 and (
            np.max(np.abs(normals @ shift - distances)) > 1e-9 * self.reach or np.linalg.norm(shift) > self.reach
        ):
            return None
        return (centre[0] + float(shift[0]), centre[1] + float(shift[1]))

    def _groove_point(self, slider: SliderJoint) -> Vector:
        """A point of the line, in the host's frame, on which the slider's own centre moves."""
        offset = _minus(slider.anchor, self.carrier(slider.body).offset)
        turn = start_turn(self.scene, slider)
        return _minus(slider.through, rotate(offset, (math.cos(turn), math.sin(turn))))

    def _anchor(self, name: str, anchor: Vector) -> Vector:
        return anchor if name == GROUND else _minus(anchor, self.carrier(name).offset)

    def _fastened(self, joint: Fastened) -> Fastened:
        """A pin, spring or cylinder, its anchors from the centres of the parts."""
        first, second = self._anchor(joint.first, joint.first_anchor), self._anchor(joint.second, joint.second_anchor)
        return replace(joint, first_anchor=first, second_anchor=second)

    def _slider(self, slider: SliderJoint) -> SliderJoint:
        anchor, through = self._anchor(slider.body, slider.anchor), slider.through
        if self.cut and slider.host != GROUND:
            anchor, through = (0.0, 0.0), self._groove_point(slider)
        return self._grooved(slider, slider.body, anchor, through)

    def _slot(self, slot: SlotJoint) -> SlotJoint:
        if slot.name in self.shoes:
            return self._grooved(slot, self.shoes[slot.name], (0.0, 0.0), slot.through)
        return self._grooved(slot, slot.body, self._anchor(slot.body, slot.anchor), slot.through)

    def _grooved(self, joint: Groove, body: str, anchor: Vector, through: Vector) -> Groove:
        """A groove in the joint's host or in its rail; ``through`` from the host's mass centre."""
        host, start = joint.host, self._anchor(joint.host, through)
        if joint.name in self.rails:
            host = self.rails[joint.name]
            start = _minus(through, self.cut_off[host].offset)
        return replace(joint, body=body, anchor=anchor, host=host, through=start, along=unit(joint.along))


def start_turn(scene: Scene, joint: SliderJoint | Gear) -> float:
    """Angle of a body over its host's at the start, rad; it never changes."""
    angles = {body.name: body.angle for body in scene.bodies}
    return angles[joint.body] - angles.get(joint.host, 0.0)


def reach(scene: Scene) -> float:
    """A length no joint of the scene can travel beyond, m: all anchors and start positions laid end to end."""
    anchors = [a for p in scene.pins for a in (p.first_anchor, p.second_anchor)]
    anchors += [a for j in scene.guided for a in (j.anchor, j.through)]
    return sum(math.hypot(*v) for v in (*anchors, *(body.position for body in scene.bodies)))
