"""From options to runs of engines: linkages, engines, limits, earlier results; every name is checked before any run."""

from __future__ import annotations

import math
import os
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

from analytic.description.changes import without
from analytic.description.linkage import Linkage
from analytic.description.loading import LinkageFile, catalogue, known_names, load, read
from analytic.errors import LinkproofError, UnknownNameError, printable, symbol
from comparisons.trials.campaign.campaign import CampaignRequest, each_case, tasks
from comparisons.trials.campaign.campaign import compare as run_campaign
from comparisons.trials.campaign.results import CampaignResults, document, judgement, save
from comparisons.trials.campaign.results import load as load_results
from comparisons.trials.campaign.standard import changes_since, closed_form
from comparisons.trials.exported_run import exported
from comparisons.trials.judging.changes import Change, read_rows
from comparisons.trials.judging.limits import LimitTable, check_named, read_limits, shipped_limits
from comparisons.trials.judging.records import Error
from comparisons.trials.runs.cluster import DaskPool
from comparisons.trials.runs.files import write_file
from comparisons.trials.runs.plugins import engines as adapters
from comparisons.trials.runs.run_engine import DEFAULT_BOUNDS, GIB, RunBounds
from comparisons.trials.runs.workers import LocalPool, most_processes
from engines.contract import Setting
from engines.registry import engine_names, why_unavailable
from reports.api.folders import stored_runs
from reports.api.linkages import linkage_file, word_of
from reports.api.motions import EVERYTHING, requested_motions
from reports.api.options import Bounds as Asked
from reports.api.options import LinkageLike, Motion, words
from reports.document.study import check_file
from reports.records import CONCURRENT_RUNS
from reports.studies.trials import Comparison, Script

DEEPEST_FOLDER = 5  # so many folders at most are put before equal names of files


class Chosen(NamedTuple):
    """The linkages of runs with their files, and the words by which a command names them; none for all."""

    linkages: tuple[Linkage, ...]
    files: tuple[LinkageFile, ...]
    words: tuple[str, ...]


def chosen_linkages(given: LinkageLike | Sequence[LinkageLike], motion: Motion) -> Chosen:
    """The linkages in the variant and under the gravity of a motion; by default the catalogue's that have the variant.

    Files of the same name get the names of their folders before their own, as many as are needed to differ. Raises
    LinkproofError where two names are the same.
    """
    named = tuple({word_of(each): each for each in words(given) or _with_variant(catalogue(), motion.variant)}.values())
    files = _told_apart(named, [linkage_file(each) for each in named])
    variants = [each.variant if isinstance(each, Linkage) and motion.variant is None else None for each in named]
    linkages = [file.linkage(variant or motion.variant) for file, variant in zip(files, variants, strict=True)]
    (name, count), *_ = Counter(linkage.name for linkage in linkages).most_common(1)
    if count > 1:
        raise LinkproofError(f"two linkage files are both called '{name}': rename one of them")
    if not motion.gravity:
        linkages = [without(linkage, "gravity") for linkage in linkages]
    return Chosen(tuple(linkages), files, tuple(map(word_of, words(given))))


def _with_variant(names: Sequence[str], variant: str | None) -> tuple[str, ...]:
    """The names of linkages that have the variant; all names for None, or if none has it."""
    return tuple(name for name in names if variant is None or variant in load(name).variants) or tuple(names)


def _told_apart(named: Sequence[LinkageLike], files: Sequence[LinkageFile]) -> tuple[LinkageFile, ...]:
    """The files, those of one name renamed after their folders; raises LinkproofError where they stay equal."""
    names = [file.name for file in files]
    for depth in range(1, DEEPEST_FOLDER + 1):
        counts = Counter(file.name for file in files)
        files = [
            replace(file, name=printable("-".join((*Path(path).resolve().parent.parts[-depth:], name))))
            if counts[file.name] > 1 and isinstance(path, str | Path) and Path(path).suffix
            else file
            for path, name, file in zip(named, names, files, strict=True)
        ]
    return tuple(files)


