"""The commands and their options: ``linkproof list | show | thread | compare | bench | …``.

Only typer is imported here: what a command needs is imported when it runs, so that help comes at once.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from reports.command_line import completion, options
from reports.command_line.options import flag, valued, words

if TYPE_CHECKING:
    from reports.command_line.destination import Destination

GLOSSARY = Path(__file__).parents[1] / "templates" / "glossary.txt"


class InterruptedRunError(Exception):
    """Ctrl-C, of which typer would make a silent exit; says what is left."""


class _Commands(TyperGroup):
    def invoke(self, ctx: typer.Context) -> object:  # type: ignore[override]  # typer's own click, or click's
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as interrupt:
            raise InterruptedRunError(str(interrupt) or "nothing was written") from interrupt

    def get_help(self, ctx: typer.Context) -> str:  # type: ignore[override]
        return f"{super().get_help(ctx)}\n\n{GLOSSARY.read_text(encoding='utf-8')}"


app = typer.Typer(
    name="linkproof",
    cls=_Commands,
    help="How far is a multibody simulation of a planar linkage from the truth, and what did it cost?",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _names(given: list[str] | None) -> tuple[str, ...]:
    return tuple(given or ())


def _speed(rpm: float | None) -> dict[str, Any]:
    """The speed of a motion, and whether it was given: a drive along a line has a default of its own."""
    return {"gives_speed": False} if rpm is None else {"speed": rpm, "gives_speed": True}


def _destination(json: str | None, *rest: Any) -> Destination:  # noqa: ANN401
    from reports.command_line.destination import Destination

    return Destination(json, *rest)


def _print_version(wanted: bool) -> None:
    if wanted:
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


@app.command("list", short_help="List the mechanisms of the catalogue, or the figures or numbers of one.")
def list_(
    figures: Annotated[
        str | None,
        valued("MECHANISM", "Every figure that sweep, optimise and tolerance take.", names=completion.mechanisms),
    ] = None,
    numbers: Annotated[
        str | None, valued("MECHANISM", "Every number of the file that they vary.", names=completion.mechanisms)
    ] = None,
    json: options.Json = None,
) -> None:
    """List the mechanisms of the catalogue, their variants and sources; or the figures or the numbers of one.

    MECHANISM is a name in the catalogue or the path of a .toml file. Values are in the units of the file.
    """
    from reports.command_line.commands import mechanisms

    mechanisms.list_names(figures, numbers, _destination(json))


@app.command(short_help="Show one mechanism: structure, links, Jeq, stroke.")
def show(mechanism: options.Mechanism, variant: options.Variant = None, json: options.Json = None) -> None:
    """Show one mechanism: structure, links, Jeq, stroke, accuracy of its closed form.

    MECHANISM is a name in the catalogue or the path of a .toml file.
    """
    from reports.command_line.commands import mechanisms

    mechanisms.show(mechanism, variant, _destination(json))


@app.command(short_help="Write a linkage file to fill in.")
def new(name: Annotated[str, typer.Argument(metavar="NAME", hidden=True)]) -> None:
    """Write NAME.toml, a small linkage with every key explained, to change into one of your own; overwrites nothing.

    Beside it stands linkproof.schema.json, by which editors complete and check it (VS Code: Even Better TOML).
    """
    from reports.command_line.commands import files

    files.new(name, _destination(None))


@app.command(short_help="Look a linkage over: mobility, groups, range, toggles.")
def check(
    mechanism: options.Mechanism,
    variant: options.Variant = None,
    svg: Annotated[Path | None, valued("FILE", "Draw the scheme into this file.")] = None,
    json: options.Json = None,
    strict: options.Strict = False,
) -> None:
    """Look a linkage over: mobility, groups, range of the crank, transmission angles, toggles, masses, slips.

    MECHANISM is the path of a .toml file or a name in the catalogue.

    What is right is told up to the first fault, which is told in a sentence; exit code 2.
    """
    from reports.command_line.commands import files

    files.check(mechanism, variant, svg, _destination(json), strict=strict)


@app.command(short_help="Write the JSON schema of linkage files.")
def schema() -> None:
    """Write the JSON schema of linkage files to stdout: editors complete and check files by it.

    A file names it in its first line: #:schema ./linkproof.schema.json (taplo, Even Better TOML).
    """
    from reports.command_line.commands import files

    typer.echo(files.schema_text(), nl=False)


@app.command(short_help="Show a mechanism's thread feed.")
def thread(
    mechanism: options.Mechanism,
    variant: options.Variant = None,
    required: Annotated[Path | None, valued("CSV", "Required feed: columns phi_deg, feed_mm.")] = None,
    json: options.Json = None,
) -> None:
    """Show a mechanism's thread feed, and compare it with a required curve.

    MECHANISM is a name in the catalogue or the path of a .toml file with a [thread].
    """
    from reports.command_line.commands import mechanisms

    mechanisms.thread(mechanism, variant, required, _destination(json))


@app.command(short_help="Compare figures printed in the sources with the closed form.")
def published(
    mechanisms: options.Mechanisms = None,
    literature: Annotated[
        bool, flag("The linkages of the literature, with every installed engine's answer.", "--literature")
    ] = False,
    json: options.Json = None,
) -> None:
    """Compare the figures printed in the sources with the closed form, in every variant.

    MECHANISM is a name in the catalogue or the path of a .toml file; default: the whole catalogue.
    """
    from reports.command_line.commands import compare

    raise typer.Exit(compare.published(mechanisms or [], _destination(json), with_literature=literature))


@app.command(short_help="Peaks, bearing forces and every signal of one linkage, without an engine.")
def results(
    mechanism: options.Mechanism,
    variant: options.Variant = None,
    regime: Annotated[
        str | None,
        valued(
            "NAME",
            "Motion of the crank, as for compare, or one of the file's own; default: one turn at constant speed, or "
            "the range of a crank that makes none.",
            names=completion.regimes,
        ),
    ] = None,
    speed: options.Speed = None,
    ramp_time: options.RampTime = 0.6,
    hold_time: options.HoldTime = 0.1,
    start_angle: options.StartAngle = 0.0,
    from_angle: options.FromAngle = None,
    to_angle: options.ToAngle = None,
    clockwise: options.Clockwise = False,
    no_gravity: options.NoGravity = False,
    at: Annotated[str | None, valued("DEGREES", "Every signal at these crank angles: 0,30,60.")] = None,
    time: Annotated[str | None, valued("SECONDS", "Every signal at these times: 0.1,0.2.")] = None,
    csv: Annotated[str | None, valued("FILE|-", "Write every signal as a table, in the file's units.")] = None,
    decimal: Annotated[str, valued(".|,", "Decimal mark of --csv; with a comma, semicolons between columns.")] = ".",
    xlsx: Annotated[str | None, valued("FILE", "Write signals and key figures as a workbook.")] = None,
    json: options.Json = None,
    svg: Annotated[str | None, valued("FILE|-", "Draw scheme, coupler curves, torque, bearing forces.")] = None,
    png: Annotated[str | None, valued("FILE", "The same as PNG, 300 dots to the inch.")] = None,
    pdf: Annotated[str | None, valued("FILE", "The same as PDF.")] = None,
    gif: Annotated[str | None, valued("FILE", "Draw the linkage in motion.")] = None,
    dxf: Annotated[
        str | None, valued("FILE|-", "Draw the scheme for CAD, at the first instant of --at or --time, or as sketched.")
    ] = None,
    figure: Annotated[
        str | None,
        valued(
            "NAME",
            "Draw one figure alone, as wide as a paper's column: scheme, curves, torque, power, energy, inertia, "
            "output, forces, transmission.",
        ),
    ] = None,
    out: Annotated[Path | None, valued("DIR", "Write its page, with the linkage in motion, into this folder.")] = None,
    opens: Annotated[bool, flag("Open the page in the browser.", "--open")] = False,
    strict: options.Strict = False,
    quiet: options.Quiet = False,
) -> None:
    """Work out what a designer needs of one linkage: torque, power, bearing forces, positions; needs no engine.

    MECHANISM is a name in the catalogue or the path of a .toml file.

    Tables, CSV and SVG are in the units of the file, JSON is in SI with angles in rad.
    """
    from reports.command_line.commands import results
    from reports.command_line.commands.results import ResultsChoice

    choice = ResultsChoice(
        mechanism=mechanism, variant=variant, regimes=(regime,) if regime else (), **_speed(speed), ramp_time=ramp_time,
        hold_time=hold_time, start_angle=start_angle, clockwise=clockwise, from_angle=from_angle, to_angle=to_angle,
        gravity=not no_gravity, at=at, time=time, csv=csv, decimal=decimal, xlsx=xlsx, json=json,
        svg=svg, png=png, pdf=pdf, gif=gif, dxf=dxf, figure=figure, out=out, opens=opens,
        strict=strict,
    )  # fmt: skip
    results.results(choice, quiet=quiet)


@app.command(short_help="List the engines, what they can do and where their figures come from.")
def engines(
    names: Annotated[list[str] | None, typer.Argument(metavar="[ENGINE]...")] = None, json: options.Json = None
) -> None:
    """List the engines: what each can hold, what it offers, and what its figures are in the engine itself."""
    from reports.command_line.commands import engines

    engines.list_engines(_names(names), _destination(json))


@app.command(short_help="Simulate mechanisms; compare every error with its limit.")
def compare(
    mechanisms: options.Mechanisms = None,
    variant: options.Variant = None,
    regime: options.Regimes = None,
    engine: options.Engines = None,
    setting: options.Settings = None,
    quantity: options.Quantities = None,
    speed: options.Speed = None,
    ramp_time: options.RampTime = 0.6,
    hold_time: options.HoldTime = 0.1,
    start_angle: options.StartAngle = 0.0,
    from_angle: options.FromAngle = None,
    to_angle: options.ToAngle = None,
    clockwise: options.Clockwise = False,
    no_gravity: options.NoGravity = False,
    full: Annotated[bool, flag("Run the files' own regimes in every setting, not tuned alone.", "--full")] = False,
    out: options.Out = None,
    json: options.Json = None,
    limits: Annotated[Path | None, valued("FILE", "Limits of your own, which go before the suite's.")] = None,
    baseline: Annotated[Path | None, valued("FILE", "Errors and key figures as recorded before.")] = None,
    record_baseline: Annotated[
        bool,
        flag("Record errors and key figures into the baseline, of --baseline or the project.", "--record-baseline"),
    ] = False,
    allow_new: Annotated[
        bool, flag("Let linkages and motions pass that the baseline does not have.", "--allow-new")
    ] = False,
    allow_missing: Annotated[
        bool, flag("Let linkages and motions be missing that the baseline has.", "--allow-missing")
    ] = False,
    junit: Annotated[Path | None, valued("FILE", "Write every verdict as a test case, in JUnit's XML.")] = None,
    resume: options.Resume = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    time_limit: Annotated[float | None, valued("SECONDS", "Wall time that one run may take; default: 600.")] = None,
    memory_limit: Annotated[float | None, valued("GIB", "Memory that one run may add; default: 4.")] = None,
    jobs: options.Jobs = None,
    scheduler: options.Scheduler = None,
) -> None:
    """Simulate mechanisms in engines and compare every error with its limit.

    MECHANISM is a name in the catalogue or the path of a .toml file; default: those of the linkproof.toml in the
    working folder or above it, or the whole catalogue. A linkproof.toml above the file says what options leave open.

    The naive setting shows what a user gets without tuning: beside other settings its rows do not decide the exit code.
    An engine that crashes, hangs or runs out of memory fails in its own row only.

    Exit codes: 0 every error within its limit, 1 an error over its limit, a run that failed, or a linkage, motion or
    key figure that is not as in the baseline, 2 bad input.
    """
    from comparisons.runs.worker_process import start_server

    if jobs != 0:
        start_server(["comparisons.campaign.campaign"])  # its imports run beside ours
    from reports.command_line.commands import compare
    from reports.command_line.requests import CampaignChoice, RunLimits
    from reports.command_line.standard_choice import StandardChoice

    choice = CampaignChoice(
        _names(mechanisms), _names(engine), _names(setting), _names(quantity), not no_gravity, full,
        variant=variant, regimes=_names(regime), **_speed(speed), ramp_time=ramp_time, hold_time=hold_time,
        start_angle=start_angle, clockwise=clockwise, from_angle=from_angle, to_angle=to_angle,
    )  # fmt: skip
    destination = _destination(json, out, resume, quiet, verbose, junit)
    held = StandardChoice(limits, baseline, record_baseline, allow_new, allow_missing)
    raise typer.Exit(compare.compare(choice, destination, RunLimits(time_limit, memory_limit, jobs, scheduler), held))


@app.command(short_help="Judge the results of another tool: right or not, and what is likely wrong.")
def judge(
    mechanism: options.Mechanism,
    results: Annotated[list[Path], typer.Argument(metavar="RESULTS...", hidden=True)],
    mapping: Annotated[Path | None, valued("FILE", "What each column is, and which corrections are agreed to.")] = None,
    write_mapping: Annotated[Path | None, valued("FILE", "Write the mapping as recognised.")] = None,
    limit: Annotated[float, valued("SHARE", "Largest error allowed, as a share of the closed form's peak.")] = 0.01,
    variant: options.Variant = None,
    regime: options.Regimes = None,
    speed: options.Speed = None,
    from_angle: options.FromAngle = None,
    to_angle: options.ToAngle = None,
    ramp_time: options.RampTime = 0.6,
    hold_time: options.HoldTime = 0.1,
    start_angle: options.StartAngle = 0.0,
    clockwise: options.Clockwise = False,
    no_gravity: options.NoGravity = False,
    out: options.Out = None,
    json: options.Json = None,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
) -> None:
    """Judge results of a tool that cannot be called: SolidWorks Motion, Adams, Modelica, any CSV with a header.

    MECHANISM is a name in the catalogue or the path of a .toml file, RESULTS are the tool's files.

    The crank moves as the file's column of its angle or speed says, or as --regime does. Nothing in a file is
    interpolated, smoothed or corrected unless the mapping says so.

    Exit codes: 0 every signal within the limit, 1 one is not, 2 bad input or nothing to judge.
    """
    from reports.command_line.commands import judge
    from reports.command_line.motion_choice import MotionChoice

    motion = MotionChoice(
        variant=variant, regimes=_names(regime), **_speed(speed), ramp_time=ramp_time, hold_time=hold_time,
        start_angle=start_angle, clockwise=clockwise, from_angle=from_angle, to_angle=to_angle,
    )  # fmt: skip
    choice = judge.JudgeChoice(mechanism, tuple(results), motion, limit, mapping, write_mapping, not no_gravity)
    raise typer.Exit(judge.judge(choice, _destination(json, out, False, quiet, verbose)))


@app.command(short_help="Measure error against run time, over a sweep of steps.")
def bench(
    mechanisms: options.Mechanisms = None,
    variant: options.Variant = None,
    regime: options.Regimes = None,
    engine: options.Engines = None,
    quantity: options.Quantities = None,
    speed: options.Speed = None,
    ramp_time: options.RampTime = 0.6,
    hold_time: options.HoldTime = 0.1,
    start_angle: options.StartAngle = 0.0,
    from_angle: options.FromAngle = None,
    to_angle: options.ToAngle = None,
    clockwise: options.Clockwise = False,
    quick: Annotated[bool, flag("A coarser sweep of one regime: under a minute.", "--quick")] = False,
    costs: Annotated[bool, flag("Measure what each output and load costs too.", "--costs")] = False,
    out: options.Out = None,
    json: options.Json = None,
    resume: options.Resume = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    scheduler: options.Scheduler = None,
) -> None:
    """Measure error against run time: every engine, setting and method over a sweep of steps.

    MECHANISM is a name in the catalogue or the path of a .toml file; default: the whole catalogue.

    Runs are made one at a time, so that times mean something: leave the machine alone meanwhile.
    """
    from comparisons.runs.worker_process import start_server

    start_server(["comparisons.work_precision.measure"])  # its imports run beside ours
    from reports.command_line.commands import bench

    choice = bench.BenchChoice(
        _names(mechanisms), _names(engine), quantities=_names(quantity), quick=quick, costs=costs,
        variant=variant, regimes=_names(regime), **_speed(speed), ramp_time=ramp_time, hold_time=hold_time,
        start_angle=start_angle, clockwise=clockwise, from_angle=from_angle, to_angle=to_angle,
    )  # fmt: skip
    raise typer.Exit(bench.bench(choice, _destination(json, out, resume, quiet, verbose), scheduler))


@app.command(short_help="Find where each engine fails, and whether the checks notice.")
def stress(
    words: options.Cells = None,
    engine: options.Engines = None,
    setting: options.Settings = None,
    quick: Annotated[bool, flag("Fewer cells, coarser borders: about a minute.", "--quick")] = False,
    out: options.Out = None,
    json: options.Json = None,
    resume: options.Resume = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    time_limit: Annotated[
        float | None, valued("SECONDS", "Wall time that one cell may take; default: that of its map.")
    ] = None,
    jobs: options.Jobs = None,
    scheduler: options.Scheduler = None,
) -> None:
    """Find where each engine fails, and whether the checks notice.

    AXIS is a stability map; CELL is one run of a map, AXIS/ROW/VALUE/ENGINE/USAGE; default: every map.

    Exit code 1: an engine reported success with a wrong motion, and no check noticed.
    """
    from comparisons.runs.worker_process import start_server

    start_server(["comparisons.stress.cells"])  # its imports run beside ours
    from reports.command_line.commands import stress

    choice = stress.StressChoice(_names(words), _names(engine), _names(setting), quick, time_limit)
    raise typer.Exit(stress.run(choice, _destination(json, out, resume, quiet, verbose), jobs, scheduler))


@app.command("check-engine", short_help="Hold an engine's adapter to the contract.")
def check_engine(
    engine: Annotated[str, typer.Argument(metavar="ENGINE", hidden=True)],
    json: options.Json = None,
    quiet: options.Quiet = False,
    jobs: Annotated[int | None, valued("N", "Worker processes; default: one per core.")] = None,
) -> None:
    """Hold an engine's adapter to the contract: signs, frames, units, instants, failures as values, mutants.

    ENGINE is the name of an adapter announced under the entry-point group linkproof.engines.

    Exit codes: 0 every check passed, failed as expected or does not apply, 1 a check failed, 2 nothing to check.
    """
    from comparisons.runs.worker_process import start_server

    start_server(["comparisons.conformance.conformance"])  # its imports run beside ours
    from reports.command_line.commands import engines

    raise typer.Exit(engines.check(engine, _destination(json, None, False, quiet), jobs))


@app.command(short_help="Write an engine's run as a script of its own.")
def export(
    mechanism: Annotated[str | None, words("MECHANISM", completion.mechanisms)] = None,
    variant: options.Variant = None,
    engine: Annotated[str | None, valued("NAME", "Engine.", names=completion.engines)] = None,
    regime: Annotated[
        str | None, valued("NAME", "Motion of the crank; default: run-up.", names=completion.regimes)
    ] = None,
    setting: Annotated[str | None, valued("NAME", "naive or tuned; default: tuned.", names=completion.settings)] = None,
    cell: Annotated[
        str | None, valued("CELL", "Instead of a mechanism: a run of a stability map, AXIS/ROW/VALUE/ENGINE/USAGE.")
    ] = None,
    speed: options.Speed = None,
    ramp_time: options.RampTime = 0.6,
    hold_time: options.HoldTime = 0.1,
    start_angle: options.StartAngle = 0.0,
    from_angle: options.FromAngle = None,
    to_angle: options.ToAngle = None,
    clockwise: options.Clockwise = False,
    no_gravity: options.NoGravity = False,
    out: Annotated[Path | None, valued("FILE", "Where to write it; default: stdout.")] = None,
) -> None:
    """Write an engine's run as a script that needs the engine and numpy alone, so that its author can repeat it.

    MECHANISM is a name in the catalogue or the path of a .toml file.

    At its end the script prints what the engine says where it is furthest from the closed form, beside the latter.
    """
    from reports.command_line.commands import engines
    from reports.command_line.requests import CampaignChoice

    one = [(name,) if name else () for name in (mechanism, engine, setting, regime)]
    choice = CampaignChoice(
        one[0], one[1], one[2], (), not no_gravity,
        variant=variant, regimes=one[3], **_speed(speed), ramp_time=ramp_time, hold_time=hold_time,
        start_angle=start_angle, clockwise=clockwise, from_angle=from_angle, to_angle=to_angle,
    )  # fmt: skip
    engines.export(choice, cell, out)


@app.command(short_help="Write the pages of what was saved again, or its curves as CSV.")
def report(
    saved: Annotated[Path, typer.Argument(metavar="DIR", hidden=True)],
    out: Annotated[Path | None, valued("DIR", "Where to write the pages; default: the same folder.")] = None,
    single_file: Annotated[Path | None, valued("FILE", "Write one page that holds everything, to mail.")] = None,
    csv: Annotated[Path | None, valued("DIR", "Write the curves, a CSV file per run, and no pages.")] = None,
    png: Annotated[bool, flag("Write every figure as PNG beside its SVG.", "--png")] = False,
    show: Annotated[bool, flag("Open the report in the browser.", "--open")] = False,
) -> None:
    """Write the pages of what was saved again; needs no engine.

    DIR is the folder that compare, bench, stress or judge wrote with --out, the curves.nc in it, or what merge wrote.
    """
    from reports.command_line.commands import folders

    folders.report(saved, out, single_file, csv, opens=show, png=png)


@app.command(short_help="Judge a folder that someone else sent anew.")
def verify(
    saved: Annotated[Path, typer.Argument(metavar="DIR", hidden=True)],
    limits: Annotated[Path | None, valued("FILE", "Judge by these limits; default: those saved in DIR.")] = None,
    json: options.Json = None,
    quiet: options.Quiet = False,
) -> None:
    """Judge a campaign's folder anew: texts, curves and records are held against each other and the closed form.

    DIR is the folder that compare wrote with --out; no engine is needed.

    Exit codes: 0 nothing differs, whatever the verdicts, 1 something differs, 2 bad input.
    """
    from reports.command_line.commands import folders

    raise typer.Exit(folders.verify(saved, limits, _destination(json, None, False, quiet)))


@app.command(short_help="Tell what has moved from one folder to another.")
def diff(
    before: Annotated[Path, typer.Argument(metavar="DIR", hidden=True)],
    after: Annotated[Path, typer.Argument(metavar="DIR", hidden=True)],
    json: options.Json = None,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
) -> None:
    """Tell what has moved between two campaigns: an engine's upgrade, two designs, two variants.

    The folders are those that compare wrote with --out, the earlier one first.

    Exit codes: 0 nothing is beyond limits, 1 something is: a run fails that did not, or an error is three times what it
    was or a key figure has moved in the same linkage; 2 bad input or nothing in common.
    """
    from reports.command_line.commands import folders

    raise typer.Exit(folders.diff(before, after, _destination(json, None, False, quiet, verbose)))


@app.command(short_help="Join folders of several machines into one report.")
def merge(
    saved: Annotated[list[Path], typer.Argument(metavar="DIR...", hidden=True)],
    out: Annotated[Path, valued("DIR", "The new folder.")],
) -> None:
    """Join folders of several machines into one report, grouped by hardware; nothing is ranked across machines.

    The folders are those that compare, bench or stress wrote with --out, or merge itself.
    """
    from reports.command_line.commands import folders

    folders.merge(saved, out)
