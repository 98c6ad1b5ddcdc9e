"""The command line: ``linkproof list | show | thread | published | compare | bench | stress | report``.

Exit codes: 0 all within limits, 1 a limit exceeded or a run that failed, 2 misuse, bad input or nothing judged, 3 a
fault of linkproof itself, 130 interrupted.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer
from typer.core import TyperGroup

BAD_INPUT, SUITE_ERROR, INTERRUPTED = 2, 3, 130


class InterruptedRunError(Exception):
    """Ctrl-C, of which typer would make a silent exit; says what is left."""


class _Commands(TyperGroup):
    def invoke(self, ctx: typer.Context) -> object:  # type: ignore[override]  # typer's own click, or click's
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as interrupt:
            raise InterruptedRunError(str(interrupt) or "nothing was written") from interrupt


app = typer.Typer(
    name="linkproof",
    cls=_Commands,
    help="How far is a multibody simulation of a planar linkage from the truth, and what did the truth cost?",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

JsonOption = Annotated[str | None, typer.Option("--json", metavar="FILE|-", help="Write JSON here; - is stdout.")]
MechanismsArgument = Annotated[
    list[str] | None,
    typer.Argument(metavar="[MECHANISM]...", help="Catalogue names or paths of your own .toml files; default: all."),
]


ResumeOption = Annotated[
    bool, typer.Option("--resume", help="Finish what an interrupted run of the same command kept in --out.")
]


@app.command("list")
def list_(json: JsonOption = None) -> None:
    """List the mechanisms of the catalogue, their variants and sources."""
    from reports.command_line import commands

    commands.list_mechanisms(json)


@app.command()
def show(
    mechanism: Annotated[str, typer.Argument(help="Catalogue name or path of a .toml file.")],
    variant: Annotated[str | None, typer.Option(help="Parameter variant; default: the file's own.")] = None,
    json: JsonOption = None,
) -> None:
    """Show one mechanism: structure, links, Jeq, stroke, accuracy of its closed form."""
    from reports.command_line import commands

    commands.show(mechanism, variant, json)


@app.command()
def thread(
    mechanism: Annotated[str, typer.Argument(help="Catalogue name or path of a .toml file with a [thread].")],
    variant: Annotated[str | None, typer.Option(help="Parameter variant; default: the file's own.")] = None,
    required: Annotated[
        Path | None, typer.Option(metavar="CSV", help="Required feed: columns phi_deg, feed_mm.")
    ] = None,
    json: JsonOption = None,
) -> None:
    """Show a mechanism's thread feed, and hold it against a required curve."""
    from reports.command_line import commands

    commands.thread(mechanism, variant, required, json)


@app.command()
def published(mechanisms: MechanismsArgument = None, json: JsonOption = None) -> None:
    """Hold the figures printed in the sources against ours, in every variant."""
    from reports.command_line import commands

    commands.published(mechanisms or [], json)


@app.command()
def compare(
    mechanisms: MechanismsArgument = None,
    variant: Annotated[str | None, typer.Option(help="Parameter variant; default: each file's own.")] = None,
    regime: Annotated[
        list[str] | None,
        typer.Option(
            help="run-up (default), run-up-cubic, run-up-quintic, constant-speed, own (those of a file), or all."
        ),
    ] = None,
    engine: Annotated[list[str] | None, typer.Option(help="Engine; repeatable; default: every one.")] = None,
    setting: Annotated[list[str] | None, typer.Option(help="naive, tuned (default), best, or all; repeatable.")] = None,
    quantity: Annotated[
        list[str] | None, typer.Option(help="Jeq, Teq, Mkr, Peq, S, v, a; repeatable; default: all.")
    ] = None,
    speed: Annotated[float, typer.Option(help="Final crank speed, rpm.")] = 1000.0,
    ramp_time: Annotated[float, typer.Option(help="Time to reach it, s.")] = 0.6,
    hold_time: Annotated[float, typer.Option(help="Time at that speed, s.")] = 0.1,
    start_angle: Annotated[float, typer.Option(help="Crank angle at the start, degrees.")] = 0.0,
    clockwise: Annotated[bool, typer.Option("--clockwise", help="Turn the crank clockwise.")] = False,
    no_gravity: Annotated[bool, typer.Option("--no-gravity", help="Leave gravity out.")] = False,
    full: Annotated[
        bool, typer.Option("--full", help="Run the linkages' own regimes in every setting asked for, not best alone.")
    ] = False,
    out: Annotated[Path | None, typer.Option(metavar="DIR", help="Write records, curves and the report here.")] = None,
    json: JsonOption = None,
    record_baseline: Annotated[
        bool, typer.Option("--record-baseline", help="Record these deviations as the new baseline.")
    ] = False,
    resume: ResumeOption = False,
    time_limit: Annotated[
        float | None, typer.Option(metavar="SECONDS", help="Wall time that one run may take; default: 600.")
    ] = None,
    memory_limit: Annotated[
        float | None, typer.Option(metavar="GIB", help="Memory that one run may add; default: 4.")
    ] = None,
    jobs: Annotated[
        int | None, typer.Option(metavar="N", help="Worker processes; default: the cores; 0: none, no limits.")
    ] = None,
) -> None:
    """Simulate mechanisms in engines and hold every deviation from the closed form against its limit.

    Rows of the naive setting never decide the exit code when other settings run beside them: they show what a user gets
    without tuning. An engine that aborts, hangs or swells costs its own row.
    """
    from comparisons.runs.worker_process import start_server

    if jobs != 0:
        start_server(["comparisons.campaign.campaign"])  # its imports run beside ours
    from reports.command_line import commands
    from reports.command_line.requests import Choice, Effort

    choice = Choice(
        mechanisms=tuple(mechanisms or ()),
        variant=variant,
        regimes=tuple(regime or ()),
        engines=tuple(engine or ()),
        settings=tuple(setting or ()),
        quantities=tuple(quantity or ()),
        speed=speed,
        ramp_time=ramp_time,
        hold_time=hold_time,
        start_angle=start_angle,
        clockwise=clockwise,
        gravity=not no_gravity,
        full=full,
    )
    effort = Effort(time_limit, memory_limit, jobs, resume)
    raise typer.Exit(commands.compare(choice, out, json, record_baseline=record_baseline, effort=effort))


