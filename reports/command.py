"""The command line: ``linkproof list | show | thread | published | compare | report | targets``.

Exit codes: 0 all within limits, 1 a limit exceeded or a run that failed, 2 misuse or bad input.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

app = typer.Typer(
    name="linkproof",
    help="How far is a multibody simulation of a planar linkage from the truth, and what did the truth cost?",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

BAD_INPUT = 2
INTERRUPTED = 130

JsonOption = Annotated[str | None, typer.Option("--json", metavar="FILE|-", help="Write JSON here; - is stdout.")]
MechanismsArgument = Annotated[
    list[str] | None,
    typer.Argument(metavar="[MECHANISM]...", help="Catalogue names or paths of your own .toml files; default: all."),
]


@app.command("list")
def list_(json: JsonOption = None) -> None:
    """List the mechanisms of the catalogue, their variants and sources."""
    from reports import commands

    commands.list_mechanisms(json)


@app.command()
def show(
    mechanism: Annotated[str, typer.Argument(help="Catalogue name or path of a .toml file.")],
    variant: Annotated[str | None, typer.Option(help="Parameter variant; default: the file's own.")] = None,
    json: JsonOption = None,
) -> None:
    """Show one mechanism: structure, links, Jeq, stroke, accuracy of its closed form."""
    from reports import commands

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
    from reports import commands

    commands.thread(mechanism, variant, required, json)


@app.command()
def published(mechanisms: MechanismsArgument = None, json: JsonOption = None) -> None:
    """Hold the figures printed in the sources against ours, in every variant."""
    from reports import commands

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
) -> None:
    """Simulate mechanisms in engines and hold every deviation from the closed form against its limit.

    Rows of the naive setting never decide the exit code when other settings run beside them: they show what a user gets
    without tuning.
    """
    from reports import commands
    from reports.requests import Choice

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
    raise typer.Exit(commands.compare(choice, out, json, record_baseline=record_baseline))


@app.command()
def report(
    saved: Annotated[Path, typer.Argument(metavar="DIR", help="Folder that compare --out wrote, or its curves.nc.")],
    out: Annotated[Path | None, typer.Option(metavar="DIR", help="Where to write the page; default: the same.")] = None,
) -> None:
    """Rebuild the report from saved curves; needs no engine."""
    from reports import commands

    commands.rebuild(saved, out)


@app.command()
def targets(json: JsonOption = None) -> None:
    """Measure every figure the suite promises of itself and hold it against what is owed and aimed at."""
    from reports import commands

    raise typer.Exit(commands.targets(json))


def main() -> None:
    """Run the command line; every error a user can cause becomes one sentence and exit code 2."""
    from analytic.errors import LinkproofError

    try:
        app()
    except LinkproofError as error:
        sys.stderr.write(f"linkproof: {error}\n")
        sys.exit(BAD_INPUT)
    except KeyboardInterrupt:
        sys.stderr.write("linkproof: interrupted; nothing was written\n")
        sys.exit(INTERRUPTED)
    except BrokenPipeError:
        sys.stderr.close()
        sys.exit(0)


if __name__ == "__main__":
    main()
