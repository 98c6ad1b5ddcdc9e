"""From options to a campaign: linkages, engines, limits, earlier results; every name is checked before any run."""

from __future__ import annotations

import math
import os
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from analytic.description.changes import without
from analytic.description.linkage import Linkage
from analytic.description.loading import LinkageFile, catalogue, known_names, load, read
from analytic.errors import LinkproofError, UnknownNameError, printable, symbol
from comparisons.trials.campaign.campaign import CampaignRequest, tasks
from comparisons.trials.campaign.campaign import compare as run_campaign
from comparisons.trials.campaign.results import document
from comparisons.trials.campaign.results import load as load_results
from comparisons.trials.campaign.standard import JudgedCampaign
from comparisons.trials.judging.changes import read_rows
from comparisons.trials.judging.limits import LimitTable, check_named, read_limits, shipped_limits
from comparisons.trials.judging.records import Error
from comparisons.trials.runs.cluster import DaskPool
from comparisons.trials.runs.files import check_writable
from comparisons.trials.runs.plugins import engines
from comparisons.trials.runs.plugins import engines as adapters
from comparisons.trials.runs.run_engine import DEFAULT_BOUNDS, GIB, Bounds
from comparisons.trials.runs.study import Task
from comparisons.trials.runs.workers import LocalPool, Pool, most_processes
from engines.contract import Setting
from engines.registry import engine_names, why_unavailable
from reports.api.motions import EVERYTHING, requested_motions
from reports.api.options import CompareOptions, RunLimits, RunsOptions, StandardOptions, command_line
from reports.records import CONCURRENT_RUNS

DEEPEST_FOLDER = 5  # so many folders at most are put before equal names of files


def files(options: RunsOptions) -> list[LinkageFile]:
    """The files of the requested linkages; by default all of the catalogue that have the variant.

    Files of the same name get the names of their folders before their own, as many as are needed to differ.
    """
    names = tuple(dict.fromkeys(options.mechanisms or with_variant(catalogue(), options.variant)))
    linkage_files = [read(name) for name in names]
    file_names = [file.name for file in linkage_files]
    for depth in range(1, DEEPEST_FOLDER + 1):
        counts = Counter(file.name for file in linkage_files)
        linkage_files = [
            replace(file, name=printable("-".join((*Path(path).resolve().parent.parts[-depth:], name))))
            if counts[file.name] > 1 and Path(path).suffix
            else file
            for path, name, file in zip(names, file_names, linkage_files, strict=True)
        ]
    return linkage_files


def with_variant(names: Sequence[str], variant: str | None) -> tuple[str, ...]:
    """The names of the linkages that have a variant; all names if none has it or ``variant`` is None."""
    return tuple(name for name in names if variant is None or variant in load(name).variants) or tuple(names)


def linkages(options: RunsOptions) -> tuple[Linkage, ...]:
    """The linkages of ``files``, in the requested variant and under the requested gravity."""
    chosen = [file.linkage(options.variant) for file in files(options)]
    _check_names_differ(chosen)
    return tuple(chosen if options.gravity else [without(linkage, "gravity") for linkage in chosen])


def _check_names_differ(chosen: list[Linkage]) -> None:
    seen: set[str] = set()
    for linkage in chosen:
        if linkage.name in seen:
            raise LinkproofError(f"two linkage files are both called '{linkage.name}': rename one of them")
        seen.add(linkage.name)


def installed(engines: Sequence[str]) -> list[str]:
    """The installed engines among these."""
    return [name for name, engine in zip(engines, adapters(engines), strict=True) if why_unavailable(engine) is None]


def missing_engines(engines: Sequence[str]) -> str:
    """A remark that names the engines which are not among the installed ``engines``; empty where all are."""
    absent = [name for name in engine_names() if name not in engines]
    if not absent:
        return ""
    return f"not installed, left out: {', '.join(absent)} ('linkproof engines' says how to install them)"


