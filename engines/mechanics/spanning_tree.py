"""The joints of a scene as a tree from the ground and the cuts of its loops, for engines in joint coordinates.

Such an engine moves a body by the one joint that joins it to its parent, and holds every further joint, which closes a
loop, as a constraint. Pins and sliders may be in the tree; slots never are. Sliders go before pins, as a pin is the
easier one to hold as a constraint: a slider is cut only where sliders alone form a loop.
"""

from __future__ import annotations

import cmath
from dataclasses import dataclass, replace

from analytic.description.linkage import GROUND, Vector
from engines.mechanics.joints import scene_size
from engines.scene import Body, PinJoint, Scene, SliderJoint, SlotJoint

AT_REST = Body(GROUND, 0.0, None, (0.0, 0.0), 0.0, (0.0, 0.0), 0.0, (0.0, 0.0), 0.0)  # the ground


@dataclass(frozen=True)
class Branch:
    """A body, its parent and the joint between them; None for one that hangs on no pin or slider.

    ``reverse``: the parent is the joint's first body (the pin's ``first``, the slider's ``body``). ``rigid``: the body
    is a mass on its pin, without an inertia; as such an engine cannot leave it free to turn, it turns with its parent.

    In the start state ``value`` is the joint's coordinate and ``speed`` its rate: the body's angle against its parent,
    rad, or how far the body's point is from the parent's along the slider's line, m. ``tilts``, rad, turn the axes of
    parent and body onto that line, or the parent's onto those of a rigid body.
    """

    body: Body
    parent: str
    joint: PinJoint | SliderJoint | None
    reverse: bool = False
    rigid: bool = False
    value: float = 0.0
    speed: float = 0.0
    tilts: tuple[float, float] = (0.0, 0.0)

    @property
    def name(self) -> str:
        """The joint's name; "" for a body that no joint holds."""
        return self.joint.name if self.joint else ""

    @property
    def points(self) -> tuple[Vector, Vector]:
        """The joint's points on the parent and on the body, body frames, m; not for a branch without a joint."""
        assert self.joint is not None
        points = dict(self.joint.ends)
        return points[self.parent], points[self.body.name]


@dataclass(frozen=True)
class SpanningTree:
    """``branches``, every parent before its children, and the joints ``cuts`` that close the loops."""

    branches: tuple[Branch, ...]
    cuts: tuple[PinJoint | SliderJoint | SlotJoint, ...]

    @property
    def obstacle(self) -> str | None:
        """The reason, in a sentence, why an engine of pins and sliders cannot use this tree; None if it can."""
        loose = next((branch.body.name for branch in self.branches if branch.joint is None), None)
        if loose is not None:
            return f"it carries every body by a pin or a slider, and only slots hold '{loose}'"
        loop = next((cut.name for cut in self.cuts if isinstance(cut, SliderJoint)), None)
        return None if loop is None else f"it has no constraint for '{loop}', which closes a loop of sliders alone"

    def carrier(self, cut: PinJoint | SliderJoint | SlotJoint) -> str:
        """Name of the body, or the ground, nearest to both ends of a cut joint on their ways to the ground."""
        first, second = (self._chain(body) for body, _ in cut.ends)
        return next(name for name in first if name in second)

    def hinges(self, name: str) -> set[str]:
        """Names of a body and of those that carry it, but for the ground and those on their parents by a slider."""
        chain = self._chain(name)
        turning = {branch.body.name for branch in self.branches if not isinstance(branch.joint, SliderJoint)}
        return turning & set(chain)

    def _chain(self, name: str) -> list[str]:
        """Names of a body and of those that carry it, from it down to the ground, which is included."""
        parents = {branch.body.name: branch.parent for branch in self.branches}
        chain = [name]
        while chain[-1] != GROUND:
            chain.append(parents[chain[-1]])
        return chain


def spanning_tree(scene: Scene) -> SpanningTree:
    """The tree that begins with the crank on the ground; then sliders, and then the pins nearest to the ground.

    A driven body that slides on another (a cylinder's rod) is on that, and not on its pin. A body that no pin or slider
    reaches hangs on the ground without a joint.
    """
    bodies = {body.name: body for body in scene.bodies}
    carried = {GROUND: AT_REST}  # as they start, a rigid body with its parent's speed
    depth = {GROUND: 0}
    branches: list[Branch] = []
    left: list[PinJoint | SliderJoint] = [*scene.sliders, *scene.pins]

    def rank(joint: PinJoint | SliderJoint) -> tuple[bool, bool, bool, int]:
        """The sort key by which open joints become branches, smaller first.

        It has whether a pin would put the crank on another body than the ground, whether the joint is any but the
        crank's on the ground, whether it is a pin, and how far from the ground it is, in joints.
        """
        ends = dict(joint.ends)
        pinned = isinstance(joint, PinJoint)
        misplaced = pinned and scene.crank in ends and scene.crank not in depth and GROUND not in ends
        nearest = min(depth[end] for end in ends if end in depth)
        return misplaced, set(ends) != {scene.crank, GROUND}, pinned, nearest

    while len(branches) < len(bodies):
        open_joints = [joint for joint in left if len(depth.keys() & dict(joint.ends)) == 1]
        if open_joints:
            joint = min(open_joints, key=rank)
            left.remove(joint)
            first, second = dict(joint.ends)
            body, parent = (second, first) if first in depth else (first, second)
            branch = _branch(bodies[body], carried[parent], joint, reverse=parent == first)
        else:
            body, parent = next(name for name in bodies if name not in depth), GROUND
            branch = Branch(bodies[body], parent, None)
        branches.append(branch)
        turns = carried[parent] if branch.rigid else bodies[body]
        carried[body] = replace(bodies[body], angular_velocity=turns.angular_velocity)
        depth[body] = depth[parent] + 1
    return SpanningTree(tuple(branches), (*left, *scene.slots))


