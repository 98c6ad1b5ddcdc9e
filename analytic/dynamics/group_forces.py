"""Force analysis of the dyads in closed form: from what each link needs to the forces in the three joints.

The formulas are those of ``force_formulas``, which says what a wrench is and what a link needs; here they are given a
dyad's joints at its poses.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from analytic.description.linkage import GROUND, Vector
from analytic.dynamics import force_formulas
from analytic.dynamics.force_formulas import JointWrenches, Wrench
from analytic.kinematics import frames
from analytic.kinematics.frames import Pair, Pose
from analytic.kinematics.structure import Dyad, Group, Joint, Prismatic, Revolute, Structure


def references(structure: Structure) -> dict[str, Vector]:
    """The reference point of every body, in its own frame: its outer pin, else its inner pin, else its mass centre.

    With moments taken about pins, lengths are differences of points of one link, however far its frame's origin lies.
    """
    pivot = structure.pivot
    found = {GROUND: (0.0, 0.0)}
    if pivot is not None:
        found[pivot.far] = pivot.far_local if isinstance(pivot, Revolute) else structure.bodies[pivot.far].centre
    for group in structure.groups:
        if isinstance(group, Group):
            found.update({body: _own_pin(group, body) or structure.bodies[body].centre for body in group.links})
            continue
        dyad, inner = group, group.inner_joint
        shared = (inner.far_local, inner.near_local) if isinstance(inner, Revolute) else (None, None)
        for body, outer, pin in zip(dyad.links, (dyad.first_joint, dyad.second_joint), shared, strict=True):
            own = outer.far_local if isinstance(outer, Revolute) else pin
            found[body] = own or structure.bodies[body].centre
    return found


def _own_pin(group: Group, body: str) -> Vector | None:
    """A pin of a link, in its own frame; of the pins to placed bodies if it has one."""
    pins = [joint for joint in group.joints if isinstance(joint, Revolute) and body in (joint.near, joint.far)]
    pins.sort(key=lambda joint: joint.near in group.links)
    return next((joint.far_local if body == joint.far else joint.near_local for joint in pins), None)


@dataclass(frozen=True)
class Statics:
    """A dyad at known poses, and what its first and second link need."""

    dyad: Dyad
    poses: Mapping[str, Pose]
    references: Mapping[str, Vector]
    first: Wrench
    second: Wrench

    def arm(self, body: str, to: Vector) -> Pair:
        """From the reference point of a link of the dyad to another point of it, ground frame."""
        return frames.arm(self.poses[body], frames.minus(to, self.references[body]))

    def gap(self) -> Pair:
        """From the second link's reference point to the first one's."""
        first, second = (frames.point(self.poses[body], self.references[body]) for body in self.dyad.links)
        return frames.minus(first, second)

    def line(self, slide: Joint) -> Pair:
        """Direction of a slide."""
        assert isinstance(slide, Prismatic)
        return frames.arm(self.poses[slide.near], slide.along)

    def inner_arms(self) -> tuple[Pair, Pair]:
        """From the reference points of both links to the inner pin."""
        inner = self.dyad.inner_joint
        assert isinstance(inner, Revolute)
        return self.arm(self.dyad.first, inner.far_local), self.arm(self.dyad.second, inner.near_local)


def joint_wrenches(statics: Statics) -> JointWrenches:
    """What the first, inner and second joint exert on their ``far`` link."""
    return _KINDS[statics.dyad.kind](statics)


def _rrr(of: Statics) -> JointWrenches:
    return force_formulas.rrr(of.first, of.second, *of.inner_arms())


def _rrp(of: Statics) -> JointWrenches:
    r, _ = of.inner_arms()
    return force_formulas.rrp(of.first, of.second, r, of.line(of.dyad.second_joint))


def _rpr(of: Statics) -> JointWrenches:
    return force_formulas.rpr(of.first, of.second, of.line(of.dyad.inner_joint), of.gap())


def _rpp(of: Statics) -> JointWrenches:
    e, f = of.line(of.dyad.second_joint), of.line(of.dyad.inner_joint)
    return force_formulas.rpp(of.first, of.second, e, f, of.gap())


def _prp(of: Statics) -> JointWrenches:
    e, f = of.line(of.dyad.first_joint), of.line(of.dyad.second_joint)
    return force_formulas.prp(of.first, of.second, e, f)


_KINDS: Mapping[str, Callable[[Statics], JointWrenches]] = {
    "RRR": _rrr,
    "RRP": _rrp,
    "RPR": _rpr,
    "RPP": _rpp,
    "PRP": _prp,
}