def named(engines: Sequence[str]) -> tuple[str, ...]:
    """Named engines, each once; raises LinkproofError for an engine that cannot be used here."""
    for adapter in adapters(engines):
        absent = why_unavailable(adapter)
        if absent is not None:
            raise LinkproofError(f"{absent}; or leave it out")
    return tuple(dict.fromkeys(engines))


def requested_engines(names: Sequence[str]) -> tuple[str, ...]:
    """The engines of these names, all that are installed where none is named.

    Raises LinkproofError for a named engine that cannot be used.
    """
    return named(names) or tuple(installed(engine_names()))


def _requested_settings(options: RunsOptions) -> tuple[Setting, ...]:
    if EVERYTHING in options.setting:
        return tuple(Setting)
    for name in options.setting:
        if name not in list(Setting):
            raise UnknownNameError("setting", name, [*Setting, EVERYTHING])
    return tuple(Setting(name) for name in dict.fromkeys(options.setting)) or (Setting.TUNED,)


def _own_settings(options: RunsOptions) -> tuple[Setting, ...]:
    """Settings of the linkages' own regimes: those named; of all, tuned alone unless ``full``."""
    is_full = isinstance(options, CompareOptions) and options.full
    return _requested_settings(options) if is_full or EVERYTHING not in options.setting else (Setting.TUNED,)


def request(options: RunsOptions) -> CampaignRequest:
    """The campaign's request; raises LinkproofError for bad input."""
    result = linkages(options)
    motions, conditions, own_regimes = requested_motions(options, result)
    return CampaignRequest(
        linkages=result,
        motions=motions,
        conditions=conditions,
        engines=requested_engines(options.engine),
        settings=_requested_settings(options),
        quantities=tuple(dict.fromkeys(map(symbol, options.quantity))),
        own_regimes=own_regimes,
        own_settings=_own_settings(options),
        with_invariants=not options.quantity,
    )


# The worker processes of runs, and the time and memory that each may use.


@dataclass(frozen=True)
class RunResources:
    """The ``bounds`` of each run, and the number of worker ``processes``."""

    bounds: Bounds
    processes: int
    scheduler: str | None = None

    @property
    def pool(self) -> Pool:
        """The worker processes, of this machine or of a Dask scheduler."""
        return LocalPool(self.processes) if self.scheduler is None else DaskPool(self.scheduler)

    @property
    def lasting_pool(self) -> LocalPool | DaskPool:
        """The same for list after list of runs."""
        return LocalPool(self.processes, lasts=True) if self.scheduler is None else DaskPool(self.scheduler)


def run_resources(limits: RunLimits) -> RunResources:
    """The bounds and the worker processes of runs; raises LinkproofError for bad input.

    By default there are as many worker processes as cores; a single run has a process of its own, too.
    """
    for option, value, unit in (
        ("--time-limit", limits.time_limit, "s"),
        ("--memory-limit", limits.memory_limit, "GiB"),
    ):
        if value is not None and not 0.0 < value < math.inf:
            raise LinkproofError(f"{option}: expected a positive finite number of {unit}, got {value:g}")
        if value is not None and limits.jobs == 0:
            raise LinkproofError(
                f"{option} applies to worker processes, but --jobs 0 starts none: leave one of the two out"
            )
    if limits.jobs is not None and limits.jobs < 0:
        raise LinkproofError(f"--jobs: expected a number of processes, or 0 for none, got {limits.jobs}")
    seconds = DEFAULT_BOUNDS.seconds if limits.time_limit is None else limits.time_limit
    memory = DEFAULT_BOUNDS.memory if limits.memory_limit is None else round(limits.memory_limit * GIB)
    if limits.scheduler is not None and limits.jobs is not None:
        raise LinkproofError("--jobs is about this machine, --scheduler about others: leave one of the two out")
    return RunResources(
        Bounds(seconds, memory), most_processes() if limits.jobs is None else limits.jobs, limits.scheduler
    )


# ``compare``: its runs, limits of the user's own, and earlier results.


