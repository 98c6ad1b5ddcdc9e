"""The motion of the requests about many designs: at constant speed, sampled."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from analytic.description.changes import without
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.datasheet.building import STEADY, conditions
from comparisons.datasheet.figures import NEGLIGIBLE
from comparisons.designs.steady_motion import SteadyMotion, steady_motion
from reports.requests.case import requested_case
from reports.requests.motions import check_motion
from reports.requests.options.designs import SteadyOptions


class SteadyCase(NamedTuple):
    """A mechanism under a motion at constant speed; ``conditions`` are both in words."""

    mechanism: Mechanism
    motion: SteadyMotion
    conditions: str


def check_steady(options: SteadyOptions) -> None:
    """Raise LinkproofError for a motion that is impossible, or not at constant speed."""
    if options.regime not in ((), (STEADY,)):
        name = ", ".join(options.regime)
        raise LinkproofError(
            f"--regime {name}: designs are compared at constant speed; leave it out, or see one design under that "
            f"motion by linkproof results --regime {name}"
        )
    check_motion(options)


def steady_case(linkage: Linkage, options: SteadyOptions) -> SteadyCase:
    """The requested motion, in the case of a linkage: a turn, the range of a driver that makes none, or --from to --to.

    Raises LinkproofError for bad input.
    """
    check_steady(options)
    linkage = replace(linkage, scales_mass=options.scale_mass)
    mechanism = Mechanism(linkage if options.gravity else without(linkage, "gravity"))
    case = requested_case(mechanism, options)
    case.check_motion()
    first, last = (float(case.motion.angle(np.array([time]))[0]) for time in (0.0, case.motion.duration))
    speed = float(case.motion.speed(np.array([0.0]))[0])
    turns = not (linkage.is_linear or options.swings) and abs(last - first) >= FULL_TURN * (1.0 - NEGLIGIBLE)
    start, end = (None, None) if turns else (first, last)
    motion = steady_motion(mechanism, speed, samples=options.angles, start=start, end=end)
    how = f"refined between {options.angles}" if options.refine else f"sampled at {options.angles}"
    places = "places" if linkage.is_linear else "crank angles"
    newton = ", a numerical reference: Newton's method solves a group" if mechanism.is_numerical else ""
    return SteadyCase(mechanism, motion, f"{conditions(case)}, {how} {places}{newton}")
