"""What ``linkproof bench`` does, once its words are parsed: measure, print, write."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import closing
from dataclasses import asdict, replace
from typing import Any

from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, UnknownNameError
from comparisons.campaign.campaign import CampaignRequest, cases
from comparisons.judging.quantities import QUANTITIES as COMPARED
from comparisons.judging.quantities import check_defined
from comparisons.reference.case import Case
from comparisons.runs.cluster.connecting import check_scheduler, opened
from comparisons.runs.environment import environment
from comparisons.runs.timing import WORK
from comparisons.runs.workers import LastingPool
from comparisons.work_precision import costs
from comparisons.work_precision.measure import JOINTS, chosen
from comparisons.work_precision.points import FULL, QUICK
from comparisons.work_precision.records import KIND, Bench, save
from comparisons.work_precision.study import QUANTITIES, BenchRequest, Measured, method_descriptions
from comparisons.work_precision.study import bench as measure_all
from reports.command_line.destination import Destination
from reports.command_line.interruption import interruptible, journal
from reports.requests.campaign import installed, request
from reports.requests.exit_codes import bench_exit_code
from reports.requests.options.campaign import BenchOptions, RunsOptions
from reports.requests.options.declaring import command_line
from reports.requests.options.motion import MotionOptions
from reports.requests.standard import of_project
from reports.work_precision.terminal import printout

REGIMES, QUICK_REGIMES = ("run-up-quintic", "run-up"), ("run-up-quintic",)


def bench(options: BenchOptions, destination: Destination, scheduler: object = None) -> int:
    """Measure, write the requested files, print the tables; returns the exit code.

    Where no linkages or engines are named, those of the project are measured. The workers of a ``scheduler`` measure,
    where there is one, one run at a time on a machine.
    Raises LinkproofError for anything that does not exist or cannot be, before any run is made.
    """
    destination.check(KIND)
    options = of_project(options)
    out, command = destination.out, command_line("bench", options)
    check_scheduler(scheduler)
    if scheduler is not None and options.costs:
        raise LinkproofError("--costs are those of this machine, and --scheduler measures elsewhere: leave one out")
    asked = request(_campaign(options))
    wanted = _request(options, asked)
    with (
        closing(LastingPool()) as here,
        opened(scheduler, here, alone=True) as pool,
        interruptible(out) as counting,
    ):
        kept = journal(out, command, asked.engines, asked.linkages, resume=destination.resume) if out else None
        wanted = replace(wanted, pool=pool)
        with destination.progress() as announce:
            measured = measure_all(wanted, counting(announce), kept)
        found = Bench(_document(options, command, wanted, measured))
        destination.write_json(found.document)
        if out:
            save(out, found.document)
            destination.write_pages()
        if kept:
            kept.clear()
    destination.print_out(printout(found, options.quantity))
    return bench_exit_code(measured.records, wanted.engines)


def _campaign(options: BenchOptions) -> RunsOptions:
    """What is run, in motions of its own where none is named, and of every quantity.

    A quick benchmark runs up over half a turn and turns half a turn more: as much to see as in many turns, for less.
    """
    usual = () if options.swings else QUICK_REGIMES if options.quick else REGIMES
    options = replace(options, regime=options.regime or usual, quantity=())
    default = MotionOptions()
    times = (options.ramp_time, options.hold_time) == (default.ramp_time, default.hold_time)
    if options.quick and times and options.rpm and not options.swings:
        turn = 60.0 / abs(options.rpm)
        options = replace(options, ramp_time=turn, hold_time=0.5 * turn)
    return options


def _request(options: BenchOptions, asked: CampaignRequest) -> BenchRequest:
    every = tuple(cases(asked))
    quantities = tuple(dict.fromkeys(options.quantity)) or QUANTITIES
    for name in quantities:
        if name not in (*COMPARED, JOINTS):
            raise UnknownNameError("quantity", name, (*COMPARED, JOINTS))
    for case in every:
        found = chosen(case, quantities)
        if not found:
            raise LinkproofError(_nothing_to_measure(case, quantities))
        check_defined(case, [quantity for family in found.values() for quantity in family])
    return BenchRequest(every, asked.engines, quantities, extent=QUICK if options.quick else FULL)


def _nothing_to_measure(case: Case, quantities: Iterable[str]) -> str:
    return (
        f"none of {', '.join(quantities)} is a result of '{case.mechanism.linkage.name}' in regime "
        f"'{case.motion.regime}': ask for another quantity, or leave the regime out"
    )


def _document(options: BenchOptions, command: str, wanted: BenchRequest, measured: Measured) -> dict[str, Any]:
    """Everything of a finished benchmark, ready for JSON."""
    noise = measured.noise
    linkages = {case.mechanism.linkage.name: case.mechanism.linkage for case in wanted.cases}
    extent = {name: value for name, value in asdict(wanted.extent).items() if value != float("inf")}
    return {
        "command": command,
        "conditions": "; ".join(dict.fromkeys(case.conditions for case in wanted.cases)),
        "environment": {**environment(wanted.engines), **wanted.pool.place},
        "extent": extent,
        "noise": {"work": WORK, "samples": [round(one, 9) for one in noise.samples]},
        "first_use": [{"engine": name, "seconds": times} for name, times in measured.first_uses.items()],
        "mechanisms": [{"name": one.name, "title": one.title, "variant": one.variant} for one in linkages.values()],
        "methods": method_descriptions(wanted),
        "costs": _costs(list(linkages.values()), wanted.engines) if options.costs else [],
        "quantities": list(measured.quantities),
        "records": [point.data for point in measured.points],
    }


def _costs(linkages: Sequence[Linkage], engines: Sequence[str]) -> list[dict[str, Any]]:
    """What each output and load costs, in the linkage with most to leave out and the engines that are installed."""
    return [asdict(cost) for cost in costs.measure(costs.most_reducible(linkages), installed(engines))]
