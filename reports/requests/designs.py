"""``sweep``, ``optimise`` and ``tolerance``: many designs of a linkage at a steady speed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from analytic.description.changes import without
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.building import conditions
from comparisons.designer.figures import NEGLIGIBLE
from comparisons.designer.optimisation import OptimisationRequest, Optimum, optimise
from comparisons.designer.parameters import SAMPLES, SteadyMotion, mass_words, named_figures, steady_motion
from comparisons.designer.sweep import MOST, DesignSpace, SweepRequest, parameter_range, read_table, usual_figures
from comparisons.designer.tolerances import ToleranceRequest, Tolerances, tolerance_request
from comparisons.motion.case import Case
from reports.requests.motions import requested_case
from reports.requests.options import OptimiseOptions, SteadyOptions, SweepOptions, ToleranceOptions


class SteadyCase(NamedTuple):
    """A mechanism under a motion at constant speed, and the case of both; ``conditions`` are both in words."""

    mechanism: Mechanism
    motion: SteadyMotion
    conditions: str
    case: Case


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
    return SteadyCase(mechanism, motion, f"{conditions(case)}, {how} {places}{newton}", case)


def sweep_request(linkage: Linkage, options: SweepOptions) -> SweepRequest:
    """The request of the command; raises LinkproofError for unknown names and too many designs."""
    if bool(options.vary) == (options.table is not None):
        got = "both" if options.vary else "neither"
        raise LinkproofError(
            f"expected designs by --vary NAME=FIRST:LAST:COUNT or by --table FILE, got {got}: give one of the two"
        )
    case = steady_case(linkage, options)
    return build_sweep_request(case, design_space(case.mechanism.linkage, options), options)


def build_sweep_request(case: SteadyCase, space: DesignSpace, options: SweepOptions) -> SweepRequest:
    """The figures of a space of designs; raises LinkproofError for unknown names and more values than memory holds."""
    linkage = case.mechanism.linkage
    figures = named_figures(case.mechanism, options.quantity) if options.quantity else usual_figures(case.mechanism)
    if not figures:
        raise LinkproofError(f"expected a figure of '{linkage.name}', got none: name one with --quantity")
    if space.count * len(figures) > MOST:
        raise LinkproofError(
            f"expected {MOST:.0e} values at most, designs times figures, got {space.count} × {len(figures)}: vary "
            "less, or call linkproof.sweep from Python with Dask arrays, whose chunks are computed one by one"
        )
    conditions = case.conditions + mass_words(linkage, (parameter.name for parameter in space.parameters))
    return SweepRequest(linkage, space, figures, case.motion, options.refine, conditions)


def design_space(linkage: Linkage, options: SweepOptions) -> DesignSpace:
    """The grid of ``--vary``, or the list of ``--table``."""
    if options.table is not None:
        return read_table(options.table, linkage)
    numbers, columns = zip(*(parameter_range(linkage, text) for text in options.vary), strict=True)
    return DesignSpace(numbers, columns)


def build_optimisation_request(options: OptimiseOptions) -> OptimisationRequest:
    """The aim and the constraints of an optimisation; raises LinkproofError for bad input before the search."""
    if (options.minimise is None) == (options.maximise is None):
        got = "neither" if options.minimise is None else "both"
        raise LinkproofError(f"expected --minimise FIGURE or --maximise FIGURE, got {got}; give one, such as Mkr.peak")
    return OptimisationRequest(
        options.minimise or options.maximise or "", options.over, options.keep, options.minimise is not None,
        options.everywhere, options.step or "",
    )  # fmt: skip


def find_optimum(
    linkage: Linkage, options: OptimiseOptions, announce: Callable[[str, int, int], None] = lambda *_: None
) -> tuple[Optimum, str]:
    """The best design, and the conditions in words."""
    request = build_optimisation_request(options)
    mechanism, motion, conditions, _ = steady_case(linkage, options)
    best = optimise(mechanism, motion, request, announce)
    return best, conditions + mass_words(mechanism.linkage, best.after)


def build_tolerance_request(linkage: Linkage, tolerances: Tolerances, options: ToleranceOptions) -> ToleranceRequest:
    """The request, at the speed of the file of tolerances if it has one; raises LinkproofError for bad input."""
    if tolerances.speed is not None:
        options = replace(options, speed=tolerances.speed)
    mechanism, motion, conditions, _ = steady_case(linkage, options)
    return tolerance_request(mechanism, motion, tolerances, samples=options.samples, conditions=conditions)
