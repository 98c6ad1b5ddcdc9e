"""``linkproof bench``: measure error against run time, print, write."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import closing
from dataclasses import replace

from analytic.errors import LinkproofError, UnknownNameError, symbol
from comparisons.motion.case import Case
from comparisons.trials.campaign.campaign import CampaignRequest, each_case
from comparisons.trials.judging.quantities import QUANTITIES as COMPARED
from comparisons.trials.judging.quantities import check_defined
from comparisons.trials.runs.cluster import DaskPool
from comparisons.trials.runs.workers import LocalPool
from comparisons.trials.work_precision.measure import JOINTS, chosen_families
from comparisons.trials.work_precision.study import FULL, QUANTITIES, QUICK, BenchRequest
from comparisons.trials.work_precision.study import bench as measure_all
from comparisons.trials.work_precision.table import KIND, load, save
from reports.api.campaign import missing_engines, request
from reports.api.exit_codes import bench_exit_code
from reports.api.options import BenchOptions, Motion, RunsOptions, command_line
from reports.command_line.destination import Destination
from reports.command_line.unfinished import finished_runs, report_interruption
from reports.work_precision.words import printout

REGIMES, QUICK_REGIMES = ("run-up-quintic", "run-up"), ("run-up-quintic",)


def bench(options: BenchOptions, destination: Destination, scheduler: str | None = None) -> int:
    """Measure, write the requested files, print the tables; returns the exit code.

    Raises LinkproofError for bad input before any run.
    """
    destination.check(f"{KIND}.html")
    out = destination.out
    requested = request(_default_runs(options))
    wanted = _request(options, requested)
    destination.warn(requested.linkages)
    if destination.verbose and not options.engine:
        destination.remark(missing_engines(requested.engines))
    pool = LocalPool(1, lasts=True) if scheduler is None else DaskPool(scheduler, is_one_by_one=True)
    with closing(pool), report_interruption(out, KIND) as counting:
        finished = finished_runs(out, wanted.command, requested.engines, requested.linkages) if out else None
        wanted = replace(wanted, pool=pool)
        with destination.progress() as announce:
            result = measure_all(wanted, counting(announce), finished)
        destination.write_json(result.as_dict)
        if out:
            save(out, result)
        if finished:
            finished.clear()
    destination.print_out(printout(result, tuple(map(symbol, options.quantity))))
    destination.write_pages()
    return bench_exit_code(result, wanted.engines)


def write_again(destination: Destination) -> int:
    """Write the pages and the tables of the benchmark that is in the folder of ``--out``; returns its exit code."""
    destination.check(f"{KIND}.html")
    assert destination.out is not None
    result = load(destination.out)
    destination.write_json(result.as_dict)
    requested = tuple(result.document["quantities"])
    destination.print_out(printout(result, () if requested == QUANTITIES else requested))
    destination.write_pages()
    return bench_exit_code(result, {point.engine for point in result.points})


def _default_runs(options: BenchOptions) -> RunsOptions:
    """The runs, with the default motions if none is named, and without a choice of quantities.

    A quick benchmark runs up over half a turn and turns half a turn more, which shows as much as many turns.
    """
    usual = () if options.swings else QUICK_REGIMES if options.quick else REGIMES
    options = replace(options, regime=options.regime or usual, quantity=())
    default = Motion()
    times = (options.ramp_time, options.hold_time) == (default.ramp_time, default.hold_time)
    if options.quick and times and options.rpm and not options.swings:
        turn = 60.0 / abs(options.rpm)
        options = replace(options, ramp_time=turn, hold_time=0.5 * turn)
    return options


def _request(options: BenchOptions, requested: CampaignRequest) -> BenchRequest:
    """The benchmark to measure; raises LinkproofError for a quantity that a case does not have."""
    every = tuple(each_case(requested))
    quantities = tuple(dict.fromkeys(map(symbol, options.quantity))) or QUANTITIES
    for name in quantities:
        if name not in (*COMPARED, JOINTS):
            raise UnknownNameError("quantity", name, (*COMPARED, JOINTS))
    for case in every:
        groups = chosen_families(case, quantities)
        if not groups:
            raise LinkproofError(_nothing_to_measure(case, quantities))
        check_defined(case, [quantity for family in groups.values() for quantity in family])
    extent, command = QUICK if options.quick else FULL, command_line("bench", options)
    return BenchRequest(every, requested.engines, quantities, extent=extent, command=command)


def _nothing_to_measure(case: Case, quantities: Iterable[str]) -> str:
    return (
        f"none of {', '.join(quantities)} is a result of '{case.mechanism.linkage.name}' in regime "
        f"'{case.motion.regime}': ask for another quantity, or leave the regime out"
    )
