"""The commands and their options: ``linkproof list | check | results | compare | bench | …``.

Only typer is imported here; a command imports the rest when it runs, so that help appears at once.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reports.command_line.parameters import CommandGroup, command
from reports.requests.options import (
    NOT_STEADY,
    Argument,
    BenchOptions,
    CompareOptions,
    Jobs,
    Json,
    JudgeOptions,
    OptimiseOptions,
    Option,
    OutputOptions,
    ResultsFiles,
    ResultsOptions,
    RunLimits,
    Scheduler,
    StandardOptions,
    StressOptions,
    SweepOptions,
    ToleranceOptions,
    Variant,
    WatchOptions,
)

if TYPE_CHECKING:
    from reports.command_line.destination import Destination


app = typer.Typer(
    name="linkproof",
    cls=CommandGroup,
    help="Torque, power and bearing forces of planar linkages, exactly; errors of simulations, and their cost.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

Mechanism = Annotated[str, Argument("MECHANISM", "mechanisms")]
Quiet = Annotated[bool, Option("No progress and no tables, only the closing line.", flags=("-q", "--quiet"))]
Strict = Annotated[bool, Option("Refuse a file with likely mistakes: units, masses, load tables.")]


def destination(output: OutputOptions) -> Destination:
    """The writer and printer for the options of output."""
    from reports.command_line.destination import Destination

    return Destination(**vars(output))


def _own_study(command: str, output: OutputOptions, *bags: Any) -> tuple[bool, Any]:  # noqa: ANN401 - dataclasses
    """Whether the study in the folder of ``output`` is asked for and finished; the options of what is to be run."""
    if output.out is None:
        return False, bags
    from reports.command_line.destination import own_study

    return own_study(app, command, output.out, bags)


def _start_workers(module: str) -> None:
    """Start the process that forks workers, which imports a module while this process imports the rest."""
    from comparisons.trials.runs.workers import most_processes

    if most_processes():
        from comparisons.trials.runs.worker_process import start_server

        start_server([module])


def _print_version(is_requested: bool) -> None:
    if is_requested:
        from importlib.metadata import version

        typer.echo(f"linkproof {version('linkproof')}")
        raise typer.Exit


@app.callback()
def linkproof(
    version: Annotated[
        bool, typer.Option("--version", help="Show the version and exit.", callback=_print_version, is_eager=True)
    ] = False,
) -> None:
    """Options that stand before a command."""


@command(app, "list", summary="List the mechanisms of the catalogue, or the figures and numbers of one.")
def list_(
    mechanism: Annotated[str | None, Argument("MECHANISM", "mechanisms")] = None,
    json: Json = False,
) -> None:
    """List the mechanisms of the catalogue, their variants and sources.

    MECHANISM is a name in the catalogue or the path of a .toml file: its figures for sweep, optimise and tolerance are
    listed, and the numbers that they can vary, in the units of the file.
    """
    from reports.command_line.commands import mechanisms

    mechanisms.list_names(mechanism, destination(OutputOptions(json=json)))


@command(app, summary="Write a linkage file to fill in.")
def new(name: Annotated[str, Argument("NAME")]) -> None:
    """Write NAME.toml, a small linkage with every key explained, as a start for yours; overwrites nothing.

    Also writes linkproof.schema.json, so that editors complete and check the file (VS Code: Even Better TOML); one
    that is there already is renewed.
    """
    from reports.command_line.commands import mechanisms

    mechanisms.new(name, destination(OutputOptions()))


@command(
    app,
    summary="Review a linkage: mobility, groups, range, links, errors.",
    without=("out", "junit", "quiet", "verbose"),
    texts={"save": "Draw the scheme (.svg .png .pdf .dxf) or write what is printed (.json); repeatable."},
)
def check(mechanism: Mechanism, output: OutputOptions, variant: Variant = None, strict: Strict = False) -> None:
    """Review a linkage: mobility, groups, range of the crank, transmission angles, toggles, links, Jeq, stroke, errors.

    MECHANISM is the path of a .toml file or a name in the catalogue.

    Stops at the first error and states it in one sentence, with exit code 2.
    """
    from reports.command_line.commands import mechanisms

    mechanisms.check(mechanism, variant, destination(output), strict=strict)


@command(
    app,
    summary="Peaks, bearing forces and every signal of one linkage, without an engine.",
    without=("junit", "verbose"),
    texts={
        "save": "Write every signal (.csv .json .xlsx), the pictures (.svg .png .pdf), or the scheme for CAD at the "
        "first instant of --at or --time, or as sketched (.dxf); repeatable.",
        "out": "Write a page with the linkage in motion into this folder.",
    },
)
def results(
    options: ResultsOptions,
    files: ResultsFiles,
    output: OutputOptions,
    opens: Annotated[bool, Option("Open the page in the browser.", flags=("--open",))] = False,
    strict: Strict = False,
) -> None:
    """Compute torque, power, bearing forces and positions of one linkage, for its designer; needs no engine.

    MECHANISM is a name in the catalogue or the path of a .toml file.

    Tables, CSV and SVG are in the units of the file, JSON is in SI with angles in rad.
    """
    from reports.command_line.commands import results

    results.results(options, files, destination(output), opens=opens, strict=strict)


@command(app, summary="Work on a linkage file: its page follows the file, and saves to it.", without=("at", "time"))
def watch(options: WatchOptions) -> None:
    """Serve the page of a linkage file on this machine: pull at its points and numbers, and save them to the file.

    MECHANISM is the path of a .toml file.

    The page is built anew when the file changes in an editor. The file is written only by a click on the page.
    """
    from reports.command_line.commands import watch

    watch.watch(options)


@command(app, summary="List the engines, test an adapter, or try what is installed.")
def engines(
    names: Annotated[tuple[str, ...], Argument("ENGINE", "engines")] = (),
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
    json: Json = False,
    quiet: Quiet = False,
) -> int:
    """List the engines: supported linkages, available quantities, and the origin of each figure in the engine.

    ENGINE is an engine of linkproof, or an adapter announced under the entry-point group linkproof.engines.

    Exit codes: 0; 1 a check failed, or something that is installed does not work; 2 nothing to check.
    """
    if checks or tries:
        _start_workers(
            "comparisons.trials.conformance.conformance" if checks else "comparisons.trials.campaign.campaign"
        )
    from reports.command_line.commands import engines

    return engines.engines(names or (), destination(OutputOptions(json=json, quiet=quiet)), checks=checks, tries=tries)


@command(
    app,
    summary="Simulate mechanisms; compare every error with its limit.",
    texts={"save": "Write every record (.json) or every curve (.csv); repeatable."},
)
def compare(
    options: CompareOptions,
    output: OutputOptions,
    standard: StandardOptions,
    limits: RunLimits,
    script: Annotated[
        Path | None, Option("Run nothing; write one run as a script that needs only its engine and numpy.", "FILE")
    ] = None,
) -> int:
    """Simulate mechanisms in engines and compare every error with its limit.

    MECHANISM is a name in the catalogue or the path of a .toml file; default: the whole catalogue.

    The naive setting shows the engine without tuning; if other settings run too, its rows do not affect the exit code.
    An engine that crashes, hangs or runs out of memory fails in its own row only.

    --out DIR alone takes the study that is in DIR: the runs that are missing are made, a finished study only gets its
    pages again.

    Exit codes: 0 every error within its limit, 1 an error over its limit, a failed run, or a result that
    is not as it was recorded (--against), 2 bad input.
    """
    if script is not None:
        from reports.command_line.commands.engines import write_script

        write_script(script, options, (output, standard, limits))
        return 0
    is_finished, (options, standard, limits) = _own_study("compare", output, options, standard, limits)
    if limits.jobs != 0 and not is_finished:
        _start_workers("comparisons.trials.campaign.campaign")
    from reports.command_line.commands import compare

    if is_finished:
        return compare.write_again(destination(output), standard.record)
    return compare.compare(options, destination(output), limits, standard)


@command(
    app,
    summary="Judge a curve from another tool: right or wrong, and the probable cause.",
    without=("junit",),
    texts={
        "save": "Draw the worst curves and the differences (.svg .png .pdf), or write the verdicts (.json); repeatable."
    },
)
def judge(options: JudgeOptions, output: OutputOptions) -> int:
    """Judge results exported from another tool: SolidWorks Motion, Adams, Modelica, any CSV with a header.

    MECHANISM is a name in the catalogue or the path of a .toml file, RESULTS are the tool's files.

    The crank's motion is taken from the file's angle or speed column, or from --regime. Nothing in a file is
    interpolated or smoothed; only corrections that --map states are applied.

    Exit codes: 0 every signal within the limit, 1 otherwise, 2 bad input or nothing to judge.
    """
    from reports.command_line.commands import judge

    return judge.judge(options, destination(output))


@command(app, summary="Measure error against run time, over a sweep of steps.", without=("save", "junit", "setting"))
def bench(options: BenchOptions, output: OutputOptions, scheduler: Scheduler = None) -> int:
    """Measure error against run time: every engine, setting and method over a sweep of steps.

    MECHANISM is a name in the catalogue or the path of a .toml file; default: the whole catalogue.

    --out DIR alone takes the benchmark that is in DIR.

    Runs are made one at a time, with --scheduler by one of its workers. Do not use the machine for anything else, or
    the times become wrong.
    """
    is_finished, (options,) = _own_study("bench", output, options)
    if not is_finished:
        _start_workers("comparisons.trials.work_precision.measure")
    from reports.command_line.commands import bench

    if is_finished:
        return bench.write_again(destination(output))
    return bench.bench(options, destination(output), scheduler)


@command(app, summary="Find conditions under which each engine fails.", without=("save", "junit"))
def stress(options: StressOptions, output: OutputOptions, jobs: Jobs = None, scheduler: Scheduler = None) -> int:
    """Find conditions under which each engine fails, and whether the checks detect it.

    AXIS is a stability map; CELL is one run of a map, AXIS/ROW/VALUE/ENGINE/USAGE; default: every map.

    --out DIR alone takes the maps that are in DIR.

    Exit code 1: an engine reported success with a wrong motion, and no check detected it.
    """
    is_finished, (options,) = _own_study("stress", output, options)
    if not is_finished:
        _start_workers("comparisons.trials.stress.cells")
    from reports.command_line.commands import stress

    if is_finished:
        return stress.write_again(destination(output))
    return stress.run(options, destination(output), jobs, scheduler)


LEFT_OUT = (*NOT_STEADY, "out", "junit", "verbose")


@command(
    app,
    summary="Compute figures of many designs, such as peak torque over a range of lengths.",
    without=LEFT_OUT,
    texts={"save": "Write every design (.csv .nc), a picture (.svg .png .pdf) or the summary (.json); repeatable."},
)
def sweep(options: SweepOptions, output: OutputOptions) -> None:
    """Compute figures of many designs of one linkage: a grid of ranges, or a table; needs no engine.

    MECHANISM is a name in the catalogue or the path of a .toml file.

    Values are in the units of the file. The crank turns at constant speed; extremes are taken at 180 angles, or are
    exact with --refine. A design that does not assemble at one of the angles has no figures.
    """
    from reports.command_line.commands import designs

    designs.sweep(options, destination(output))


@command(
    app,
    summary="Find the best lengths: the smallest peak torque at the same stroke, for example.",
    without=LEFT_OUT,
    texts={"save": "Write the new linkage (.toml), the curves (.svg .png .pdf) or the results (.json); repeatable."},
)
def optimise(options: OptimiseOptions, output: OutputOptions) -> None:
    """Find the best values within bounds while holding the results you choose; in closed form.

    MECHANISM is a name in the catalogue or the path of a .toml file; values are in the units of the file.

    Figures are those of sweep: a peak is the largest magnitude. joint_force.peak is that of all joints together.
    """
    from reports.command_line.commands import designs

    designs.optimise(options, destination(output))


@command(
    app,
    summary="Show which length, angle or mass changes which result by how much.",
    without=(*LEFT_OUT, "speed"),  # which stands in the file of tolerances
    texts={"save": "Write a row per result and number (.csv .json) or a picture (.svg .png .pdf); repeatable."},
)
def tolerance(options: ToleranceOptions, output: OutputOptions) -> None:
    """Compute the effect of tolerances on results: one by one, the worst case, random designs; in closed form.

    MECHANISM is a name in the catalogue or the path of a .toml file. Example of TOLERANCES.toml:

    results = ["Mkr.peak", "joint_force:A.peak", "stroke"]; speed = 1000; and under [tolerances] the ± of numbers of the
    linkage's file, in its units or one of their own, and of the speed: "rod.B.x" = 0.05, "rod.B.length" = "50um",
    "rocker.C.angle" = 0.1, speed = 10, "rod.mass" = { plus_minus = 0.01, distribution = "uniform" } (else normal: the ±
    are three standard deviations).
    """
    from reports.command_line.commands import designs

    designs.tolerance(options, destination(output))
