"""Force analysis of the dyads in closed form: from what each link needs to the forces in the three joints.

A dyad is statically determinate: its six equations of equilibrium hold the six unknowns of its three joints. Each kind
reduces to a 2×2 system at most, the transpose of the one which its velocities solve; its determinant vanishes in the
same dead positions. (Kinetostatics of Assur groups: I. I. Artobolevskii, Theory of Mechanisms and Machines.)

A *wrench* is (force x, force y, N, moment, N m). What a link *needs* is the wrench that its joints of the dyad together
must exert on it, about the link's reference point, which is a pin of the dyad wherever it has one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from analytic.description.linkage import GROUND, Vector
from analytic.kinematics import frames
from analytic.kinematics.frames import Pair, Pose, Scalar
from analytic.kinematics.structure import Dyad, Group, Joint, Prismatic, Revolute, Structure

Wrench = tuple[Scalar, Scalar, Scalar]
JointWrenches = tuple[Wrench, Wrench, Wrench]


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

    def place(self, body: str) -> Pair:
        """Where the reference point of a body is."""
        return frames.point(self.poses[body], self.references[body])

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
    """What the first, inner and second joint exert on their ``far`` link.

    The moment of a slide is about the link's reference point; a pin exerts its force at the pin and no moment.
    """
    return _KINDS[statics.dyad.kind](statics)


def _rrr(statics: Statics) -> JointWrenches:
    """RRR: r × N = M₁ and −q × N = M₂ about the outer pins give the inner force N; r and q reach from them to it."""
    one, two = statics.first, statics.second
    r, q = statics.inner_arms()
    scale = 1.0 / frames.cross(r, q)
    n = ((one[2] * q[0] + two[2] * r[0]) * scale, (one[2] * q[1] + two[2] * r[1]) * scale)
    return (one[0] - n[0], one[1] - n[1], 0.0), (*n, 0.0), (two[0] + n[0], two[1] + n[1], 0.0)


def _rrp(statics: Statics) -> JointWrenches:
    """RRP: r × N = M₁ about the outer pin and −N·e = F₂·e along the slide give the inner force N = a e + b e⊥."""
    one, two = statics.first, statics.second
    r, _ = statics.inner_arms()
    e = statics.line(statics.dyad.second_joint)
    a = -frames.dot(e, two[:2])
    b = (one[2] - a * frames.cross(r, e)) / frames.dot(r, e)
    n = (a * e[0] - b * e[1], a * e[1] + b * e[0])
    return (one[0] - n[0], one[1] - n[1], 0.0), (*n, 0.0), _across(e, frames.cross(e, two[:2]) + b, two[2])


def _rpr(statics: Statics) -> JointWrenches:
    """RPR: the moments about both outer pins, M₁ + M₂ = −n d·e with d from the second to the first, give n e⊥."""
    one, two = statics.first, statics.second
    e = statics.line(statics.dyad.inner_joint)
    d = frames.minus(statics.place(statics.dyad.first), statics.place(statics.dyad.second))
    n = _across(e, -(one[2] + two[2]) / frames.dot(d, e), one[2])
    return (one[0] - n[0], one[1] - n[1], 0.0), n, (two[0] + n[0], two[1] + n[1], 0.0)


def _rpp(statics: Statics) -> JointWrenches:
    """RPP: F₂ = n e⊥ − k f⊥ across the outer and the inner slide; the moments are passed on."""
    one, two = statics.first, statics.second
    e, f = statics.line(statics.dyad.second_joint), statics.line(statics.dyad.inner_joint)
    scale = 1.0 / frames.cross(e, f)
    inner = _across(f, frames.dot(two[:2], e) * scale, one[2])
    gap = frames.minus(statics.place(statics.dyad.first), statics.place(statics.dyad.second))
    passed_on = one[2] + frames.cross(gap, inner[:2])
    outer = _across(e, frames.dot(two[:2], f) * scale, two[2] + passed_on)
    return (one[0] - inner[0], one[1] - inner[1], 0.0), inner, outer


def _prp(statics: Statics) -> JointWrenches:
    """PRP: N·e = F₁·e and −N·f = F₂·f along the slides give the inner force N = a e⊥ + b f⊥."""
    one, two = statics.first, statics.second
    e, f = statics.line(statics.dyad.first_joint), statics.line(statics.dyad.second_joint)
    scale = 1.0 / frames.cross(e, f)
    a, b = -frames.dot(two[:2], f) * scale, -frames.dot(one[:2], e) * scale
    both = frames.dot(e, f)
    n = (-a * e[1] - b * f[1], a * e[0] + b * f[0], 0.0)
    first = _across(e, frames.cross(e, one[:2]) - a - b * both, one[2])
    return first, n, _across(f, frames.cross(f, two[:2]) + a * both + b, two[2])


def _across(direction: Pair, size: Scalar, moment: Scalar) -> Wrench:
    """What a slide exerts: a force square to it, on its left where ``size`` is positive, and a moment."""
    return (-size * direction[1], size * direction[0], moment)


_KINDS: Mapping[str, Callable[[Statics], JointWrenches]] = {
    "RRR": _rrr,
    "RRP": _rrp,
    "RPR": _rpr,
    "RPP": _rpp,
    "PRP": _prp,
}
