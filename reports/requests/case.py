"""The single motion of a linkage for results, sweep, optimise and tolerance, and the instants of a table."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import without
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.description.written import file_unit
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.case import Case
from comparisons.datasheet.building import conditions
from comparisons.datasheet.curves import Instants
from comparisons.datasheet.figures import NEGLIGIBLE
from comparisons.designs.parameters import SAMPLES, SteadyMotion, steady_motion
from reports.requests.designs_options import SteadyOptions
from reports.requests.motion_options import ResultsOptions
from reports.requests.motions import requested_case


class RequestedResults(NamedTuple):
    """A linkage under a motion, and the instants (n,), s, of its tables; None for the whole motion."""

    case: Case
    chosen: NDArray[np.float64] | None


def requested_results(linkage: Linkage, options: ResultsOptions) -> RequestedResults:
    """The motion and the instants of a request; raises LinkproofError for impossible ones."""
    if options.at is not None and options.time is not None:
        raise LinkproofError("--at and --time both choose the instants of the table: leave one of the two out")
    case = requested_case(options, Mechanism(linkage if options.gravity else without(linkage, "gravity")))
    linkage, instants = case.mechanism.linkage, Instants(case.motion, turns=not case.mechanism.linkage.is_linear)
    if options.at is not None:
        length = file_unit("m", linkage)
        unit, size = (f" {length.name}", length.size) if linkage.is_linear else ("°", math.radians(1.0))
        return RequestedResults(case, instants.times_of_angles(np.array(options.at), unit, size))
    return RequestedResults(case, None if options.time is None else instants.checked_times(np.array(options.time)))


# The motion of the requests about many designs: at constant speed, sampled.


class SteadyCase(NamedTuple):
    """A mechanism under a motion at constant speed; ``conditions`` are both in words."""

    mechanism: Mechanism
    motion: SteadyMotion
    conditions: str


def steady_case(linkage: Linkage, options: SteadyOptions) -> SteadyCase:
    """The requested motion, in the case of a linkage: a turn, the range of a driver that makes none, or --from to --to.

    Raises LinkproofError for bad input.
    """
    linkage = replace(linkage, scales_mass=options.scale_mass)
    mechanism = Mechanism(linkage if options.gravity else without(linkage, "gravity"))
    case = requested_case(options, mechanism)
    case.check_motion()
    first, last = (float(case.motion.angle(np.array([time]))[0]) for time in (0.0, case.motion.duration))
    speed = float(case.motion.speed(np.array([0.0]))[0])
    turns = not (linkage.is_linear or options.swings) and abs(last - first) >= FULL_TURN * (1.0 - NEGLIGIBLE)
    start, end = (None, None) if turns else (first, last)
    motion = steady_motion(mechanism, speed, start=start, end=end)
    how = f"refined between {SAMPLES}" if options.refine else f"sampled at {SAMPLES}"
    places = "places" if linkage.is_linear else "crank angles"
    newton = ", a numerical reference: Newton's method solves a group" if mechanism.is_numerical else ""
    return SteadyCase(mechanism, motion, f"{conditions(case)}, {how} {places}{newton}")
