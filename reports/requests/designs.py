"""``sweep``, ``optimise`` and ``tolerance``: many designs of a linkage at a steady speed."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from analytic.description.changes import SPEED
from analytic.description.file_units import file_unit
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError
from comparisons.designs.optimisation import OptimisationRequest, Optimum, optimise
from comparisons.designs.parameters import mass_words, named_figures
from comparisons.designs.simulated_designs import SimulatedDesigns, simulated_designs
from comparisons.designs.space import DesignSpace, Grid, parameter_range, read_table
from comparisons.designs.sweep import SweepRequest, usual_figures
from comparisons.designs.tolerance_study import ToleranceRequest, tolerance_request
from comparisons.designs.tolerances import Tolerances
from comparisons.runs.files import write_text
from reports.requests.campaign import named, run_resources
from reports.requests.campaign_options import CompareOptions, RunLimits
from reports.requests.case import SteadyCase, steady_case
from reports.requests.designs_options import DESIGNS, OptimiseOptions, SweepOptions, ToleranceOptions


class SimulatedCampaign(NamedTuple):
    """Some designs of a sweep, and the campaign in which engines run them."""

    designs: SimulatedDesigns
    options: CompareOptions
    limits: RunLimits


def check_sweep(options: SweepOptions) -> None:
    """Raise LinkproofError for impossible cores and simulations, before any computation."""
    if options.designs < 1:
        raise LinkproofError(f"--designs: expected 1 design or more to simulate, got {options.designs}; give more")
    if options.seed < 0:
        raise LinkproofError(f"--seed: expected a whole number, 0 or more, got {options.seed}; give another")
    if not options.simulate and (options.designs, options.seed) != (DESIGNS, 0):
        option = "--designs" if options.designs != DESIGNS else "--seed"
        raise LinkproofError(f"{option} is for designs that are simulated: name an engine with --simulate")
    named(options.simulate)
    if options.jobs is not None and options.jobs < 1:
        raise LinkproofError(f"--jobs: expected 1 or more cores, got {options.jobs}; correct it")
    run_resources(RunLimits(jobs=options.jobs))


def sweep_request(linkage: Linkage, options: SweepOptions) -> tuple[SweepRequest, str]:
    """The request, and its conditions in words; raises LinkproofError for unknown names."""
    if bool(options.vary) == (options.table is not None):
        got = "both" if options.vary else "neither"
        raise LinkproofError(
            f"expected designs by --vary NAME=FIRST:LAST:COUNT or by --table FILE, got {got}: give one of the two"
        )
    case = steady_case(linkage, options)
    request, conditions = build_sweep_request(case, design_space(case.mechanism.linkage, options), options)
    return request.with_fixed_path(), conditions


def build_sweep_request(case: SteadyCase, space: DesignSpace, options: SweepOptions) -> tuple[SweepRequest, str]:
    """The figures of a space of designs, and the conditions in words; raises LinkproofError for unknown names."""
    linkage = case.mechanism.linkage
    figures = named_figures(case.mechanism, options.quantity) if options.quantity else usual_figures(case.mechanism)
    if not figures:
        raise LinkproofError(f"expected a figure of '{linkage.name}', got none: name one with --quantity")
    conditions = case.conditions + mass_words(linkage, (parameter.name for parameter in space.parameters))
    return SweepRequest(linkage, space, figures, case.motion, options.refine, options.jobs), conditions


def design_space(linkage: Linkage, options: SweepOptions) -> DesignSpace:
    """The grid of ``--vary``, or the list of ``--table``."""
    if options.table is not None:
        return read_table(options.table, linkage)
    return Grid(*zip(*(parameter_range(linkage, text) for text in options.vary), strict=True))


def simulated_campaign(request: SweepRequest, options: SweepOptions, folder: Path) -> SimulatedCampaign:
    """The campaign of engines on some of the designs, whose files are written into a folder."""
    if any(parameter.kind == SPEED for parameter in request.space.parameters):
        raise LinkproofError("--simulate: expected designs of one speed, got several; leave --vary speed out")
    designs, motion = simulated_designs(request, options.designs, options.seed), request.motion
    of_files = replace(options.motion, variant=None)  # a written file has one variant
    if not (motion.is_full_turn or options.swings):
        unit = file_unit("m", request.linkage).size if request.linkage.is_linear else math.radians(1.0)
        first, last = (motion.places[[0, -1]] / unit).tolist()
        of_files = replace(of_files, from_angle=first, to_angle=last)
    for name, text in designs.files.items():
        write_text(folder / f"{name}.toml", text)
    files = tuple(str(folder / f"{name}.toml") for name in designs.files)
    campaign = CompareOptions(mechanisms=files, engine=options.simulate, **vars(of_files))
    return SimulatedCampaign(designs, campaign, RunLimits(jobs=options.jobs))


def build_optimisation_request(options: OptimiseOptions) -> OptimisationRequest:
    """The aim and the constraints of an optimisation; raises LinkproofError for bad input before the search."""
    if (options.minimise is None) == (options.maximise is None):
        got = "neither" if options.minimise is None else "both"
        raise LinkproofError(f"expected --minimise FIGURE or --maximise FIGURE, got {got}; give one, such as Mkr.peak")
    request = OptimisationRequest(
        options.minimise or options.maximise or "", options.over, options.keep, options.minimise is not None,
        options.starts, options.seed, options.everywhere, options.step or "",
    )  # fmt: skip
    request.check()
    named(options.simulate)
    return request


def find_optimum(
    linkage: Linkage, options: OptimiseOptions, announce: Callable[[str, int, int], None] = lambda *_: None
) -> tuple[Optimum, str]:
    """The best design, and the conditions in words."""
    request = build_optimisation_request(options)
    mechanism, motion, conditions = steady_case(linkage, options)
    best = optimise(mechanism, motion, request, announce)
    return best, conditions + mass_words(mechanism.linkage, best.after)


def build_tolerance_request(linkage: Linkage, tolerances: Tolerances, options: ToleranceOptions) -> ToleranceRequest:
    """The request, at the speed of the file of tolerances if it has one; raises LinkproofError for bad input."""
    if tolerances.speed is not None:
        options = replace(options, speed=tolerances.speed)
    mechanism, motion, conditions = steady_case(linkage, options)
    return tolerance_request(
        mechanism, motion, tolerances, samples=options.samples, seed=options.seed, conditions=conditions
    )
