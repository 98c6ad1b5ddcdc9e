"""Ways to be wrong that a user would want to hear of: an engine's world that is not the scene's.

A mutant's world is built from another case than the one it is judged by. What is altered is small, of the size of a
slip in an adapter; each belongs to the sample of ``samples`` on which it matters.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from analytic.description.changes import Change, changed, without
from analytic.description.crank_motion import CrankMotion, Segment
from analytic.description.law import FULL_TURN, Law
from analytic.description.linkage import GROUND, Linkage, Vector, rotate
from analytic.kinematics.mechanism import Mechanism
from comparisons.conformance.samples import PLAIN
from comparisons.reference.case import Case
from engines.scene import Free

SLIP = 1e-4  # m: by how much a point is out of place
PART = 0.01  # of a mass, an inertia, a stiffness, gravity
SPEED_PART = 0.001
LATE = 0.002  # of a turn at the motion's peak speed
TURN = math.radians(0.1)


@dataclass(frozen=True)
class Mutation:
    """What is altered, and on which sample."""

    sample: str
    alter: Callable[[Case], Case]


def _of_linkage(alter: Callable[[Linkage], Linkage]) -> Callable[[Case], Case]:
    def altered(case: Case) -> Case:
        return replace(case, mechanism=Mechanism(alter(case.mechanism.linkage)), _seen={})

    return altered


def _number(name: str, change: Callable[[float], float]) -> Callable[[Case], Case]:
    def one(this: str, _: object, value: float) -> float:
        return change(value) if this == name else value

    applied: Change = one
    return _of_linkage(lambda linkage: changed(linkage, applied))


def _larger(name: str, part: float = PART) -> Callable[[Case], Case]:
    return _number(name, lambda value: value * (1.0 + part))


def _shifted(name: str, by: float = SLIP) -> Callable[[Case], Case]:
    return _number(name, lambda value: value + by)


def _without(part: str) -> Callable[[Case], Case]:
    return _of_linkage(lambda linkage: without(linkage, part))


def _turned(vector: Vector, angle: float) -> Vector:
    return rotate(vector, (math.cos(angle), math.sin(angle)))


def _gravity(angle: float) -> Callable[[Case], Case]:
    return _of_linkage(lambda linkage: replace(linkage, gravity=_turned(linkage.gravity, angle)))


def _each(part: str, change: Callable[[Any], Any]) -> Callable[[Case], Case]:
    """Every load of a kind, or guided joint, changed."""

    def altered(linkage: Linkage) -> Linkage:
        changed: dict[str, Any] = {part: tuple(map(change, getattr(linkage, part)))}
        return replace(linkage, **changed)

    return _of_linkage(altered)


def _law(part: str, name: str, change: Callable[[Law], Law]) -> Callable[[Case], Case]:
    return _each(part, lambda load: replace(load, **{name: change(getattr(load, name))}))


def _guide_turned(part: str) -> Callable[[Case], Case]:
    def turned(joint: Any) -> Any:  # noqa: ANN401 - a slider or a slot
        return replace(joint, guide=replace(joint.guide, along=_turned(joint.guide.along, TURN)))

    return _each(part, turned)


def _driven(change: Callable[[CrankMotion], tuple[Segment, ...]]) -> Callable[[Case], Case]:
    def altered(case: Case) -> Case:
        motion = case.motion
        assert isinstance(motion, CrankMotion)
        return replace(case, motion=replace(motion, segments=change(motion)), _seen={})

    return altered


def _faster(factor: float) -> Callable[[CrankMotion], tuple[Segment, ...]]:
    def segments(motion: CrankMotion) -> tuple[Segment, ...]:
        start = motion.segments[0].coefficients[0]
        return tuple(
            replace(s, coefficients=(start + factor * (first - start), *(factor * c for c in rest)))
            for s in motion.segments
            for first, *rest in [s.coefficients]
        )

    return segments


def _ahead(motion: CrankMotion) -> tuple[Segment, ...]:
    """The motion of a linear drive a little farther out."""
    return tuple(replace(s, coefficients=(s.coefficients[0] + SLIP, *s.coefficients[1:])) for s in motion.segments)


def _late(motion: CrankMotion) -> tuple[Segment, ...]:
    """The same motion a little later, and at rest before it."""
    delay, end = LATE * FULL_TURN / motion.peak_speed, motion.duration
    moved = [replace(s, start=s.start + delay, end=min(s.end + delay, end)) for s in motion.segments]
    return (Segment(0.0, delay, motion.segments[0].coefficients[:1]), *moved)


def _released_harder(case: Case) -> Case:
    drive = case.drive
    assert isinstance(drive, Free)
    return replace(case, drive=replace(drive, torque=drive.torque * (1.0 + PART)), _seen={})


def _mirrored_centre(linkage: Linkage) -> Linkage:
    """The coupler's mass centre on the other side of the line between its pins."""
    link = linkage.links["coupler"]
    (ax, ay), (bx, by), (cx, cy) = link.points["A"], link.points["B"], link.centre
    along = np.array([bx - ax, by - ay]) / math.hypot(bx - ax, by - ay)
    arm = np.array([cx - ax, cy - ay])
    x, y = (2.0 * along * float(along @ arm) - arm).tolist()
    return replace(linkage, links={**linkage.links, "coupler": replace(link, centre=(ax + x, ay + y))})


