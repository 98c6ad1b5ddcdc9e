"""From options to runs of engines: linkages, engines, limits, earlier results; every name is checked before any run."""

from __future__ import annotations

import json
import os
import shlex
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from analytic.description.changes import without
from analytic.description.linkage import Linkage
from analytic.description.loading import LinkageFile, catalogue, known_names, load, read
from analytic.errors import LinkproofError, UnknownNameError, printable, symbol
from comparisons.motion.case import Case
from comparisons.trials.campaign.campaign import CampaignRequest, each_case, tasks
from comparisons.trials.campaign.campaign import compare as run_campaign
from comparisons.trials.campaign.results import CampaignResults, checksum, document, judgement
from comparisons.trials.campaign.results import load as load_results
from comparisons.trials.campaign.standard import changes_since, closed_form
from comparisons.trials.exported_run import exported
from comparisons.trials.judging.changes import Change, read_rows
from comparisons.trials.judging.limits import LimitTable, check_named, read_limits, shipped_limits
from comparisons.trials.judging.quantities import QUANTITIES, check_defined
from comparisons.trials.judging.records import Error
from comparisons.trials.runs.cluster import DaskPool
from comparisons.trials.runs.environment import INCIDENTAL, environment
from comparisons.trials.runs.files import write_file
from comparisons.trials.runs.plugins import engines as adapters
from comparisons.trials.runs.run_engine import DEFAULT_BOUNDS, GIB, RunBounds
from comparisons.trials.runs.store import Runs, begin
from comparisons.trials.runs.workers import LocalPool, most_processes
from comparisons.trials.stress.campaign import Stress
from comparisons.trials.stress.campaign import stress as make_maps
from comparisons.trials.stress.cells import cells, chosen_axes, find_cell
from comparisons.trials.work_precision.study import FULL, JOINTS, QUICK, USUAL_QUANTITIES, BenchRequest, chosen_families
from comparisons.trials.work_precision.study import bench as measure_all
from comparisons.trials.work_precision.table import Bench
from engines.contract import Setting
from engines.registry import engine_names, why_unavailable
from reports.api.linkages import linkage_file, word_of
from reports.api.motions import EVERYTHING, requested_motions
from reports.api.options import Announce, LinkageLike, Motion, changed, command_line, words
from reports.api.options import Bounds as Asked
from reports.document.study import check_file
from reports.document.terminal import show
from reports.records import CONCURRENT_RUNS
from reports.studies.trials import Benchmark, Comparison, Script, StabilityMaps, Trials

Kept = TypeVar("Kept", bound=Trials)
DEEPEST_FOLDER = 5  # so many folders at most are put before equal names of files


def chosen_linkages(
    given: LinkageLike | Sequence[LinkageLike], motion: Motion
) -> tuple[tuple[Linkage, ...], tuple[LinkageFile, ...]]:
    """The linkages in the variant and under the gravity of a motion, and their files, in the order given, each once.

    By default they are the catalogue's that have the variant. Files of the same name get the names of their folders
    before their own, as many as are needed to differ. Raises LinkproofError where two names are the same, and for a
    linkage that cannot be read.
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
    return tuple(linkages), files


def _with_variant(names: Sequence[str], variant: str | None) -> tuple[str, ...]:
    """The names of linkages that have the variant; all of ``names`` for None, or if none has it."""
    return tuple(name for name in names if variant is None or variant in load(name).variants) or tuple(names)


def _told_apart(named: Sequence[LinkageLike], files: Sequence[LinkageFile]) -> tuple[LinkageFile, ...]:
    """The files in their order, those of one name renamed after up to five of their folders; some may stay equal.

    ``named`` are the linkages as they were given; only paths with a suffix have folders.
    """
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


def requested_engines(names: Sequence[str]) -> tuple[str, ...]:
    """The engines of these names, each once, all that can be used here where none is named.

    Raises LinkproofError for a named engine that cannot be used, UnknownNameError for an unknown one.
    """
    known = dict.fromkeys(names) or engine_names()
    absent = {name: why_unavailable(engine) for name, engine in zip(known, adapters(tuple(known)), strict=True)}
    for reason in filter(None, absent.values() if names else ()):
        raise LinkproofError(f"{reason}; or leave it out")
    return tuple(name for name in known if absent[name] is None)


def missing_engines(engines: Sequence[str]) -> str:
    """A remark that names the engines that are not installed, given the installed ones; "" where all are."""
    absent = [name for name in engine_names() if name not in engines]
    if not absent:
        return ""
    return f"not installed, left out: {', '.join(absent)} ('linkproof engines' says how to install them)"


def requested_settings(names: Sequence[str]) -> tuple[Setting, ...]:
    """The settings of these names, each once; tuned for no name, all for "all"; raises UnknownNameError for others."""
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
    """The runs of a comparison under ``motion``, of engines, settings and quantities by name; raises LinkproofError.

    It does so for unknown engines, settings and regimes and for an impossible motion; quantities are not checked. By
    default the engines are those installed, the setting is tuned, and all is compared. A linkage's own regimes run in
    the settings that are named; of all, in tuned alone, since they take many turns.
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