def installed(engines: Sequence[str]) -> list[str]:
    """Those of these engines that can be used here."""
    return [name for name, engine in zip(engines, adapters(engines), strict=True) if why_unavailable(engine) is None]


def missing_engines(engines: Sequence[str]) -> str:
    """A remark that names the engines that are not installed, given the installed ones; "" where all are."""
    absent = [name for name in engine_names() if name not in engines]
    if not absent:
        return ""
    return f"not installed, left out: {', '.join(absent)} ('linkproof engines' says how to install them)"


def named(engines: Sequence[str]) -> tuple[str, ...]:
    """The named engines, each once; raises LinkproofError for one that cannot be used here."""
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


def requested_settings(names: Sequence[str]) -> tuple[Setting, ...]:
    """The settings of these names, each once; tuned for no name, all for "all". Raises UnknownNameError."""
    if EVERYTHING in names:
        return tuple(Setting)
    for name in names:
        if name not in list(Setting):
            raise UnknownNameError("setting", name, [*Setting, EVERYTHING])
    return tuple(Setting(name) for name in dict.fromkeys(names)) or (Setting.TUNED,)


def request(
    linkages: Sequence[Linkage],
    motion: Motion,
    engine: Sequence[str] = (),
    setting: Sequence[str] = (),
    quantity: Sequence[str] = (),
) -> CampaignRequest:
    """The runs of a comparison; raises LinkproofError for bad input.

    A linkage's own regimes run in the settings that are named; of all, in tuned alone, since they take many turns.
    """
    motions, conditions, own_regimes = requested_motions(motion, linkages)
    settings = requested_settings(setting)
    return CampaignRequest(
        linkages=tuple(linkages),
        motions=motions,
        conditions=conditions,
        engines=requested_engines(engine),
        settings=settings,
        quantities=tuple(dict.fromkeys(map(symbol, quantity))),
        own_regimes=own_regimes,
        own_settings=(Setting.TUNED,) if EVERYTHING in setting else settings,
        with_invariants=not quantity,
    )


# The worker processes of runs, and the time and memory that each may use.


@dataclass(frozen=True)
class RunResources:
    """The ``bounds`` of each run, and the number of worker ``processes``."""

    bounds: RunBounds
    processes: int
    scheduler: str | None = None

    @property
    def pool(self) -> LocalPool | DaskPool:
        """The worker processes, of this machine or of a Dask scheduler, for list after list of runs."""
        return LocalPool(self.processes, lasts=True) if self.scheduler is None else DaskPool(self.scheduler)


def run_resources(bounds: Asked) -> RunResources:
    """The bounds and the worker processes of runs; raises LinkproofError for bad input.

    By default there are as many worker processes as cores; a single run has a process of its own, too.
    """
    for option, value, unit in (
        ("--time-limit", bounds.time_limit, "s"),
        ("--memory-limit", bounds.memory_limit, "GiB"),
    ):
        if value is not None and not 0.0 < value < math.inf:
            raise LinkproofError(f"{option}: expected a positive finite number of {unit}, got {value:g}")
        if value is not None and bounds.jobs == 0:
            raise LinkproofError(
                f"{option} applies to worker processes, but --jobs 0 starts none: leave one of the two out"
            )
    if bounds.jobs is not None and bounds.jobs < 0:
        raise LinkproofError(f"--jobs: expected a number of processes, or 0 for none, got {bounds.jobs}")
    seconds = DEFAULT_BOUNDS.seconds if bounds.time_limit is None else bounds.time_limit
    memory = DEFAULT_BOUNDS.memory if bounds.memory_limit is None else round(bounds.memory_limit * GIB)
    if bounds.scheduler is not None and bounds.jobs is not None:
        raise LinkproofError("--jobs is about this machine, --scheduler about others: leave one of the two out")
    return RunResources(
        RunBounds(seconds, memory), most_processes() if bounds.jobs is None else bounds.jobs, bounds.scheduler
    )


# ``compare``: its runs, limits of the user's own, and earlier results.


def rows_before(place: Path) -> list[Error]:
    """The recorded rows of a CSV file or of a results folder's comparison; raises LinkproofError."""
    return load_results(place).rows if os.path.isdir(place) else read_rows(place)