def check_record(file: Path | None) -> None:
    """Raise LinkproofError where results are to be recorded and cannot be."""
    if file is not None and file.suffix.lower() != ".csv":
        raise LinkproofError(f"--record {file}: the suffix must be .csv; rename the file")
    if file is not None:
        check_writable(file)


def rows_before(place: Path) -> list[Error]:
    """The rows of a file, or of the comparison in a results folder; raises LinkproofError for anything else."""
    return load_results(place).rows if os.path.isdir(place) else read_rows(place)


def chosen_limits(options: CompareOptions, limits: Path | None) -> LimitTable:
    """The limits for results; raises LinkproofError for unknown names in them."""
    if limits is None:
        return shipped_limits()
    chosen, read_files = read_limits(limits), files(options)

    def known() -> Iterator[LinkageFile]:
        yield from read_files
        yield from _neighbours(read_files)

    check_named(chosen, lambda: _mechanism_names(known()), lambda: _regime_names(known()))
    return chosen


def _neighbours(named: list[LinkageFile]) -> Iterator[LinkageFile]:
    """The linkages in the same folders, which a limit may name, too."""
    for folder in dict.fromkeys(Path(file.origin).parent for file in named if not file.is_known):
        for path in sorted(folder.glob("*.toml")):
            with suppress(LinkproofError):  # another file of the folder need not be a linkage
                yield read(path)


def _mechanism_names(known: Iterable[LinkageFile]) -> list[str]:
    return [*(file.name for file in known), *known_names()]


def _regime_names(known: Iterable[LinkageFile]) -> list[str]:
    names = []
    for file in known:
        with suppress(LinkproofError):
            names += [regime.name for regime in file.linkage().regimes]
    return names


DEFAULT_STANDARD, DEFAULT_LIMITS = StandardOptions(), RunLimits()


@dataclass(frozen=True)
class Campaign:
    """A campaign whose names are all known.

    ``command`` repeats it, ``saved_command`` with its limits and bounds. ``before`` are the rows that its results are
    compared with. ``every_variant``: no variant is chosen, so that figures are those of all.
    """

    request: CampaignRequest
    limits: LimitTable
    resources: RunResources
    command: str
    saved_command: str
    before: Sequence[Error] | None
    every_variant: bool

    def compared(self, pool: Pool, **how: Any) -> JudgedCampaign:  # noqa: ANN401 - announce and journal of a campaign
        """Make the runs in a pool and judge them."""
        bounds = self.resources.bounds
        runs = run_campaign(self.request, bounds=bounds, pool=pool, todo=self.tasks, limits=self.limits, **how)
        runs.make()
        return JudgedCampaign(self.request, self.limits, runs, self.before, self.every_variant)

    @cached_property
    def tasks(self) -> Sequence[Task]:
        """Its runs; raises LinkproofError for what cannot run."""
        return tasks(self.request)

    @property
    def environment(self) -> dict[str, str]:
        """How many runs are made side by side, where they are."""
        count = min(self.resources.processes, len(self.tasks))
        return {CONCURRENT_RUNS: str(count)} if count > 1 else {}

    def document(self, judged: JudgedCampaign, *, is_saved: bool = False) -> dict[str, Any]:
        """Everything of the judged campaign but its runs, JSON-ready."""
        readouts = {engine.name: engine.abilities.as_dict() for engine in engines(self.request.engines)}
        command = self.saved_command + (" --out DIR" if is_saved else "")
        table = document(self.request, command, readouts)
        return {**table, **judged.as_dict, "environment": table["environment"] | self.environment}


def campaign(
    options: CompareOptions, standard: StandardOptions = DEFAULT_STANDARD, limits: RunLimits = DEFAULT_LIMITS
) -> Campaign:
    """The campaign of a request; raises LinkproofError for bad input, before any run."""
    check_record(standard.record)
    return Campaign(
        request(options),
        chosen_limits(options, standard.limits),
        run_resources(limits),
        command_line("compare", options),
        command_line("compare", options, standard, limits),
        None if standard.against is None else rows_before(standard.against),
        options.variant is None and options.gravity,
    )