def run_bounds(bounds: Asked) -> RunBounds:
    """The time, s, and memory, bytes, that each run may take; by default the suite's.

    Raises LinkproofError for options that exclude each other, ``jobs`` and ``scheduler`` among them, and for a negative
    number of ``jobs``.
    """
    if bounds.jobs == 0 and (bounds.time_limit, bounds.memory_limit) != (None, None):
        raise LinkproofError(
            "--time-limit and --memory-limit apply to worker processes, but --jobs 0 starts none: leave one of the two "
            "out"
        )
    if bounds.jobs is not None and bounds.jobs < 0:
        raise LinkproofError(f"--jobs: expected a number of processes, or 0 for none, got {bounds.jobs}")
    if bounds.scheduler is not None and bounds.jobs is not None:
        raise LinkproofError("--jobs is about this machine, --scheduler about others: leave one of the two out")
    seconds = DEFAULT_BOUNDS.seconds if bounds.time_limit is None else bounds.time_limit
    memory = DEFAULT_BOUNDS.memory if bounds.memory_limit is None else round(bounds.memory_limit * GIB)
    return RunBounds(seconds, memory)


def processes(bounds: Asked) -> int:
    """The number of worker processes on this machine: by default one per core, for a single run, too; 0 for none."""
    return most_processes() if bounds.jobs is None else bounds.jobs


def worker_pool(bounds: Asked) -> LocalPool | DaskPool:
    """A new pool of worker processes, of this machine or of a Dask scheduler, for list after list of runs.

    The caller closes it. Its runs raise LinkproofError where there is no such scheduler.
    """
    return LocalPool(processes(bounds), lasts=True) if bounds.scheduler is None else DaskPool(bounds.scheduler)


# A study of runs: each run is kept in the folder of ``--out`` as soon as it is made.


def kept(
    kind: type[Kept],
    make: Callable[[Runs | None, Announce], Any],
    function: Callable[..., Any],
    given: Mapping[str, Any],
    *,
    engines: Sequence[str],
    linkages: Iterable[Linkage] = (),
    without: Sequence[str] = (),
) -> Kept:
    """The study, of a ``kind``, of what ``make`` makes for a call of ``function`` from the runs finished already.

    ``make`` gets the store of finished runs, None without a folder, and the function to announce runs by; ``given`` are
    the arguments of the call. Its folder, if it asks for one, keeps every run, and at last the study. Ctrl-C raises
    KeyboardInterrupt with the number of runs in the folder, and the command that finishes them. Options ``without`` a
    part in what is run may differ from those of the call that began them; ``engines`` and ``linkages`` may not. Raises
    LinkproofError for a folder that another command has or that cannot be used.

    Without an engine in the call, a remark names those that are not installed.
    """
    folder, remark = given["out"], "" if given["engine"] else missing_engines(engines)
    number = total = 0

    def announce(label: str, begun: int, count: int) -> None:
        """Pass an announcement, label, number and number of all, on; its numbers are kept for the message on Ctrl-C."""
        nonlocal number, total
        number, total = begun, count
        given["announce"](label, begun, count)

    if folder is None:
        return kind(make(None, announce), remark=remark)
    finished = _finished_runs(function, given, engines, linkages, without)
    try:
        kind(make(finished, announce)).store(folder)
    except KeyboardInterrupt as interrupt:
        if not total:
            raise
        raise KeyboardInterrupt(
            f"{number} of {total} runs are saved in {folder}: repeat the command, or linkproof {function.__name__} "
            f"--out {shlex.quote(str(folder))}, to finish"
        ) from interrupt
    finished.clear()
    return replace(kind.load(folder), remark=remark)


def _finished_runs(
    function: Callable[..., Any],
    given: Mapping[str, Any],
    engines: Sequence[str],
    linkages: Iterable[Linkage],
    without: Sequence[str],
) -> Runs:
    """The finished runs in the folder of the same request; those of another are removed, which is printed on stderr.

    Two requests are the same if the command, the linkage files, and the versions of linkproof, its libraries and the
    engines are equal, options ``without`` a part in what is run aside. Raises LinkproofError for a folder that another
    command has.
    """
    facts = {name: value for name, value in environment(()).items() if name not in INCIDENTAL}
    facts |= {f"engine {each.name}": each.version() or "not installed" for each in adapters(engines)}
    facts |= {f"file of {linkage.name}": checksum(linkage.text) for linkage in linkages}
    request = [command_line(function, given, without), *(f"{name} {value}" for name, value in facts.items())]
    arguments = json.dumps([function.__name__, changed(function, given)], default=str)
    finished, other = begin(given["out"], "\n".join(request), arguments)
    if other:
        show(f"what was unfinished in '{given['out']}' was another request ({other}): it is begun anew", stderr=True)
    return finished