def chosen_limits(files: Sequence[LinkageFile], limits: Path | None) -> LimitTable:
    """The limits of a user's file before the suite's, or the suite's alone; raises LinkproofError for unknown names."""
    if limits is None:
        return shipped_limits()
    chosen = read_limits(limits)
    names = [*(file.name for file in _with_neighbours(files)), *known_names()]
    check_named(chosen, lambda: names, lambda: [name for file in _with_neighbours(files) for name in _regimes(file)])
    return chosen


def _with_neighbours(named: Sequence[LinkageFile]) -> Iterator[LinkageFile]:
    """The linkage files of a comparison and those in the same folders, which a limit may name as well."""
    yield from named
    for folder in dict.fromkeys(Path(file.origin).parent for file in named if not file.is_known):
        for path in sorted(folder.glob("*.toml")):
            with suppress(LinkproofError):  # another file of the folder need not be a linkage
                yield read(path)


def _regimes(file: LinkageFile) -> list[str]:
    """Names of the regimes that a linkage file defines; none if it cannot be read."""
    with suppress(LinkproofError):
        return [regime.name for regime in file.linkage().regimes]
    return []


def comparison(function: Callable[..., Any], given: Mapping[str, Any], chosen: Chosen, command: str) -> Comparison:
    """Make and judge the runs that a call of ``function`` asks for; runs are kept in its folder.

    ``command`` repeats it. Raises LinkproofError for bad input before any run.
    """
    motion, folder, resources = given["motion"], given["out"], run_resources(given["bounds"])
    asked = request(chosen.linkages, motion, given["engine"], given["setting"], given["quantity"])
    limits, todo = chosen_limits(chosen.files, given["limits"]), tasks(asked)
    before = None if given["against"] is None else rows_before(given["against"])
    every_variant = motion.variant is None and motion.gravity  # figures are those of all
    others = ("bounds", "limits", "against")
    with stored_runs(function, given, asked.engines, asked.linkages, others) as (finished, announce):
        with closing(resources.pool) as pool:
            runs = run_campaign(
                asked, announce, bounds=resources.bounds, pool=pool, finished=finished, todo=todo, limits=limits
            )
        figures, changed = closed_form(asked, every_variant=every_variant), tuple[Change, ...]()
        if before is not None:
            rows = (*(error for run in runs for error in run.every), *figures)
            changed = changes_since(before, rows, asked, every_variant=every_variant)
        readouts = {engine.name: engine.abilities.as_dict() for engine in adapters(asked.engines)}
        table = document(asked, command + (" --out DIR" if folder else ""), readouts)
        if min(resources.processes, len(runs)) > 1:
            table["environment"][CONCURRENT_RUNS] = str(min(resources.processes, len(runs)))
        table |= judgement(limits, figures, changed)
        if folder is not None:
            save(folder, table, runs)
    remark = "" if given["engine"] else missing_engines(asked.engines)
    result = Comparison(CampaignResults(table, runs)) if folder is None else Comparison.load(folder)
    return replace(result, processes=resources.processes, remark=remark)


def script(asked: CampaignRequest, file: Path, command: str) -> Script:
    """Write a request's one run, in one engine and setting, as a script; a comparison of which nothing was run.

    Raises LinkproofError for several runs, and for a run that cannot be exported.
    """
    check_file("--script", file)
    if (len(asked.linkages), len(asked.engines)) != (1, 1):
        raise LinkproofError(
            f"--script writes one run, got {len(asked.linkages)} mechanisms and {len(asked.engines)} engines: "
            "name one MECHANISM and one --engine"
        )
    cases, settings = list(each_case(asked)), asked.settings
    if len(cases) != 1 or len(settings) != 1:
        raise LinkproofError(
            f"--script writes one run, got {len(cases)} motions and {len(settings)} settings: name one --regime and "
            "one --setting"
        )
    write_file(file, exported(cases[0], asked.engines[0], settings[0], command))
    return Script(CampaignResults(document(asked, command), ()), written=(file,))
