"""What someone who writes or chooses an engine asks: signatures are the options of the command line.

Each function raises LinkproofError for bad input. ``announce`` gets the label of a run as it begins, its number and the
number of all.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from analytic.errors import LinkproofError
from reports.api.options import (
    Announce,
    Argument,
    Bounds,
    Engines,
    Mechanisms,
    Motion,
    Option,
    Out,
    Scheduler,
    changed,
    checked,
    command_line,
    silent,
    with_values,
    words,
)

if TYPE_CHECKING:
    from engines.contract import Engine
    from reports.document.study import Study
    from reports.studies.engines import EngineFindings
    from reports.studies.trials import Benchmark, Comparison, StabilityMaps


@checked
def engines(
    names: Annotated[Sequence[str], Argument("ENGINE", "engines")] = (),
    *,
    checks: Annotated[
        bool,
        Option(
            "Test the adapter of one engine: signs, frames, units, instants, failures as values, deliberate errors.",
            flags=("--check",),
        ),
    ] = False,
    tries: Annotated[
        bool,
        Option("Show what is installed, and try every engine and the compiler, for a bug report.", flags=("--try",)),
    ] = False,
) -> "Study":
    """List the engines, test an adapter, or try what is installed.

    The list has supported linkages, available quantities, and the origin of each figure in the engine.

    ENGINE is an engine of linkproof, or an adapter announced under the entry-point group linkproof.engines.

    Exit codes: 0; 1 a check failed, or something that is installed does not work; 2 nothing to check.

    >>> linkproof.engines("direct").to_dict()["records"][0]["settings"]
    ['naive', 'tuned', 'best']
    """
    if checks and tries:
        raise LinkproofError("--check and --try exclude each other: leave one of them out")
    if tries and names:
        raise LinkproofError("--try tries everything that is installed: leave the names of engines out")
    if checks and len(names) != 1:
        raise LinkproofError(f"--check tests one engine, got {len(names)}: linkproof engines NAME --check")
    if checks:
        return check_engine(names[0])
    if tries:
        start_workers("comparisons.trials.campaign.campaign")
    from reports.studies.engines import listed_engines, tried_engines

    return tried_engines() if tries else listed_engines(names)


def check_engine(engine: "Engine | str", jobs: int | None = None) -> "EngineFindings":
    """The results of every check of an adapter, given by its name or as an object, in ``jobs`` worker processes.

    By default there is one per core. Raises LinkproofError if there is nothing to check, or if the adapter cannot be
    loaded.

    >>> linkproof.check_engine("direct").check().checks[0].finding
    <Finding.PASSED: 'passed'>
    """
    start_workers("comparisons.trials.conformance.conformance")
    from reports.studies.engines import engine_findings

    return engine_findings(engine, jobs)


@checked
def compare(
    mechanisms: Mechanisms = (),
    motion: Motion = Motion(),
    *,
    engine: Engines = (),
    setting: Annotated[
        Sequence[str],
        Option("Engine settings to run: naive, tuned, best or all; default: tuned.", "NAME", names="settings"),
    ] = (),
    quantity: Annotated[
        Sequence[str], Option("Quantity, such as Mkr; repeatable; default: all.", "NAME", names="quantities")
    ] = (),
    limits: Annotated[str | Path | None, Option("Your limits, which precede the suite's.", "FILE")] = None,
    against: Annotated[
        str | Path | None,
        Option(
            "Compare with results that --record wrote or that are in a folder of --out: what newly fails, has grown "
            "threefold, has vanished or has changed fails.",
            "FILE|DIR",
        ),
    ] = None,
    record: Annotated[
        str | Path | None,
        Option(
            "Write errors, and figures of the closed form, into this CSV file for --against.",
            "FILE",
            affects_results=False,
        ),
    ] = None,
    junit: Annotated[
        str | Path | None,
        Option("Write every verdict as a test case, in JUnit's XML.", "FILE", affects_results=False),
    ] = None,
    script: Annotated[
        str | Path | None,
        Option("Run nothing; write one run as a script that needs only its engine and numpy.", "FILE"),
    ] = None,
    bounds: Bounds = Bounds(),
    out: Out = None,
    announce: Announce = silent,
) -> "Comparison":
    """Simulate mechanisms; compare every error with its limit.

    MECHANISM is a name in the catalogue or the path of a .toml file; default: the whole catalogue.

    The naive setting shows the engine without tuning; if other settings run too, its rows do not affect the exit code.
    An engine that crashes, hangs or runs out of memory fails in its own row only.

    --out DIR alone takes the study that is in DIR: the runs that are missing are made, a finished study only gets its
    pages again.

    Exit codes: 0 every error within its limit, 1 an error over its limit, a failed run, or a result that
    is not as it was recorded (--against), 2 bad input.

    In Python ``out`` is a folder in which every run is stored as soon as it is made; ``write`` of the result adds the
    pages. A run that fails is a record; bad input raises LinkproofError.

    >>> here = linkproof.Bounds(jobs=0)  # in this process
    >>> linkproof.compare("juki-mf7923d", engine="direct", quantity="torque", bounds=here).check().records[0].outcome
    'passed'
    """
    from reports.studies.trials import check_files

    check_files(record, junit)
    kept: Comparison | None = own_study(compare, {**locals(), "record": None, "junit": None}, "Comparison")
    if kept is not None:
        return kept.with_files(record, junit)
    if bounds.jobs != 0 and script is None:
        start_workers("comparisons.trials.campaign.campaign")
    from reports.api import campaign
    from reports.api.linkages import word_of

    if script is not None and (any((quantity, limits, against, record, junit, out)) or bounds != Bounds()):
        raise LinkproofError(
            "--script runs nothing: leave out every option but those of the engine, setting and motion"
        )
    linkages, files = campaign.chosen_linkages(mechanisms, motion)
    mechanisms = tuple(map(word_of, words(mechanisms)))
    if script is not None:
        request = campaign.request(linkages, motion, engine, setting)
        return campaign.script(request, Path(script), command_line(compare, locals()))
    return campaign.comparison(compare, locals(), linkages, files).with_files(record, junit)


@checked
def bench(
    mechanisms: Mechanisms = (),
    motion: Motion = Motion(),
    *,
    engine: Engines = (),
    quantity: Annotated[
        Sequence[str],
        Option("Quantity; repeatable; default: Mkr, Jeq, phi, joint_force.", "NAME", names="quantities"),
    ] = (),
    quick: Annotated[bool, Option("Measure only the fronts, over one turn, in under a minute.")] = False,
    out: Out = None,
    announce: Announce = silent,
) -> "Benchmark":
    """Measure error against run time, over a sweep of steps.

    Every engine, setting and method is measured.

    MECHANISM is a name in the catalogue or the path of a .toml file; default: the whole catalogue.

    --out DIR alone takes the benchmark that is in DIR.

    Runs are made one at a time. Do not use the machine for anything else, or the times become wrong.

    In Python ``out`` is as in ``compare``; errors are shares of the peak, times are in s.

    >>> linkproof.bench("juki-mf7923d", engine="direct", quick=True).to_pandas()["engine"].unique().tolist()
    ['direct']
    """
    kept: Benchmark | None = own_study(bench, locals(), "Benchmark")
    if kept is not None:
        return kept
    start_workers("comparisons.trials.work_precision.study")
    from reports.api.campaign import benchmark, chosen_linkages
    from reports.api.linkages import word_of

    linkages, _ = chosen_linkages(mechanisms, motion)
    mechanisms = tuple(map(word_of, words(mechanisms)))
    return benchmark(bench, locals(), linkages)


@checked
def stress(
    words: Annotated[Sequence[str], Argument("AXIS|CELL", "axes")] = (),
    *,
    engine: Engines = (),
    setting: Annotated[
        Sequence[str],
        Option("A setting or a fixed-step method; repeatable; default: those of each map.", "NAME", names="settings"),
    ] = (),
    quick: Annotated[bool, Option("Fewer cells, coarser borders: about a minute.")] = False,
    jobs: Annotated[int | None, Option("Worker processes; default: one per core.", "N", affects_results=False)] = None,
    scheduler: Scheduler = None,
    out: Out = None,
    announce: Announce = silent,
) -> "StabilityMaps":
    """Find conditions under which each engine fails.

    The maps also show whether the checks detect a failure.

    AXIS is a stability map; CELL is one run of a map, AXIS/ROW/VALUE/ENGINE/USAGE; default: every map.

    --out DIR alone takes the maps that are in DIR.

    Exit code 1: an engine reported success with a wrong motion, and no check detected it.

    In Python ``out`` is as in ``compare``.

    >>> linkproof.stress("start/positions/1e-08/direct/tuned")
    <StabilityMaps: 1 cells: 1 within limit>
    """
    kept: StabilityMaps | None = own_study(stress, locals(), "StabilityMaps")
    if kept is not None:
        return kept
    start_workers("comparisons.trials.stress.cells")
    from reports.api.campaign import stability_maps

    return stability_maps(stress, locals())


def own_study(function: Callable[..., Any], given: Mapping[str, Any], study: str) -> Any:  # noqa: ANN401 - of each its own
    """The study that is in the folder ``out``, finished if it was not; None where another one is asked for.

    ``given`` are the arguments of the ``function``'s call, ``study`` is the name of the class of what it returns. The
    folder is only read if nothing else is given that affects the results; an unfinished study of the function is made
    by calling it. Raises LinkproofError for a damaged one.
    """
    folder, name = given["out"], function.__name__
    if folder is None or changed(function, given):
        return None
    from comparisons.trials.runs.store import has_study, unfinished_command

    try:
        begun, values = json.loads(unfinished_command(folder) or "[null, {}]")
        arguments = with_values(function, given, values) if begun == name and values else None
    except (ValueError, TypeError, AttributeError, RecursionError) as error:
        raise LinkproofError(f"'{folder}' has a damaged command ({error}): type the whole command") from error
    if arguments is not None:
        return function(**arguments)
    if begun != name and has_study(folder, name):
        from reports.studies import trials

        return getattr(trials, study).load(folder)
    return None


def start_workers(module: str) -> None:
    """Start the process that forks workers and imports a module, while this process imports the rest.

    Nothing is done where there are no worker processes.
    """
    from comparisons.trials.runs.workers import most_processes

    if most_processes():
        from comparisons.trials.runs.worker_process import start_server

        start_server([module])
