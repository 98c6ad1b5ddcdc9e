"""The commands and their options: ``linkproof list | show | thread | compare | bench | …``.

Only typer is imported here: what a command needs is imported when it runs, so that help comes at once.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

from reports.command_line import completion, options
from reports.command_line.motion_choice import MotionChoice
from reports.command_line.options import flag, valued, with_choices, words

if TYPE_CHECKING:
    from reports.command_line.destination import Destination

GLOSSARY = Path(__file__).parents[1] / "templates" / "glossary.txt"


class InterruptedRunError(Exception):
    """Ctrl-C, which typer would turn into a silent exit; the message names the remaining runs."""


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
    help="Torque, power and bearing forces of planar linkages, exactly; errors of simulations, and their cost.",
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


USUAL = MotionChoice()


def _names(given: list[str] | None) -> tuple[str, ...]:
    return tuple(given or ())


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
        valued("MECHANISM", "List every figure for sweep, optimise and tolerance.", names=completion.mechanisms),
    ] = None,
    numbers: Annotated[
        str | None, valued("MECHANISM", "List every number that they can vary.", names=completion.mechanisms)
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
    """Write NAME.toml, a small linkage with every key explained, as a start for yours; overwrites nothing.

    Also writes linkproof.schema.json, so that editors complete and check the file (VS Code: Even Better TOML).
    """
    from reports.command_line.commands import files

    files.new(name, _destination(None))


@app.command(short_help="Review a linkage file: mobility, groups, range, errors.")
def check(
    mechanism: options.Mechanism,
    variant: options.Variant = None,
    svg: Annotated[Path | None, valued("FILE", "Draw the scheme into this file.")] = None,
    json: options.Json = None,
    strict: options.Strict = False,
) -> None:
    """Review a linkage file: mobility, groups, range of the crank, transmission angles, toggles, masses, errors.

    MECHANISM is the path of a .toml file or a name in the catalogue.

    Stops at the first error and states it in one sentence, with exit code 2.
    """
    from reports.command_line.commands import files

    files.check(mechanism, variant, svg, _destination(json), strict=strict)


@app.command(short_help="Write the JSON schema of linkage files.")
def schema() -> None:
    """Write the JSON schema of linkage files to stdout, so that editors complete and check the files.

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
        bool, flag("Show the linkages of the literature, in every installed engine too.", "--literature")
    ] = False,
    json: options.Json = None,
) -> None:
    """Compare the figures printed in the sources with the closed form, in every variant.

    MECHANISM is a name in the catalogue or the path of a .toml file; default: the whole catalogue.
    """
    from reports.command_line.commands import compare

    raise typer.Exit(compare.published(mechanisms or [], _destination(json), with_literature=literature))


@app.command(short_help="Peaks, bearing forces and every signal of one linkage, without an engine.")
@with_choices()
def results(
    mechanism: options.Mechanism,
    motion: MotionChoice = USUAL,
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
    out: Annotated[Path | None, valued("DIR", "Write a page with the linkage in motion into this folder.")] = None,
    opens: Annotated[bool, flag("Open the page in the browser.", "--open")] = False,
    strict: options.Strict = False,
    quiet: options.Quiet = False,
) -> None:
    """Compute torque, power, bearing forces and positions of one linkage, for its designer; needs no engine.

    MECHANISM is a name in the catalogue or the path of a .toml file.

    Tables, CSV and SVG are in the units of the file, JSON is in SI with angles in rad.
    """
    from reports.command_line.commands import results
    from reports.command_line.commands.results import ResultsChoice

    choice = ResultsChoice(
        mechanism=mechanism, at=at, time=time, csv=csv, decimal=decimal, xlsx=xlsx, json=json, svg=svg, png=png,
        pdf=pdf, gif=gif, dxf=dxf, figure=figure, out=out, opens=opens, strict=strict, **motion.motion_options,
    )  # fmt: skip
    results.results(choice, quiet=quiet)


@app.command(short_help="List the engines, their abilities and the origin of their figures.")
def engines(
    names: Annotated[list[str] | None, typer.Argument(metavar="[ENGINE]...")] = None, json: options.Json = None
) -> None:
    """List the engines: supported linkages, available quantities, and the origin of each figure in the engine."""
    from reports.command_line.commands import engines

    engines.list_engines(_names(names), _destination(json))


