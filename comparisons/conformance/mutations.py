"""Faults that a user would want to hear of, planted in an engine's world: one that is not the scene's.

A mutant's world is built from another case than the one it is judged by. What is altered is small, of the size of a
slip in an adapter; each is planted in the sample of ``samples`` on which it matters. Faults of the model come from the
list that ``judge`` fits; those of the drive are here, as engines get polynomials of time.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

from analytic.description.crank_motion import CrankMotion, Segment
from analytic.description.law import FULL_TURN
from analytic.kinematics.mechanism import Mechanism
from comparisons.conformance.samples import PLAIN
from comparisons.faults.ranking import model_faults
from comparisons.faults.simulation import Simulation
from comparisons.reference.case import Case
from engines.scene import Free

SLIP: Final = 1e-4  # m: by how much a point is out of place
PART: Final = 0.01  # of a mass, an inertia, a stiffness, gravity
SPEED_PART: Final = 0.001
LATE: Final = 0.002  # of a turn at the motion's peak speed
TURN: Final = math.radians(0.1)


@dataclass(frozen=True)
class Mutation:
    """What is altered, and on which sample."""

    sample: str
    alter: Callable[[Case], Case]


def _planted(case: Case, name: str, times: float = 1.0, plus: float = 0.0) -> Case:
    """A fault of the list by its name, its number that of the file times a factor, plus a difference."""
    simulation = Simulation(case.mechanism.linkage, case.motion)
    fault = next(fault for fault in model_faults(simulation) if fault.name == name)
    linkage = fault.plant(simulation, *(times * number + plus for number in fault.start)).linkage
    return replace(case, mechanism=Mechanism(linkage), _seen={})


def _fault(sample: str, name: str, times: float = 1.0, plus: float = 0.0) -> Mutation:
    return Mutation(sample, partial(_planted, name=name, times=times, plus=plus))


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


MORE: Final = 1.0 + PART
LINKS: Final = ("crank", "coupler", "rocker")
MUTATIONS: Final[Mapping[str, Mutation]] = {
    **{f"{link} 1 % heavier": _fault(PLAIN, f"{link}.mass", MORE) for link in LINKS},
    **{f"{link}'s inertia 1 % larger": _fault(PLAIN, f"{link}.inertia", MORE) for link in LINKS},
    "coupler's mass centre off by 1 mm": _fault(PLAIN, "coupler.centre.x", plus=10.0 * SLIP),
    "coupler's mass centre mirrored": _fault(PLAIN, "coupler.centre.y", -1.0),
    "no gravity": _fault(PLAIN, "gravity", 0.0),
    "gravity upside down": _fault(PLAIN, "gravity", -1.0),
    "gravity turned by 1°": _fault(PLAIN, "gravity.x", plus=9.81 * 10.0 * TURN),
    "gravity 1 % larger": _fault(PLAIN, "gravity", MORE),
    "coupler's pin off by 0.1 mm": _fault(PLAIN, "coupler.B.y", plus=SLIP),
    "rocker's pivot off by 0.1 mm": _fault(PLAIN, "ground.O2.x", plus=SLIP),
    "crank longer by 0.1 mm": _fault(PLAIN, "crank.A.x", plus=SLIP),
    "drive 0.1 % too fast": Mutation(PLAIN, _driven(_faster(1.0 + SPEED_PART))),
    "drive reversed": Mutation(PLAIN, _driven(_faster(-1.0))),
    "drive late": Mutation(PLAIN, _driven(_late)),
    "slider 1 % heavier": _fault("slider-crank", "slider.mass", MORE),
    "guide turned by 0.1°": _fault("slider-crank", "slider.along", plus=TURN),
    "guide off by 0.1 mm": _fault("slider-crank", "slider.through.y", plus=SLIP),
    "slider's mass centre off by 1 mm": _fault("slider-crank", "slider.centre.y", plus=10.0 * SLIP),
    "slot turned by 0.1°": _fault("quick return", "A in rocker.along", plus=TURN),
    "slot off by 0.1 mm": _fault("quick return", "A in rocker.through.y", plus=SLIP),
    "slot's pin off by 0.1 mm": _fault("quick return", "crank.A.x", plus=SLIP),
    "force left out": _fault("force", "no forces"),
    "force reversed": _fault("force", "forces.P", -1.0),
    "force 1 % larger": _fault("force", "forces.P.x", MORE),
    "force at another point": _fault("force", "forces.P at B"),
    "force over the angle late by 2°": _fault("force over the angle", "forces.P late", plus=20.0 * TURN),
    "force over the angle by its mean": _fault("force over the angle", "forces.P by its mean"),
    "torque left out": _fault("torque", "no torques"),
    "torque reversed": _fault("torque", "torques.rocker", -1.0),
    "torque on another link": _fault("torque", "torques.rocker on coupler"),
    "spring left out": _fault("spring", "no springs"),
    "spring 1 % stiffer": _fault("spring", "springs.P.F.stiffness", MORE),
    "spring longer by 1 mm": _fault("spring", "springs.P.F.length", plus=10.0 * SLIP),
    "dashpot left out": _fault("spring", "springs.P.F.damping", 0.0),
    "damper left out": _fault("damper", "no dampers"),
    "damper against the ground": _fault("damper", "dampers.coupler.rocker against the ground"),
    "driven slider's guide turned by 0.1°": _fault("driven slider", "piston.along", plus=TURN),
    "driven slider ahead by 0.1 mm": Mutation("driven slider", _driven(_ahead)),
    "cylinder longer by 0.1 mm": Mutation("cylinder", _driven(_ahead)),
    "cylinder's end off by 1 mm": _fault("cylinder", "ground.Q.x", plus=10.0 * SLIP),
    "released crank's torque 1 % larger": Mutation("released", _released_harder),
}  # fmt: skip
