"""How a scene is cut into pymunk bodies and constraints; plain data, to be checked and solved without pymunk.

pymunk's ``GrooveJoint`` solves both directions of its contact and then drops the part along the groove. That is right
only where the two do not couple: the mass centre of the groove's body has to lie on the groove's line, and that of the
pin's body at the pin (or the body must not turn). Elsewhere it settles on a wrong velocity, silently. A body that
breaks this is cut in two: a point mass that is pinned to it, chosen so that what is left has its mass centre where the
groove wants it. A host of several grooves gets a rail for each line its centre cannot be put on: a part of its own,
pinned and geared to it. Mass, mass centre and inertia of the parts together are those of the body, so that the motion
is the same.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Final

import numpy as np

from analytic.description.linkage import GROUND, Vector
from engines.scene import Body, Scene, SliderJoint, SlotJoint

STILL: Final = -1  # the number that stands for the ground among the parts

# Distances below this share of the scene's size are zero.
CLOSE = 1e-12


class Kind(StrEnum):
    """What a hold keeps."""

    PIN = "pin"
    GROOVE = "groove"
    GEAR = "gear"


@dataclass(frozen=True)
class Part:
    """One body of the engine: what carries a scene body, or a point mass or rail cut off it.

    ``offset`` is its centre from the owner's mass centre, in the owner's frame, m; ``inertia`` is None where the part
    cannot turn.
    """

    owner: int
    mass: float
    inertia: float | None
    offset: Vector


@dataclass(frozen=True)
class Hold:
    """One constraint between two parts, anchors from the parts' centres in the owner's frame.

    A groove keeps ``first_anchor`` on the line of ``second`` through ``second_anchor`` along ``along``; a gear keeps
    the angle of ``first`` at ``turn`` over that of ``second``. ``joint`` is the scene's joint whose force it carries.
    """

    kind: Kind
    joint: str | None
    first: int
    second: int
    first_anchor: Vector = (0.0, 0.0)
    second_anchor: Vector = (0.0, 0.0)
    along: Vector = (1.0, 0.0)
    turn: float = 0.0


@dataclass(frozen=True)
class Layout:
    """All parts and holds; the part with the number of a scene body carries it, point masses follow."""

    parts: tuple[Part, ...]
    holds: tuple[Hold, ...]
    crank: int
    reach: float


def plain_layout(scene: Scene) -> Layout:
    """One part per body and one hold per joint, as a newcomer would write it, grooves off their lines included."""
    return _Cutter(scene, cut=False).layout()


def exact_layout(scene: Scene) -> Layout:
    """The scene cut so that every groove is exact."""
    return _Cutter(scene, cut=True).layout()


def geared(layout: Layout) -> list[list[int]]:
    """The parts by number, those together that gears keep at fixed angles to each other."""
    group = list(range(len(layout.parts)))
    for hold in layout.holds:
        if hold.kind is Kind.GEAR and STILL not in (hold.first, hold.second):
            old, new = group[hold.second], group[hold.first]
            group = [new if own == old else own for own in group]
    return [[number for number, own in enumerate(group) if own == chosen] for chosen in sorted(set(group))]


def turns(scene: Scene, body: Body) -> bool:
    """Whether a body can turn: it has an inertia and does not slide on something that cannot."""
    hosts = {slider.body: slider.host for slider in scene.sliders}
    name = body.name
    while name in hosts:
        name = hosts[name]
    return body.inertia is not None and name != GROUND


def _minus(a: Vector, b: Vector) -> Vector:
    return (a[0] - b[0], a[1] - b[1])


def _turned(vector: Vector, angle: float) -> Vector:
    c, s = math.cos(angle), math.sin(angle)
    return (c * vector[0] - s * vector[1], s * vector[0] + c * vector[1])


def _unit(vector: Vector) -> Vector:
    length = math.hypot(*vector)
    return (vector[0] / length, vector[1] / length)


def without_point(part: Part, point: Vector) -> tuple[Part, Part]:
    """Cut a point mass off at ``point``; the rest keeps at least half the inertia. Returns the rest and the point."""
    assert part.inertia is not None
    away = _minus(part.offset, point)
    moment = part.mass * (away[0] ** 2 + away[1] ** 2)
    ratio = max(1.0, 2.0 * moment / part.inertia)  # mass left over mass cut off
    cut = part.mass / (1.0 + ratio)
    centre = (part.offset[0] + away[0] / ratio, part.offset[1] + away[1] / ratio)
    rest = replace(part, mass=part.mass - cut, inertia=part.inertia - moment / ratio, offset=centre)
    return rest, Part(part.owner, cut, None, point)


def without_rail(part: Part, centre: Vector) -> tuple[Part, Part]:
    """Cut off a part that can turn, its centre at ``centre``. Returns the rest and the rail."""
    assert part.inertia is not None
    share = part.inertia / 4.0
    rest, point = without_point(replace(part, inertia=part.inertia - share), centre)
    return rest, replace(point, inertia=share)


def with_centre(part: Part, centre: Vector) -> tuple[Part, Part]:
    """Cut a point mass off so that the centre of what is left lies at ``centre``. Returns the rest and the point."""
    assert part.inertia is not None
    shift = _minus(centre, part.offset)
    moment = part.mass * (shift[0] ** 2 + shift[1] ** 2)
    ratio = min(1.0, part.inertia / (2.0 * moment))  # mass left over mass cut off
    cut = part.mass / (1.0 + ratio)
    point = (part.offset[0] - ratio * shift[0], part.offset[1] - ratio * shift[1])
    rest = replace(part, mass=part.mass - cut, inertia=part.inertia - ratio * moment, offset=centre)
    return rest, Part(part.owner, cut, None, point)


class _Cutter:
    """The work of cutting one scene; holds what has been cut so far."""

    def __init__(self, scene: Scene, *, cut: bool) -> None:
        self.scene = scene
        self.cut = cut
        self.number = {body.name: number for number, body in enumerate(scene.bodies)}
        self.number[GROUND] = STILL
        self.reach = reach(scene)
        self.carriers: dict[str, Part] = {}
        self.cut_off: list[Part] = []
        self.shoes: dict[str, int] = {}  # slot name -> number of the point mass that is its pin
        self.rails: dict[str, int] = {}  # slot or slider name -> number of the rail that has its line

    def layout(self) -> Layout:
        for body in self.scene.bodies:
            self.carrier(body.name)
        carriers = [self.carriers[body.name] for body in self.scene.bodies]
        holds = [self._pin(*pin) for pin in self._pins()]
        holds += [hold for slider in self.scene.sliders for hold in self._slider(slider)]
        holds += [self._slot(slot) for slot in self.scene.slots]
        for number, part in enumerate(self.cut_off, len(carriers)):
            anchor = _minus(part.offset, carriers[part.owner].offset)
            holds.append(Hold(Kind.PIN, None, number, part.owner, (0.0, 0.0), anchor))
            if part.inertia is not None:
                holds.append(Hold(Kind.GEAR, None, number, part.owner))
        return Layout((*carriers, *self.cut_off), tuple(holds), self.number[self.scene.crank], self.reach)

    def carrier(self, name: str) -> Part:
        """The part that carries a body; sliders come before their hosts, whose lines depend on them."""
        if name not in self.carriers:
            body = self.scene.bodies[self.number[name]]
            turning = turns(self.scene, body)
            part = Part(self.number[name], body.mass, body.inertia if turning else None, (0.0, 0.0))
            self.carriers[name] = self._cut(name, part) if self.cut and turning else part
        return self.carriers[name]

    def _cut(self, name: str, part: Part) -> Part:
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

    def _keep(self, part: Part) -> int:
        self.cut_off.append(part)
        return len(self.scene.bodies) + len(self.cut_off) - 1

    def _lines(self, host: str) -> dict[str, tuple[Vector, Vector]]:
        """A point and the direction of every groove's line on a host, by joint."""
        lines = {j.name: (j.through, j.along) for j in self.scene.slots if j.host == host}
        return lines | {j.name: (self._groove_point(j), j.along) for j in self.scene.sliders if j.host == host}

    def _nearest(self, lines: Sequence[tuple[Vector, Vector]], centre: Vector) -> Vector | None:
        """The point nearest to ``centre`` that lies on all lines; None where they have none in common."""
        if not lines:
            return centre
        normals = np.array([_turned(_unit(along), math.pi / 2.0) for _, along in lines])
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
        return _minus(slider.through, _turned(offset, self._turn(slider)))

    def _turn(self, slider: SliderJoint) -> float:
        """Angle of a slider over its host's, rad; it never changes."""
        angles = {body.name: body.angle for body in self.scene.bodies}
        return angles[slider.body] - angles.get(slider.host, 0.0)

    def _anchor(self, name: str, anchor: Vector) -> Vector:
        return anchor if name == GROUND else _minus(anchor, self.carrier(name).offset)

    def _pins(self) -> Sequence[tuple[str, str, str, Vector, Vector]]:
        return [(p.name, p.first, p.second, p.first_anchor, p.second_anchor) for p in self.scene.pins]

    def _pin(self, joint: str, first: str, second: str, first_anchor: Vector, second_anchor: Vector) -> Hold:
        anchors = self._anchor(first, first_anchor), self._anchor(second, second_anchor)
        return Hold(Kind.PIN, joint, self.number[first], self.number[second], *anchors)

    def _slider(self, slider: SliderJoint) -> list[Hold]:
        first, second = self.number[slider.body], self.number[slider.host]
        if not self.cut or slider.host == GROUND:
            anchor, through = self._anchor(slider.body, slider.anchor), slider.through
        else:
            anchor, through = (0.0, 0.0), self._groove_point(slider)
        groove = self._groove(slider, first, anchor, through)
        if not turns(self.scene, self.scene.bodies[first]):
            return [groove]
        return [groove, Hold(Kind.GEAR, None, first, second, turn=self._turn(slider))]

    def _slot(self, slot: SlotJoint) -> Hold:
        first, anchor = self.number[slot.body], self._anchor(slot.body, slot.anchor)
        if slot.name in self.shoes:
            first, anchor = self.shoes[slot.name], (0.0, 0.0)
        return self._groove(slot, first, anchor, slot.through)

    def _groove(self, joint: SliderJoint | SlotJoint, first: int, anchor: Vector, through: Vector) -> Hold:
        """A groove in the joint's host, or in the host's rail; ``through`` from the host's mass centre."""
        second, start = self.number[joint.host], self._anchor(joint.host, through)
        if joint.name in self.rails:
            second = self.rails[joint.name]
            start = _minus(through, self.cut_off[second - len(self.scene.bodies)].offset)
        return Hold(Kind.GROOVE, joint.name, first, second, anchor, start, _unit(joint.along))


def reach(scene: Scene) -> float:
    """A length no joint of the scene can travel beyond, m: all anchors and start positions laid end to end."""
    anchors = [a for p in scene.pins for a in (p.first_anchor, p.second_anchor)]
    anchors += [a for j in scene.guided for a in (j.anchor, j.through)]
    return sum(math.hypot(*v) for v in (*anchors, *(body.position for body in scene.bodies)))