@app.command(short_help="Simulate mechanisms; compare every error with its limit.")
@with_choices()
def compare(
    mechanisms: options.Mechanisms = None,
    motion: MotionChoice = USUAL,
    engine: options.Engines = None,
    setting: options.Settings = None,
    quantity: options.Quantities = None,
    full: Annotated[bool, flag("Run the files' regimes in every setting, not only in tuned.", "--full")] = False,
    out: options.Out = None,
    json: options.Json = None,
    limits: Annotated[Path | None, valued("FILE", "Your limits, which precede the suite's.")] = None,
    baseline: Annotated[Path | None, valued("FILE", "Errors and key figures recorded earlier.")] = None,
    record_baseline: Annotated[
        bool,
        flag("Record errors and key figures in the file of --baseline or the project.", "--record-baseline"),
    ] = False,
    allow_new: Annotated[
        bool, flag("Allow linkages and motions that the baseline does not contain.", "--allow-new")
    ] = False,
    allow_missing: Annotated[
        bool, flag("Allow linkages and motions of the baseline to be missing.", "--allow-missing")
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
    working folder or above it, or the whole catalogue. A linkproof.toml above the file supplies missing options.

    The naive setting shows the engine without tuning; if other settings run too, its rows do not affect the exit code.
    An engine that crashes, hangs or runs out of memory fails in its own row only.

    Exit codes: 0 every error within its limit, 1 an error over its limit, a failed run, or a linkage, motion or
    key figure that differs from the baseline, 2 bad input.
    """
    from comparisons.runs.worker_process import start_server

    if jobs != 0:
        start_server(["comparisons.campaign.campaign"])  # its imports run beside ours
    from reports.command_line.commands import compare
    from reports.command_line.requests import CampaignChoice, RunLimits
    from reports.command_line.standard_choice import StandardChoice

    choice = CampaignChoice(
        _names(mechanisms), _names(engine), _names(setting), _names(quantity), full, **motion.motion_options
    )
    destination = _destination(json, out, resume, quiet, verbose, junit)
    held = StandardChoice(limits, baseline, record_baseline, allow_new, allow_missing)
    raise typer.Exit(compare.compare(choice, destination, RunLimits(time_limit, memory_limit, jobs, scheduler), held))


@app.command(short_help="Judge a curve from another tool: right or wrong, and the probable cause.")
@with_choices()
def judge(
    mechanism: options.Mechanism,
    results: Annotated[list[Path], typer.Argument(metavar="RESULTS...", hidden=True)],
    mapping: Annotated[Path | None, valued("FILE", "The meaning of each column, and accepted corrections.")] = None,
    write_mapping: Annotated[Path | None, valued("FILE", "Write the recognised mapping.")] = None,
    limit: Annotated[float, valued("SHARE", "Largest error allowed, as a share of the closed form's peak.")] = 0.01,
    motion: MotionChoice = USUAL,
    out: options.Out = None,
    json: options.Json = None,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
) -> None:
    """Judge results exported from another tool: SolidWorks Motion, Adams, Modelica, any CSV with a header.

    MECHANISM is a name in the catalogue or the path of a .toml file, RESULTS are the tool's files.

    The crank's motion is taken from the file's angle or speed column, or from --regime. Nothing in a file is
    interpolated or smoothed; only corrections in the mapping are applied.

    Exit codes: 0 every signal within the limit, 1 otherwise, 2 bad input or nothing to judge.
    """
    from reports.command_line.commands import judge

    choice = judge.JudgeChoice(mechanism, tuple(results), motion, limit, mapping, write_mapping)
    raise typer.Exit(judge.judge(choice, _destination(json, out, False, quiet, verbose)))


@app.command(short_help="Measure error against run time, over a sweep of steps.")
@with_choices()
def bench(
    mechanisms: options.Mechanisms = None,
    motion: MotionChoice = USUAL,
    engine: options.Engines = None,
    quantity: options.Quantities = None,
    quick: Annotated[bool, flag("Run a coarser sweep of one regime, under a minute.", "--quick")] = False,
    costs: Annotated[bool, flag("Also measure the cost of each output and load.", "--costs")] = False,
    out: options.Out = None,
    json: options.Json = None,
    resume: options.Resume = False,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
    scheduler: options.Scheduler = None,
) -> None:
    """Measure error against run time: every engine, setting and method over a sweep of steps.

    MECHANISM is a name in the catalogue or the path of a .toml file; default: the whole catalogue.

    Runs are made one at a time. Do not use the machine for anything else, or the times become wrong.
    """
    from comparisons.runs.worker_process import start_server

    start_server(["comparisons.work_precision.measure"])  # its imports run beside ours
    from reports.command_line.commands import bench

    choice = bench.BenchChoice(
        _names(mechanisms), _names(engine), quantities=_names(quantity), quick=quick, costs=costs,
        **motion.motion_options,
    )  # fmt: skip
    raise typer.Exit(bench.bench(choice, _destination(json, out, resume, quiet, verbose), scheduler))


@app.command(short_help="Find conditions under which each engine fails.")
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
    """Find conditions under which each engine fails, and whether the checks detect it.

    AXIS is a stability map; CELL is one run of a map, AXIS/ROW/VALUE/ENGINE/USAGE; default: every map.

    Exit code 1: an engine reported success with a wrong motion, and no check detected it.
    """
    from comparisons.runs.worker_process import start_server

    start_server(["comparisons.stress.cells"])  # its imports run beside ours
    from reports.command_line.commands import stress

    choice = stress.StressChoice(_names(words), _names(engine), _names(setting), quick, time_limit)
    raise typer.Exit(stress.run(choice, _destination(json, out, resume, quiet, verbose), jobs, scheduler))


@app.command("check-engine", short_help="Test an engine's adapter.")
def check_engine(
    engine: Annotated[str, typer.Argument(metavar="ENGINE", hidden=True)],
    json: options.Json = None,
    quiet: options.Quiet = False,
    jobs: Annotated[int | None, valued("N", "Worker processes; default: one per core.")] = None,
) -> None:
    """Test an engine's adapter: signs, frames, units, instants, failures as values, deliberate errors.

    ENGINE is the name of an adapter announced under the entry-point group linkproof.engines.

    Exit codes: 0 every check passed, failed as expected or does not apply, 1 a check failed, 2 nothing to check.
    """
    from comparisons.runs.worker_process import start_server

    start_server(["comparisons.conformance.conformance"])  # its imports run beside ours
    from reports.command_line.commands import engines

    raise typer.Exit(engines.check(engine, _destination(json, None, False, quiet), jobs))


@app.command(short_help="Write an engine's run as a standalone script.")
@with_choices()
def export(
    mechanism: Annotated[str | None, words("MECHANISM", completion.mechanisms)] = None,
    motion: MotionChoice = USUAL,
    engine: Annotated[str | None, valued("NAME", "Engine.", names=completion.engines)] = None,
    setting: Annotated[str | None, valued("NAME", "naive or tuned; default: tuned.", names=completion.settings)] = None,
    cell: Annotated[
        str | None, valued("CELL", "Instead of a mechanism: a run of a stability map, AXIS/ROW/VALUE/ENGINE/USAGE.")
    ] = None,
    out: Annotated[Path | None, valued("FILE", "Where to write it; default: stdout.")] = None,
) -> None:
    """Write an engine's run as a script that needs only the engine and numpy, so that its author can repeat it.

    MECHANISM is a name in the catalogue or the path of a .toml file.

    At its end the script prints the engine's values where they differ most from the closed form, beside the latter.
    """
    from reports.command_line.commands import engines
    from reports.command_line.requests import CampaignChoice

    mechanisms, named, settings = ((name,) if name else () for name in (mechanism, engine, setting))
    engines.export(CampaignChoice(mechanisms, named, settings, **motion.motion_options), cell, out)


@app.command(short_help="Write the pages of saved results again, or the curves as CSV.")
def report(
    saved: Annotated[Path, typer.Argument(metavar="DIR", hidden=True)],
    out: Annotated[Path | None, valued("DIR", "Where to write the pages; default: the same folder.")] = None,
    single_file: Annotated[Path | None, valued("FILE", "Write one page with everything in it, to mail.")] = None,
    csv: Annotated[Path | None, valued("DIR", "Write only the curves, a CSV file per run.")] = None,
    png: Annotated[bool, flag("Write every figure as PNG beside its SVG.", "--png")] = False,
    show: Annotated[bool, flag("Open the report in the browser.", "--open")] = False,
) -> None:
    """Write the pages of saved results again; needs no engine.

    DIR is a folder that compare, bench, stress or judge wrote with --out, the curves.nc in it, or a merged folder.
    """
    from reports.command_line.commands import folders

    folders.report(saved, out, single_file, csv, opens=show, png=png)


@app.command(short_help="Check a results folder from someone else.")
def verify(
    saved: Annotated[Path, typer.Argument(metavar="DIR", hidden=True)],
    limits: Annotated[Path | None, valued("FILE", "Judge by these limits; default: those saved in DIR.")] = None,
    json: options.Json = None,
    quiet: options.Quiet = False,
) -> None:
    """Check a results folder: texts, curves and records are compared with each other and the closed form.

    DIR is the folder that compare wrote with --out; no engine is needed.

    Exit codes: 0 nothing differs, whatever the verdicts, 1 something differs, 2 bad input.
    """
    from reports.command_line.commands import folders

    raise typer.Exit(folders.verify(saved, limits, _destination(json, None, False, quiet)))


@app.command(short_help="Show the changes between two results folders.")
def diff(
    before: Annotated[Path, typer.Argument(metavar="DIR", hidden=True)],
    after: Annotated[Path, typer.Argument(metavar="DIR", hidden=True)],
    json: options.Json = None,
    quiet: options.Quiet = False,
    verbose: options.Verbose = False,
) -> None:
    """Show the changes between two results folders: after an engine's upgrade, for two designs or variants.

    Each DIR is a folder that compare wrote with --out; name the earlier one first.

    Exit codes: 0 no change is beyond the limits; 1 a run newly fails, or in the same linkage an error has tripled or a
    key figure has changed; 2 bad input or nothing in common.
    """
    from reports.command_line.commands import folders

    raise typer.Exit(folders.diff(before, after, _destination(json, None, False, quiet, verbose)))


@app.command(short_help="Join folders from several machines into one report.")
def merge(
    saved: Annotated[list[Path], typer.Argument(metavar="DIR...", hidden=True)],
    out: Annotated[Path, valued("DIR", "The new folder.")],
) -> None:
    """Join folders from several machines into one report, grouped by hardware; nothing is ranked across machines.

    DIR is a folder that compare, bench or stress wrote with --out, or a merged folder.
    """
    from reports.command_line.commands import folders

    folders.merge(saved, out)