@app.command()
def bench(
    mechanisms: MechanismsArgument = None,
    regime: Annotated[
        list[str] | None, typer.Option(help="As for compare; repeatable; default: run-up-quintic and run-up.")
    ] = None,
    engine: Annotated[list[str] | None, typer.Option(help="Engine; repeatable; default: every one.")] = None,
    quantity: Annotated[
        list[str] | None, typer.Option(help="Repeatable; default: Mkr, Jeq, phi, joint_force (the worst joint's).")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="A coarser sweep of one regime: under a minute.")] = False,
    costs: Annotated[bool, typer.Option("--costs", help="Measure too what each output and load costs.")] = False,
    out: Annotated[Path | None, typer.Option(metavar="DIR", help="Write bench.json and bench.html here.")] = None,
    json: JsonOption = None,
    resume: ResumeOption = False,
) -> None:
    """Measure error against run time: every engine, setting and method over a sweep of steps.

    One run at a time, so that times mean something: leave the machine alone meanwhile.
    """
    from comparisons.runs.worker_process import start_server

    start_server(["comparisons.work_precision.measure"])  # its imports run beside ours
    from reports.command_line.bench import BenchChoice
    from reports.command_line.bench import bench as run_bench

    choice = BenchChoice(
        mechanisms=tuple(mechanisms or ()),
        regimes=tuple(regime or ()),
        engines=tuple(engine or ()),
        quantities=tuple(quantity or ()),
        quick=quick,
        costs=costs,
    )
    raise typer.Exit(run_bench(choice, out, json, resume=resume))


@app.command()
def stress(
    words: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[AXIS | CELL]...",
            help="Maps by name, or single cells AXIS/ROW/VALUE/ENGINE/USAGE; default: every map.",
        ),
    ] = None,
    engine: Annotated[list[str] | None, typer.Option(help="Engine; repeatable; default: every one.")] = None,
    setting: Annotated[
        list[str] | None, typer.Option(help="Setting, or fixed-step method; repeatable; default: those of each map.")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Fewer cells, coarser borders: about a minute.")] = False,
    out: Annotated[Path | None, typer.Option(metavar="DIR", help="Write stress.json and stress.html here.")] = None,
    json: JsonOption = None,
    resume: ResumeOption = False,
    time_limit: Annotated[
        float | None,
        typer.Option(metavar="SECONDS", help="Wall time that one cell may take; default: that of its map."),
    ] = None,
    jobs: Annotated[int | None, typer.Option(metavar="N", help="Worker processes; default: the cores.")] = None,
) -> None:
    """Map where engines stop being right, and whether our invariants notice.

    Exits with 1 if an engine's success with a wrong motion was missed by all invariants.
    """
    from comparisons.runs.worker_process import start_server

    start_server(["comparisons.stress.cells"])  # its imports run beside ours
    from reports.command_line.stress import StressChoice, run

    choice = StressChoice(tuple(words or ()), tuple(engine or ()), tuple(setting or ()), quick, time_limit)
    raise typer.Exit(run(choice, out, json, resume=resume, jobs=jobs))


@app.command()
def report(
    saved: Annotated[Path, typer.Argument(metavar="DIR", help="Folder that compare --out wrote, or its curves.nc.")],
    out: Annotated[Path | None, typer.Option(metavar="DIR", help="Where to write the page; default: the same.")] = None,
) -> None:
    """Rebuild the report from saved curves; needs no engine."""
    from reports.command_line import commands

    commands.rebuild(saved, out)


def _has_folder() -> bool:
    try:
        return Path.cwd().is_dir()
    except FileNotFoundError:
        return False


def main() -> None:
    """Run the command line: a user's error is one sentence and exit code 2, a fault of ours one and exit code 3."""
    from analytic.errors import LinkproofError

    try:
        if not _has_folder():
            raise LinkproofError("expected a working folder, got one that was deleted: change to another")
        app()
    except LinkproofError as error:
        sys.stderr.write(f"linkproof: {error}\n")
        sys.exit(BAD_INPUT)
    except InterruptedRunError as interrupt:
        sys.stderr.write(f"linkproof: interrupted; {interrupt}\n")
        sys.exit(INTERRUPTED)
    except BrokenPipeError:
        sys.stderr.close()
        sys.exit(0)
    except MemoryError:
        raise
    except Exception as error:
        from comparisons.runs.failures import lost

        sys.stderr.write(f"linkproof: {lost(error, 0).reason}\n")
        sys.exit(SUITE_ERROR)


if __name__ == "__main__":
    main()
