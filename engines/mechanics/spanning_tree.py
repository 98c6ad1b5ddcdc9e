"""The joints of a scene as a tree from the ground and the cuts of its loops, for engines in joint coordinates.

Such an engine moves a body by the one joint that joins it to its parent, and holds every further joint, which closes a
loop, as a constraint. Pins and sliders may be in the tree; slots never are.
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
    """The tree that begins with the crank on the ground and takes the joints nearest to the ground first."""
    bodies = {body.name: body for body in scene.bodies}
    reached: dict[str, Branch | None] = {GROUND: None}
    joints: list[PinJoint | SliderJoint] = sorted(
        (*scene.pins, *scene.sliders), key=lambda joint: scene.crank not in _ends(joint) or GROUND not in _ends(joint)
    )
    left: list[PinJoint | SliderJoint] = joints
    while True:
        before, level = left, set(reached)
        left = []
        for joint in before:
            first, second = _ends(joint)
            if second in level and first not in reached:
                reached[first] = Branch(bodies[first], second, joint)
            elif first in level and second not in reached:
                reached[second] = Branch(bodies[second], first, joint, reverse=True)
            else:
                left.append(joint)
        if len(left) == len(before):
            loose = next((body for body in scene.bodies if body.name not in reached), None)
            if loose is None:
                break
            reached[loose.name] = Branch(loose, GROUND, None)
    return SpanningTree(tuple(branch for branch in reached.values() if branch), (*left, *scene.slots))


def anchors(joint: PinJoint | SliderJoint | SlotJoint) -> tuple[Vector, Vector]:
    """The joint's points on its first and its second body, body frames."""
    if isinstance(joint, PinJoint):
        return joint.first_anchor, joint.second_anchor
    return joint.anchor, joint.through


def _ends(joint: PinJoint | SliderJoint) -> tuple[str, str]:
    return (joint.first, joint.second) if isinstance(joint, PinJoint) else (joint.body, joint.host)
