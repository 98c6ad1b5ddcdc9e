"""Options and arguments shared by several commands, with their help and shell completion."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer
from typer.models import ArgumentInfo, OptionInfo

from reports.command_line import completion


def words(metavar: str, names: Callable[..., list[str]]) -> ArgumentInfo:
    """An argument that a shell completes; the help of its command explains it."""
    argument: ArgumentInfo = typer.Argument(metavar=metavar, autocompletion=names, hidden=True)
    return argument


def valued(metavar: str, text: str, *flags: str, names: Callable[..., list[str]] | None = None) -> OptionInfo:
    """An option with a value, which a shell completes where ``names`` are given."""
    option: OptionInfo = typer.Option(*flags, metavar=metavar, help=text, autocompletion=names)
    return option


def flag(text: str, *flags: str) -> OptionInfo:
    """An option without a value."""
    option: OptionInfo = typer.Option(*flags, help=text)
    return option


Mechanism = Annotated[str, words("MECHANISM", completion.mechanisms)]
Mechanisms = Annotated[list[str] | None, words("MECHANISM", completion.mechanisms)]
Cells = Annotated[list[str] | None, words("AXIS|CELL", completion.axes)]
Variant = Annotated[
    str | None, valued("NAME", "Variant of the file; default: its own values.", names=completion.variants)
]
Regimes = Annotated[
    list[str] | None,
    valued(
        "NAME",
        "Motion of the crank: run-up, run-up-cubic, run-up-quintic, constant-speed, a regime of the file, own (all of "
        "these), or all; with --from and --to: constant-speed, cubic, polynomial, cycloidal, modified-sine, or all; "
        "repeatable; default: run-up (bench: run-up-quintic and run-up), with --from and --to constant-speed.",
        "--regime",
        names=completion.regimes,
    ),
]
Engines = Annotated[
    list[str] | None,
    valued("NAME", "Engine; repeatable; default: all.", "--engine", names=completion.engines),
]
Settings = Annotated[
    list[str] | None,
    valued(
        "NAME",
        "naive, tuned, best, or all; repeatable; default: tuned (stress: a setting or a fixed-step method; default: "
        "those of each map).",
        "--setting",
        names=completion.settings,
    ),
]
Quantities = Annotated[
    list[str] | None,
    valued(
        "NAME",
        "Quantity, such as Mkr; repeatable; default: all (bench: Mkr, Jeq, phi, joint_force).",
        "--quantity",
        names=completion.quantities,
    ),
]
Json = Annotated[str | None, valued("FILE|-", "Write JSON to a file; - is stdout.", "--json")]
Out = Annotated[Path | None, valued("DIR", "Write records, curves and pages into this folder.", "--out")]
Resume = Annotated[bool, flag("Finish an interrupted run of the same command in --out.", "--resume")]
Quiet = Annotated[bool, flag("No progress and no tables, only the closing line.", "-q", "--quiet")]
Verbose = Annotated[bool, flag("Add the details of every record.", "-v", "--verbose")]
Jobs = Annotated[int | None, valued("N", "Worker processes; default: one per core; compare: 0 for none, no limits.")]
Scheduler = Annotated[
    str | None,
    valued("ADDRESS", "Run on the workers of a Dask scheduler, tcp://HOST:8786, or on N of this machine, local:N."),
]
SteadyRegime = Annotated[
    str | None, typer.Option("--regime", metavar="NAME", hidden=True)
]  # constant-speed, or refused
Speed = Annotated[
    float | None,
    valued("RPM", "Final crank speed, or the largest of a swing; negative turns clockwise; default: 1000.", "--speed"),
]
RampTime = Annotated[float, valued("SECONDS", "Time to reach this speed.")]
HoldTime = Annotated[float, valued("SECONDS", "Time at this speed.")]
StartAngle = Annotated[float, valued("DEGREES", "Crank angle at the start.")]
FromAngle = Annotated[float | None, valued("DEGREES", "Crank angle at the start of a swing.", "--from")]
ToAngle = Annotated[float | None, valued("DEGREES", "Crank angle at the end of a swing.", "--to")]
Clockwise = Annotated[bool, flag("Turn the crank clockwise.", "--clockwise")]
Strict = Annotated[bool, flag("Refuse a file with likely mistakes: units, masses, load tables.", "--strict")]
ScaleMass = Annotated[
    bool, flag("Scale mass and inertia of a link with its lengths; default: as in the file.", "--scale-mass")
]
NoGravity = Annotated[bool, flag("Switch gravity off.", "--no-gravity")]
