"""``sweep``, ``optimise`` and ``tolerance``: many designs of a linkage at a steady speed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from analytic.description.changes import SPEED
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.building import conditions
from comparisons.designer.figures import NEGLIGIBLE
from comparisons.designer.optimisation import Optimum
from comparisons.designer.parameters import (
    SAMPLES,
    SteadyCase,
    case_at_speed,
    known_figures,
    mass_words,
    named_figures,
)
from comparisons.designer.sweep import (
    MOST,
    USUAL,
    DesignSpace,
    SweepRequest,
)
from reports.api.motions import requested_case
from reports.api.options import Motion, SteadyMotion, changed, option_words


def steady_case(
    linkage: Linkage, options: SteadyMotion, *, scale_mass: bool = False, refine: bool = True
) -> SteadyCase:
    """The requested motion, in the case of a linkage: a turn, the range of a driver that makes none, or --from to --to.

    ``scale_mass`` scales masses with lengths, ``refine`` only says in the conditions in words that extremes are exact.
    Raises LinkproofError for bad input.
    """
    mechanism = Mechanism(replace(linkage, scales_mass=scale_mass))
    motion = options.motion
    case = requested_case(motion, mechanism)
    case.check_motion()
    first, last = (float(case.motion.angle(np.array([time]))[0]) for time in (0.0, case.motion.duration))
    speed = float(case.motion.speed(np.array([0.0]))[0])
    turns = not (linkage.is_linear or motion.swings) and abs(last - first) >= FULL_TURN * (1.0 - NEGLIGIBLE)
    start, end = (None, None) if turns else (first, last)
    steady = case_at_speed(mechanism, speed, start=start, end=end)
    how = f"refined between {SAMPLES}" if refine else f"sampled at {SAMPLES}"
    places = "places" if linkage.is_linear else "crank angles"
    newton = ", a numerical reference: Newton's method solves a group" if mechanism.is_numerical else ""
    return replace(steady, conditions=f"{conditions(case)}, {how} {places}{newton}")


def sweep_request(case: SteadyCase, space: DesignSpace, quantity: Sequence[str], *, refine: bool) -> SweepRequest:
    """The request for figures, by name, of a space of designs, the usual ones if no ``quantity`` is named.

    ``refine`` finds exact extremes between the sampled angles. Raises LinkproofError for unknown names, no figure at
    all and more values than memory holds.
    """
    linkage = case.linkage
    figures = named_figures(case.mechanism, quantity) if quantity else known_figures(case.mechanism, USUAL)
    if not figures:
        raise LinkproofError(f"expected a figure of '{linkage.name}', got none: name one with --quantity")
    if space.count * len(figures) > MOST:
        raise LinkproofError(
            f"expected {MOST:.0e} values at most, designs times figures, got {space.count} × {len(figures)}: vary "
            "less, or call linkproof.sweep from Python with Dask arrays, whose chunks are computed one by one"
        )
    conditions = case.conditions + mass_words(linkage, (parameter.name for parameter in space.parameters))
    return SweepRequest(replace(case, conditions=conditions), space, figures, refine)


def aim(minimise: str | None, maximise: str | None) -> str:
    """The figure to optimise; raises LinkproofError unless exactly one of the two is given."""
    if (minimise is None) == (maximise is None):
        got = "neither" if minimise is None else "both"
        raise LinkproofError(f"expected --minimise FIGURE or --maximise FIGURE, got {got}; give one, such as Mkr.peak")
    return minimise or maximise or ""


def check_words(best: Optimum, motion: SteadyMotion) -> tuple[str, ...]:
    """The options, as words such as "--speed", with which ``compare`` checks the best design under the same motion.

    The best speed is among them if it is varied, else that of ``motion``.
    """
    same = replace(motion.motion, variant=None)
    if SPEED in best.after:
        unit = best.problem.case.linkage.phi.speed_unit
        same = replace(same, speed=math.copysign(float(f"{best.after[SPEED] / unit.size:.15g}"), same.rpm))
    return tuple(option_words(Motion, changed(Motion, vars(same))))