# ``compare``: its runs, limits of the user's own, and earlier results.


def rows_before(place: Path) -> list[Error]:
    """The recorded rows of a CSV file or of a results folder's comparison; raises LinkproofError if unreadable."""
    return load_results(place).rows if os.path.isdir(place) else read_rows(place)


def chosen_limits(files: Sequence[LinkageFile], limits: Path | None) -> LimitTable:
    """The limits of a user's file before the suite's, or the suite's alone for None; raises LinkproofError.

    It does so for a file that cannot be read and for unknown names in it; those of ``files``, and of linkages beside
    them, are known.
    """
    if limits is None:
        return shipped_limits()
    chosen = read_limits(limits)
    names = [*(file.name for file in _with_neighbours(files)), *known_names()]
    check_named(chosen, lambda: names, lambda: [name for file in _with_neighbours(files) for name in _regimes(file)])
    return chosen


def _with_neighbours(named: Sequence[LinkageFile]) -> Iterator[LinkageFile]:
    """Yield the linkage files of a comparison and those in the same folders, which a limit may name as well."""
    yield from named
    for folder in dict.fromkeys(Path(file.origin).parent for file in named if not file.is_known):
        for path in sorted(folder.glob("*.toml")):
            with suppress(LinkproofError):  # another file of the folder need not be a linkage
                yield read(path)


def _regimes(file: LinkageFile) -> list[str]:
    """Names of the regimes that a linkage file defines in its own variant; [] if it cannot be read."""
    with suppress(LinkproofError):
        return [regime.name for regime in file.linkage().regimes]
    return []


def comparison(
    function: Callable[..., Any],
    given: Mapping[str, Any],
    linkages: tuple[Linkage, ...],
    files: Sequence[LinkageFile],
) -> Comparison:
    """Make and judge the runs that a call of ``function`` asks for, and return the study; runs are kept in its folder.

    ``given`` are its arguments by name, ``files`` those of ``linkages``. Raises LinkproofError for bad input before any
    run.
    """
    motion, bounds, command = given["motion"], run_bounds(given["bounds"]), command_line(function, given)
    asked = request(linkages, motion, given["engine"], given["setting"], given["quantity"])
    limits, todo, most = chosen_limits(files, given["limits"]), tasks(asked), processes(given["bounds"])
    before = None if given["against"] is None else rows_before(given["against"])
    every_variant = motion.variant is None and motion.gravity  # figures are those of all

    def make(finished: Runs | None, announce: Announce) -> CampaignResults:
        """The runs with their verdicts, and what has changed since the results before; makes those not ``finished``.

        ``announce`` gets each as it begins.
        """
        with closing(worker_pool(given["bounds"])) as pool:
            runs = run_campaign(asked, announce, bounds=bounds, pool=pool, finished=finished, todo=todo, limits=limits)
        figures, changes = closed_form(asked, every_variant=every_variant), tuple[Change, ...]()
        if before is not None:
            rows = (*(error for run in runs for error in run.every), *figures)
            changes = changes_since(before, rows, asked, every_variant=every_variant)
        readouts = {engine.name: engine.abilities.as_dict() for engine in adapters(asked.engines)}
        table = document(asked, command + (" --out DIR" if given["out"] else ""), readouts)
        if min(most, len(runs)) > 1:
            table["environment"][CONCURRENT_RUNS] = str(min(most, len(runs)))
        return CampaignResults(table | judgement(limits, figures, changes), runs)

    others = ("bounds", "limits", "against")
    result = kept(Comparison, make, function, given, engines=asked.engines, linkages=linkages, without=others)
    return replace(result, processes=most)


def script(asked: CampaignRequest, file: Path, command: str) -> Script:
    """Write a request's one run, in one engine and setting, to a file as a script; an empty comparison that says so.

    ``command`` is named in it. Raises LinkproofError for several runs, for a run that cannot be exported, and for a
    file that cannot be written.
    """
    check_file("--script", file)
    cases = list(each_case(asked))
    counts = (len(asked.linkages), len(asked.engines), len(cases), len(asked.settings))
    if counts != (1, 1, 1, 1):
        got = "{} mechanisms, {} engines, {} motions and {} settings".format(*counts)
        raise LinkproofError(
            f"--script writes one run, got {got}: name one MECHANISM, --engine, --regime and --setting"
        )
    write_file(file, exported(cases[0], asked.engines[0], asked.settings[0], command))
    return Script(CampaignResults(document(asked, command), ()), written=(file,))


# ``bench``: each quantity is checked before any run.