def _negative(law: Law) -> Law:
    return replace(law, values=-law.values)


def _mean(law: Law) -> Law:
    return Law(law.values.mean(axis=0))


def _later(law: Law) -> Law:
    assert law.angles is not None
    return replace(law, angles=law.angles + math.radians(2.0))


MUTATIONS: Final[Mapping[str, Mutation]] = {
    "crank 1 % heavier": Mutation(PLAIN, _larger("crank.mass")),
    "coupler 1 % heavier": Mutation(PLAIN, _larger("coupler.mass")),
    "rocker 1 % heavier": Mutation(PLAIN, _larger("rocker.mass")),
    "crank's inertia 1 % larger": Mutation(PLAIN, _larger("crank.inertia")),
    "coupler's inertia 1 % larger": Mutation(PLAIN, _larger("coupler.inertia")),
    "rocker's inertia 1 % larger": Mutation(PLAIN, _larger("rocker.inertia")),
    "coupler's mass centre off by 1 mm": Mutation(PLAIN, _shifted("coupler.centre.x", 10.0 * SLIP)),
    "coupler's mass centre mirrored": Mutation(PLAIN, _of_linkage(_mirrored_centre)),
    "no gravity": Mutation(PLAIN, _without("gravity")),
    "gravity upside down": Mutation(PLAIN, _gravity(math.pi)),
    "gravity turned by 1°": Mutation(PLAIN, _gravity(10.0 * TURN)),
    "gravity 1 % larger": Mutation(PLAIN, _of_linkage(
        lambda linkage: replace(linkage, gravity=(linkage.gravity[0] * (1.0 + PART), linkage.gravity[1] * (1.0 + PART)))
    )),
    "coupler's pin off by 0.1 mm": Mutation(PLAIN, _shifted("coupler.B.y")),
    "rocker's pivot off by 0.1 mm": Mutation(PLAIN, _shifted("ground.O2.x")),
    "crank longer by 0.1 mm": Mutation(PLAIN, _shifted("crank.A.x")),
    "drive 0.1 % too fast": Mutation(PLAIN, _driven(_faster(1.0 + SPEED_PART))),
    "drive reversed": Mutation(PLAIN, _driven(_faster(-1.0))),
    "drive late": Mutation(PLAIN, _driven(_late)),
    "slider 1 % heavier": Mutation("slider-crank", _larger("slider.mass")),
    "guide turned by 0.1°": Mutation("slider-crank", _guide_turned("sliders")),
    "guide off by 0.1 mm": Mutation("slider-crank", _shifted("slider.through.y")),
    "slider's mass centre off by 1 mm": Mutation("slider-crank", _shifted("slider.centre.y", 10.0 * SLIP)),
    "slot turned by 0.1°": Mutation("quick return", _guide_turned("slots")),
    "slot off by 0.1 mm": Mutation("quick return", _shifted("A in rocker.through.y")),
    "slot's pin off by 0.1 mm": Mutation("quick return", _shifted("crank.A.x")),
    "force left out": Mutation("force", _without("forces")),
    "force reversed": Mutation("force", _law("forces", "force", _negative)),
    "force 1 % larger": Mutation("force", _larger("forces.P.x")),
    "force at another point": Mutation("force", _each("forces", lambda force: replace(force, point="B"))),
    "force over the angle late by 2°": Mutation("force over the angle", _law("forces", "force", _later)),
    "force over the angle by its mean": Mutation("force over the angle", _law("forces", "force", _mean)),
    "torque left out": Mutation("torque", _without("torques")),
    "torque reversed": Mutation("torque", _law("torques", "torque", _negative)),
    "torque on another link": Mutation("torque", _each("torques", lambda torque: replace(torque, link="coupler"))),
    "spring left out": Mutation("spring", _without("springs")),
    "spring 1 % stiffer": Mutation("spring", _larger("springs.P.F.stiffness")),
    "spring longer by 1 mm": Mutation("spring", _shifted("springs.P.F.length", 10.0 * SLIP)),
    "dashpot left out": Mutation("spring", _each("springs", lambda spring: replace(spring, damping=0.0))),
    "damper left out": Mutation("damper", _without("dampers")),
    "damper against the ground": Mutation(
        "damper", _each("dampers", lambda damper: replace(damper, links=("coupler", GROUND)))
    ),
    "driven slider's guide turned by 0.1°": Mutation("driven slider", _guide_turned("sliders")),
    "driven slider ahead by 0.1 mm": Mutation("driven slider", _driven(_ahead)),
    "cylinder longer by 0.1 mm": Mutation("cylinder", _driven(_ahead)),
    "cylinder's end off by 1 mm": Mutation("cylinder", _shifted("ground.Q.x", 10.0 * SLIP)),
    "released crank's torque 1 % larger": Mutation("released", _released_harder),
}  # fmt: skip
