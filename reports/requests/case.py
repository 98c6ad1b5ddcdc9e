"""The single motion of a linkage for results, sweep, optimise and tolerance, and the instants of a table."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import without
from analytic.description.crank_motion import RPM, CrankMotion, Segment
from analytic.description.file_units import file_unit
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.datasheet.building import STEADY, conditions, range_motion
from comparisons.datasheet.figures import NEGLIGIBLE
from comparisons.datasheet.instants import Instants
from comparisons.designs.parameters import SteadyMotion, steady_motion
from comparisons.reference.case import Case, case_of_file_regime
from reports.requests.designs_options import SteadyOptions
from reports.requests.motion_options import MotionOptions, ResultsOptions
from reports.requests.motions import EVERYTHING, OWN, check_motion, own_regimes, prescribed_motions


class RequestedResults(NamedTuple):
    """A linkage under a motion, and the instants (n,), s, of its tables; None for the whole motion."""

    case: Case
    chosen: NDArray[np.float64] | None


def requested_results(linkage: Linkage, options: ResultsOptions) -> RequestedResults:
    """The motion and the instants of a request; raises LinkproofError for impossible ones."""
    check_motion(options)
    if options.at is not None and options.time is not None:
        raise LinkproofError("--at and --time both choose the instants of the table: leave one of the two out")
    case = requested_case(Mechanism(linkage if options.gravity else without(linkage, "gravity")), options)
    linkage, instants = case.mechanism.linkage, Instants(case.motion, turns=not case.mechanism.linkage.is_linear)
    if options.at is not None:
        length = file_unit("m", linkage)
        unit, size = (f" {length.name}", length.size) if linkage.is_linear else ("°", math.radians(1.0))
        return RequestedResults(case, instants.times_of_angles(np.array(options.at), unit, size))
    return RequestedResults(case, None if options.time is None else instants.checked_times(np.array(options.time)))


def requested_case(mechanism: Mechanism, options: MotionOptions) -> Case:
    """The linkage under the one requested motion: by default a turn at constant speed, or the range of the crank."""
    linkage = mechanism.linkage
    names = own_regimes(options, [linkage])
    if len(options.regime) > 1 or {EVERYTHING, OWN} & {*options.regime}:
        raise LinkproofError(f"expected one motion, got --regime {', '.join(options.regime)}: choose one of them")
    if names:
        case = case_of_file_regime(mechanism, next(regime for regime in linkage.regimes if regime.name == names[0]))
        return replace(case, mechanism=mechanism)  # a torque over the angle is the drive's, not a load
    if linkage.is_linear or options.swings or options.regime not in ((), (STEADY,)) or _is_timed(options):
        ((motion,), _) = prescribed_motions(options, [linkage])
        return Case(mechanism, motion)
    return _default_case(mechanism, options)


def _is_timed(options: MotionOptions) -> bool:
    """Whether the time of a motion was given."""
    default = MotionOptions()
    times = (options.ramp_time, options.hold_time) != (default.ramp_time, default.hold_time)
    if times and not options.regime:
        raise LinkproofError(
            "--ramp-time and --hold-time apply only to a motion over time: add --regime run-up, or "
            "leave them out for a turn at constant speed"
        )
    return times


def _default_case(mechanism: Mechanism, options: MotionOptions) -> Case:
    """Constant speed over a full turn, or over the range of a crank that makes none, short of its limits."""
    start = math.radians(options.start_angle)
    speed, backwards = abs(options.rpm) * RPM, options.turns_back
    reach = mechanism.crank_range(start if options.start_angle else None)
    if reach.is_full_turn:
        motion = CrankMotion(STEADY, (Segment(0.0, FULL_TURN / speed, (start, -speed if backwards else speed)),))
        return Case(mechanism, motion)
    return Case(mechanism, range_motion(reach, speed, backwards=backwards))


# The motion of the requests about many designs: at constant speed, sampled.


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