REGIMES, QUICK_REGIMES = ("run-up-quintic", "run-up"), ("run-up-quintic",)


def benchmark(function: Callable[..., Any], given: Mapping[str, Any], linkages: Sequence[Linkage]) -> Benchmark:
    """Make the measurements that a call of ``function`` asks for, and return the study.

    ``given`` are its arguments by name; its folder, if it names one, keeps the runs. Raises LinkproofError for bad
    input before any run.
    """
    runs = request(linkages, usual_motion(given["motion"], quick=given["quick"]), given["engine"])
    cases, extent = tuple(each_case(runs)), QUICK if given["quick"] else FULL
    quantities = measured_quantities(cases, given["quantity"])

    def make(finished: Runs | None, announce: Announce) -> Bench:
        """The measurements, those not ``finished`` made one run at a time; ``announce`` gets each as it begins."""
        with closing(LocalPool(1, lasts=True)) as pool:
            command = command_line(function, given)
            asked = BenchRequest(cases, runs.engines, quantities, extent=extent, pool=pool, command=command)
            return measure_all(asked, announce, finished)

    study = kept(Benchmark, make, function, given, engines=runs.engines, linkages=linkages)
    return replace(study, linkages=tuple(linkages))


def usual_motion(motion: Motion, *, quick: bool) -> Motion:
    """A copy of the motion, with the default regimes of a benchmark if it names none.

    A ``quick`` benchmark runs up over half a turn and turns half a turn more, which shows as much as many turns.
    """
    usual = () if motion.swings else QUICK_REGIMES if quick else REGIMES
    motion = replace(motion, regime=motion.regime or usual)
    if quick and not motion.is_timed and motion.rpm and not motion.swings:
        turn = 60.0 / abs(motion.rpm)
        motion = replace(motion, ramp_time=turn, hold_time=0.5 * turn)
    return motion


def measured_quantities(cases: Iterable[Case], named: Iterable[str]) -> tuple[str, ...]:
    """The quantities to measure, the usual ones if none is named, each once; raises LinkproofError.

    It does so for a case that has none of them or in which one is not defined, UnknownNameError for an unknown one.
    """
    quantities = tuple(dict.fromkeys(map(symbol, named))) or USUAL_QUANTITIES
    for name in quantities:
        if name not in (*QUANTITIES, JOINTS):
            raise UnknownNameError("quantity", name, (*QUANTITIES, JOINTS))
    for case in cases:
        groups = chosen_families(case, quantities)
        if not groups:
            raise LinkproofError(
                f"none of {', '.join(quantities)} is a result of '{case.mechanism.linkage.name}' in regime "
                f"'{case.motion.regime}': ask for another quantity, or leave the regime out"
            )
        check_defined(case, [quantity for family in groups.values() for quantity in family])
    return quantities


# ``stress``: maps, or single cells.


def stability_maps(function: Callable[..., Any], given: Mapping[str, Any]) -> StabilityMaps:
    """Make the maps, or the single cells, that the call of a ``function`` asks for, and return the study.

    ``given`` are its arguments by name, those of ``stress``. A folder keeps the runs of maps. Raises LinkproofError for
    bad input before any run: for axes and cells together, too, and for cells with an engine, a setting, ``quick`` or a
    folder.
    """
    if given["jobs"] is not None and given["jobs"] < 1:
        raise LinkproofError(
            f"--jobs: expected 1 or more worker processes, got {given['jobs']}; a cell may not run without one"
        )
    bounds, words, quick = Asked(jobs=given["jobs"], scheduler=given["scheduler"]), given["words"], given["quick"]
    run_bounds(bounds)
    command, named = command_line(function, given), [word for word in words if "/" in word]
    if named:
        if len(named) < len(words):
            raise LinkproofError(
                "expected either axes or cells (AXIS/ROW/VALUE/ENGINE/USAGE), got both; ask for one kind"
            )
        for option in ("engine", "setting", "quick", "out"):
            if given[option]:
                raise LinkproofError(f"--{option} takes whole maps: name axes, or leave it out")
        with closing(worker_pool(bounds)) as pool:
            made = make_maps([find_cell(name) for name in named], command, narrow=False, pool=pool)
        return StabilityMaps(made, are_cells=True)
    axes, engines = chosen_axes(words), requested_engines(given["engine"])
    chosen = cells(axes, engines, given["setting"], quick=quick)

    def make(finished: Runs | None, announce: Announce) -> Stress:
        """The maps of the chosen cells, those not ``finished`` made now; ``announce`` gets each as it begins."""
        with closing(worker_pool(bounds)) as pool:
            return make_maps(chosen, command, quick=quick, announce=announce, finished=finished, pool=pool)

    return replace(kept(StabilityMaps, make, function, given, engines=engines), processes=processes(bounds))
