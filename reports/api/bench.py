"""``bench``: from options to the benchmark of engines, each quantity checked before any run."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from typing import Any

from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, UnknownNameError, symbol
from comparisons.motion.case import Case
from comparisons.trials.campaign.campaign import each_case
from comparisons.trials.judging.quantities import QUANTITIES as COMPARED
from comparisons.trials.judging.quantities import check_defined
from comparisons.trials.runs.workers import LocalPool
from comparisons.trials.work_precision.measure import JOINTS, chosen_families
from comparisons.trials.work_precision.study import FULL, QUANTITIES, QUICK, BenchRequest
from comparisons.trials.work_precision.study import bench as measure_all
from comparisons.trials.work_precision.table import save
from reports.api.campaign import missing_engines, request
from reports.api.folders import stored_runs
from reports.api.options import Motion
from reports.studies.trials import Benchmark

REGIMES, QUICK_REGIMES = ("run-up-quintic", "run-up"), ("run-up-quintic",)


def benchmark(
    function: Callable[..., Any], given: Mapping[str, Any], linkages: Sequence[Linkage], command: str
) -> Benchmark:
    """Make the measurements that a call of ``function`` asks for; its folder keeps runs, ``command`` repeats it."""
    runs = request(linkages, usual_motion(given["motion"], quick=given["quick"]), given["engine"])
    cases, folder = tuple(each_case(runs)), given["out"]
    quantities = measured_quantities(cases, given["quantity"])
    extent = QUICK if given["quick"] else FULL
    with (
        closing(LocalPool(1, lasts=True)) as pool,
        stored_runs(function, given, runs.engines, linkages) as (finished, announce),
    ):
        asked = BenchRequest(cases, runs.engines, quantities, extent=extent, pool=pool, command=command)
        measured = measure_all(asked, announce, finished)
        if folder is not None:
            save(folder, measured)
    return Benchmark(measured, folder=folder, remark="" if given["engine"] else missing_engines(runs.engines))


def usual_motion(motion: Motion, *, quick: bool) -> Motion:
    """The motion, with the default regimes if it names none.

    A quick benchmark runs up over half a turn and turns half a turn more, which shows as much as many turns.
    """
    usual = () if motion.swings else QUICK_REGIMES if quick else REGIMES
    motion = replace(motion, regime=motion.regime or usual)
    if quick and not motion.is_timed and motion.rpm and not motion.swings:
        turn = 60.0 / abs(motion.rpm)
        motion = replace(motion, ramp_time=turn, hold_time=0.5 * turn)
    return motion


def measured_quantities(cases: Iterable[Case], named: Iterable[str]) -> tuple[str, ...]:
    """The quantities to measure; raises LinkproofError for one that a case does not have."""
    quantities = tuple(dict.fromkeys(map(symbol, named))) or QUANTITIES
    for name in quantities:
        if name not in (*COMPARED, JOINTS):
            raise UnknownNameError("quantity", name, (*COMPARED, JOINTS))
    for case in cases:
        groups = chosen_families(case, quantities)
        if not groups:
            raise LinkproofError(
                f"none of {', '.join(quantities)} is a result of '{case.mechanism.linkage.name}' in regime "
                f"'{case.motion.regime}': ask for another quantity, or leave the regime out"
            )
        check_defined(case, [quantity for family in groups.values() for quantity in family])
    return quantities