def slots_as_blocks(scene: Scene, mass: float) -> Scene:
    """A copy of the scene with a block in every slot, for engines without a constraint of point and line.

    A block of ``mass``, kg, slides in the slot's host and is pinned to its body; the pin has the slot's name, block and
    slider have it behind "block of". The block's acceleration at the start, which no engine asks for, is not set.
    """
    bodies = {GROUND: AT_REST, **{body.name: body for body in scene.bodies}}
    pins, sliders = [*scene.pins], [*scene.sliders]
    for slot in scene.slots:
        body, host, name = bodies[slot.body], bodies[slot.host], f"block of {slot.name}"
        place, velocity = point_motion(body, slot.anchor)
        bodies[name] = replace(
            host,
            name=name,
            mass=mass,
            inertia=mass * scene_size(scene) ** 2,
            position=(place.real, place.imag),
            velocity=(velocity.real, velocity.imag),
        )
        pins.append(PinJoint(slot.name, slot.body, name, slot.anchor, (0.0, 0.0)))
        sliders.append(SliderJoint(name, name, (0.0, 0.0), slot.host, slot.through, slot.along))
    del bodies[GROUND]
    return replace(scene, bodies=tuple(bodies.values()), pins=tuple(pins), sliders=tuple(sliders), slots=())


def _branch(body: Body, parent: Body, joint: PinJoint | SliderJoint, reverse: bool) -> Branch:
    """The branch that hangs ``body`` on ``parent`` by a joint, with the joint's coordinate and rate at the start.

    ``reverse``: the parent is the joint's first body.
    """
    turn, rate = body.angle - parent.angle, body.angular_velocity - parent.angular_velocity
    if isinstance(joint, PinJoint):
        rigid = body.inertia is None
        return Branch(body, parent.name, joint, reverse, rigid, turn, rate, (turn, 0.0) if rigid else (0.0, 0.0))
    along = complex(*joint.along) * cmath.rect(1.0, (body if reverse else parent).angle)
    points = dict(joint.ends)
    motions = zip(point_motion(body, points[body.name]), point_motion(parent, points[parent.name]), strict=True)
    value, speed = (((own - other) * along.conjugate()).real / abs(along) for own, other in motions)
    tilts = cmath.phase(along) - parent.angle, cmath.phase(along) - body.angle
    return Branch(body, parent.name, joint, reverse, False, value, speed, tilts)


def point_motion(body: Body, anchor: Vector) -> tuple[complex, complex]:
    """Position, m, and velocity, m/s, in the ground frame, of a point of a body's frame at the start, complex."""
    arm = complex(*anchor) * cmath.rect(1.0, body.angle)
    return complex(*body.position) + arm, complex(*body.velocity) + 1j * body.angular_velocity * arm


# A cylinder as a barrel and a rod, for engines that prescribe a joint's coordinate and no distance of two points.


BARREL, ROD = "/barrel", "/rod"  # names that no body and no joint of a scene has


def cylinder_as_links(scene: Scene, mass: float) -> Scene:
    """A copy of the scene with a cylinder's barrel on its second end and its rod, the new ``crank``, on its first.

    Each has the given mass, kg, at its pin, and turns; the slider ROD between them has the cylinder's length as its
    travel. The ends are exchanged if the first is on the ground. A scene without a cylinder comes back as it is.
    """
    if scene.cylinder is None:
        return scene
    ends = scene.cylinder.ends
    if ends[0][0] == GROUND:  # length and force are the same from either end, and the rod is carried by the barrel
        ends = ends[::-1]
    bodies, still = {GROUND: AT_REST, **{body.name: body for body in scene.bodies}}, (0.0, 0.0)
    (here, speed), (there, other_speed) = (point_motion(bodies[body], anchor) for body, anchor in ends)
    (first, on_first), (second, on_second) = ends
    span = here - there
    angle, turning = cmath.phase(span), ((speed - other_speed) / span).imag
    inertia = mass * scene_size(scene) ** 2
    rod, barrel = (
        Body(name, mass, inertia, (at.real, at.imag), angle, (rate.real, rate.imag), turning, still, 0.0)
        for name, at, rate in ((ROD, here, speed), (BARREL, there, other_speed))
    )
    return replace(
        scene,
        crank=ROD,
        cylinder=None,
        bodies=(*scene.bodies, barrel, rod),
        pins=(
            *scene.pins,
            PinJoint(BARREL, BARREL, second, (0.0, 0.0), on_second),
            PinJoint(f"{ROD}'s pin", ROD, first, (0.0, 0.0), on_first),
        ),
        sliders=(*scene.sliders, SliderJoint(ROD, ROD, (0.0, 0.0), BARREL, (0.0, 0.0), (1.0, 0.0))),
    )
