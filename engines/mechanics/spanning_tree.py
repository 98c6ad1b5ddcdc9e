"""The joints of a scene as a tree from the ground and the cuts of its loops, for engines in joint coordinates.

Such an engine moves a body by the one joint that joins it to its parent, and holds every further joint, which closes a
loop, as a constraint. Pins and sliders may be in the tree; slots never are. Sliders go before pins, as a pin is the
easier one to hold as a constraint: a slider is cut only where sliders alone form a loop.
"""

from __future__ import annotations

from dataclasses import dataclass

from analytic.description.linkage import GROUND, Vector
from engines.scene import Body, PinJoint, Scene, SliderJoint, SlotJoint


@dataclass(frozen=True)
class Branch:
    """A body, its parent and the joint between them; None for one that hangs on no pin or slider.

    ``reverse``: the parent is the joint's first body (the pin's ``first``, the slider's ``body``).
    """

    body: Body
    parent: str
    joint: PinJoint | SliderJoint | None
    reverse: bool = False


@dataclass(frozen=True)
class SpanningTree:
    """``branches``, every parent before its children, and the joints ``cuts`` that close the loops."""

    branches: tuple[Branch, ...]
    cuts: tuple[PinJoint | SliderJoint | SlotJoint, ...]


def spanning_tree(scene: Scene) -> SpanningTree:
    """The tree that begins with the crank on the ground; then sliders, and then the pins nearest to the ground."""
    bodies = {body.name: body for body in scene.bodies}
    depth = {GROUND: 0}
    branches: list[Branch] = []
    left: list[PinJoint | SliderJoint] = [*scene.sliders, *scene.pins]

    def rank(joint: PinJoint | SliderJoint) -> tuple[bool, bool, int]:
        ends = _ends(joint)
        nearest = min(depth[end] for end in ends if end in depth)
        return set(ends) != {scene.crank, GROUND}, isinstance(joint, PinJoint), nearest

    while len(branches) < len(bodies):
        open_joints = [joint for joint in left if len(depth.keys() & _ends(joint)) == 1]
        if open_joints:
            joint = min(open_joints, key=rank)
            left.remove(joint)
            first, second = _ends(joint)
            body, parent = (second, first) if first in depth else (first, second)
            branches.append(Branch(bodies[body], parent, joint, reverse=parent == first))
        else:
            body, parent = next(name for name in bodies if name not in depth), GROUND
            branches.append(Branch(bodies[body], parent, None))
        depth[body] = depth[parent] + 1
    return SpanningTree(tuple(branches), (*left, *scene.slots))


def anchors(joint: PinJoint | SliderJoint | SlotJoint) -> tuple[Vector, Vector]:
    """The joint's points on its first and its second body, body frames."""
    if isinstance(joint, PinJoint):
        return joint.first_anchor, joint.second_anchor
    return joint.anchor, joint.through


def _ends(joint: PinJoint | SliderJoint) -> tuple[str, str]:
    return (joint.first, joint.second) if isinstance(joint, PinJoint) else (joint.body, joint.host)
