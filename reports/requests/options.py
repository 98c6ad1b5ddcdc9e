"""The options of every request, how they are declared, and the command that repeats a request.

An option is an annotated field of a frozen dataclass: the command line, the keywords of the Python function and the
command in saved results are all derived from it.
"""

from __future__ import annotations

import shlex
from collections.abc import Iterable
from dataclasses import Field, dataclass, fields
from pathlib import Path
from typing import Annotated, Any, Final, NamedTuple, get_args, get_origin, get_type_hints


@dataclass(frozen=True)
class Option:
    """An option of a command: its ``help``, the ``metavar`` of its value, its ``flags`` if they differ from its field.

    ``names`` is the function of ``reports.command_line.completion`` by which a shell completes it. A command that
    repeats the request leaves out an option without ``affects_results``.
    """

    help: str
    metavar: str = ""
    flags: tuple[str, ...] = ()
    names: str = ""
    affects_results: bool = True


@dataclass(frozen=True)
class Argument:
    """A positional argument of a command; the help of the command explains it."""

    metavar: str
    names: str = ""
    is_required: bool = False


class DeclaredOption(NamedTuple):
    """A field that is an option or an argument, with the type of its value."""

    field: Field[Any]
    kind: Any
    info: Option | Argument

    @property
    def name(self) -> str:
        """The option as it is typed, without the dashes."""
        flags = self.info.flags if isinstance(self.info, Option) else ()
        return flags[-1].removeprefix("--") if flags else self.field.name.replace("_", "-")


def declared_options(options: Any) -> tuple[DeclaredOption, ...]:  # noqa: ANN401 - a dataclass
    """The options and arguments of a dataclass, in order."""
    hints = get_type_hints(options, include_extras=True)
    annotated = [(field, hints[field.name]) for field in fields(options) if get_origin(hints[field.name]) is Annotated]
    return tuple(DeclaredOption(field, *get_args(hint)) for field, hint in annotated)


def changed_options(options: Any) -> dict[str, tuple[str, ...]]:  # noqa: ANN401 - a dataclass
    """Options that differ from their defaults and affect the results, by name, each with its words as typed.

    A flag has no words. The command that repeats a request is written from them.
    """
    groups = {}
    for option in declared_options(type(options)):
        value = getattr(options, option.field.name)
        if isinstance(option.info, Option) and option.info.affects_results and value != option.field.default:
            groups[option.name] = () if isinstance(value, bool) else tuple(map(typed_word, _values_of(value)))
            if member_type(option.kind) is float:
                groups[option.name] = (",".join(groups[option.name]),)  # numbers are one word
    return groups


def command_line(command: str, *options: Any) -> str:  # noqa: ANN401 - dataclasses
    """The command that repeats a request: its arguments, its options with their values, and its flags."""
    arguments = [
        str(word)
        for each in options
        for option in declared_options(type(each))
        if isinstance(option.info, Argument)
        for word in _values_of(getattr(each, option.field.name))
    ]
    given = {name: values for each in options for name, values in changed_options(each).items()}
    valued = [word for name, values in given.items() for value in values for word in (f"--{name}", value)]
    flags = [f"--{name}" for name, values in given.items() if not values]
    return shlex.join(["linkproof", command, *arguments, *valued, *flags])


def member_type(kind: Any) -> type | None:  # noqa: ANN401 - a type
    """The type of the members of a tuple, which may be optional; None for another type."""
    kinds = (kind, *get_args(kind))
    return next((get_args(entry)[0] for entry in kinds if get_origin(entry) is tuple), None)


def _values_of(value: Any) -> Iterable[Any]:  # noqa: ANN401 - of any option
    """The members of a tuple, or a single value; empty for None."""
    return value if isinstance(value, tuple) else () if value is None else (value,)


def typed_word(value: Any) -> str:  # noqa: ANN401 - of any option
    """A value as it is typed: every digit of a number, a whole one without a point."""
    return repr(float(value)).removesuffix(".0") if isinstance(value, float | int) else str(value)


# The files of a command's results, and the amount of its output.

Json = Annotated[bool, Option("Print JSON on stdout in place of the tables.")]


@dataclass(frozen=True, kw_only=True)
class OutputOptions:
    """``json`` is printed in place of everything else; ``out`` is a folder for all files of a command.

    ``save`` has single files, each in the format of its suffix, ``junit`` a file of test cases for CI services.
    ``quiet`` prints no progress and no tables, ``verbose`` adds the details of every record.
    """

    out: Annotated[Path | None, Option("Write records, curves and pages into this folder.", "DIR")] = None
    save: Annotated[tuple[Path, ...], Option("Write a file in the format of its suffix; repeatable.", "FILE")] = ()
    json: Json = False
    junit: Annotated[Path | None, Option("Write every verdict as a test case, in JUnit's XML.", "FILE")] = None
    quiet: Annotated[bool, Option("No progress and no tables, only the closing line.", flags=("-q", "--quiet"))] = False
    verbose: Annotated[bool, Option("Add the details of every record.", flags=("-v", "--verbose"))] = False


# The motion of the crank: options of every command that moves a linkage.

USUAL_SPEED = 1000.0  # rpm
TIMED = ("ramp_time", "hold_time", "start_angle")  # of a crank that turns on: no swing has them

Variant = Annotated[str | None, Option("Variant of the file; default: its own values.", "NAME", names="variants")]


@dataclass(frozen=True, kw_only=True)
class MotionOptions:
    """The requested motion of the crank: names, rpm, seconds and degrees; without a regime the default.

    A negative ``speed`` turns clockwise; None is ``USUAL_SPEED``, of a drive along a line its mean. With ``from_angle``
    and ``to_angle`` the crank swings from one to the other, and the regime is the law of motion. Of a drive along
    a line ``speed``, ``from_angle`` and ``to_angle`` are in its file's unit of length.
    """

    variant: Variant = None
    regime: Annotated[
        tuple[str, ...],
        Option(
            "Motion of the crank: run-up, run-up-cubic, run-up-quintic, constant-speed, a regime of the file, own "
            "(all of these), or all; with --from and --to: constant-speed, cubic, polynomial, cycloidal, "
            "modified-sine, or all; repeatable; default: run-up (bench: run-up-quintic and run-up; results: one "
            "turn at constant speed), with --from and --to constant-speed.",
            "NAME",
            names="regimes",
        ),
    ] = ()
    speed: Annotated[
        float | None,
        Option(
            "Final crank speed, or the largest of a swing; negative turns clockwise; 0 in results; default: 1000.",
            "RPM",
        ),
    ] = None
    ramp_time: Annotated[float, Option("Time to reach this speed.", "SECONDS")] = 0.6
    hold_time: Annotated[float, Option("Time at this speed.", "SECONDS")] = 0.1
    start_angle: Annotated[float, Option("Crank angle at the start.", "DEGREES")] = 0.0
    from_angle: Annotated[float | None, Option("Crank angle at the start of a swing.", "DEGREES", ("--from",))] = None
    to_angle: Annotated[float | None, Option("Crank angle at the end of a swing.", "DEGREES", ("--to",))] = None
    clockwise: Annotated[bool, Option("Turn the crank clockwise.")] = False
    gravity: Annotated[bool, Option("Switch gravity off.", flags=("--no-gravity",))] = True

    @property
    def motion(self) -> MotionOptions:
        """The options of the motion alone."""
        return MotionOptions(**{field.name: getattr(self, field.name) for field in fields(MotionOptions)})

    @property
    def rpm(self) -> float:
        """The speed, rpm, negative if clockwise."""
        return USUAL_SPEED if self.speed is None else self.speed

    @property
    def turns_back(self) -> bool:
        """Whether the crank turns clockwise."""
        return self.clockwise or self.rpm < 0.0

    @property
    def swings(self) -> bool:
        """Whether the crank goes from one angle to another."""
        return self.from_angle is not None or self.to_angle is not None

    @property
    def conditions(self) -> str:
        """Speed, direction, times and angles in words, without gravity, which belongs to the linkages."""
        turns_back = self.turns_back
        if self.from_angle is not None and self.to_angle is not None:
            turns_back = self.to_angle < self.from_angle
        turning = f"{abs(self.rpm):g} rpm {'clockwise' if turns_back else 'counter-clockwise'}"
        if self.swings:
            return f"from {self.from_angle:g}° to {self.to_angle:g}°, at most {turning}"
        return f"{turning}, {self.ramp_time:g} s + {self.hold_time:g} s, from {self.start_angle:g}°"


# The commands about one linkage under one motion: results, watch and judge.

DEFAULT_LIMIT = 0.01  # of the peak


@dataclass(frozen=True, kw_only=True)
class ResultsOptions(MotionOptions):
    """The motion and the instants of ``linkproof results``."""

    mechanism: Annotated[str, Argument("MECHANISM", "mechanisms", is_required=True)] = ""
    at: Annotated[tuple[float, ...] | None, Option("Every signal at these crank angles: 0,30,60.", "DEGREES")] = None
    time: Annotated[tuple[float, ...] | None, Option("Every signal at these times: 0.1,0.2.", "SECONDS")] = None


@dataclass(frozen=True, kw_only=True)
class WatchOptions(ResultsOptions):
    """The motion of ``linkproof watch``, and whether it ``opens`` a browser."""

    opens: Annotated[bool, Option("Open no browser, only print the address.", flags=("--no-open",))] = True


@dataclass(frozen=True, kw_only=True)
class ResultsFiles:
    """The form of the files of ``linkproof results``.

    ``decimal`` is the point or comma in the numbers of a CSV file, ``figure`` the single picture to draw instead of
    all.
    """

    decimal: Annotated[str, Option("Decimal mark of a .csv; with a comma, semicolons between columns.", ".|,")] = "."
    figure: Annotated[
        str | None,
        Option(
            "Draw one figure alone, as wide as a paper's column: scheme, curves, torque, power, energy, inertia, "
            "output, forces, transmission.",
            "NAME",
        ),
    ] = None


@dataclass(frozen=True, kw_only=True)
class JudgeOptions(MotionOptions):
    """The results for ``linkproof judge``; ``limit`` is a share of the peak."""

    mechanism: Annotated[str, Argument("MECHANISM", "mechanisms", is_required=True)] = ""
    results: Annotated[tuple[Path, ...], Argument("RESULTS", is_required=True)] = ()
    map: Annotated[
        tuple[str, ...],
        Option(
            "What a column is, such as 'Motor Torque12=-Mkr [N*mm]', nothing after = to leave it out; or a file of "
            "such lines; repeatable.",
            "COLUMN=SIGNAL",
        ),
    ] = ()
    encoding: Annotated[
        str, Option("Encoding of files that are not UTF-8 or UTF-16, such as cp1252 or cp1251.", "NAME")
    ] = ""
    limit: Annotated[float, Option("Largest error allowed, as a share of the closed form's peak.", "SHARE")] = (
        DEFAULT_LIMIT
    )


# Runs of engines that compare, bench and stress make.

Engines = Annotated[
    tuple[str, ...], Option("Engine; repeatable; default: all that are installed.", "NAME", names="engines")
]
Settings = Annotated[
    tuple[str, ...],
    Option(
        "naive, tuned, best, or all; repeatable; default: tuned (stress: a setting or a fixed-step method; default: "
        "those of each map).",
        "NAME",
        names="settings",
    ),
]
Jobs = Annotated[
    int | None,
    Option("Worker processes; default: one per core; compare: 0 for none, no limits.", "N", affects_results=False),
]
Scheduler = Annotated[
    str | None,
    Option("Make the runs on the workers of this Dask scheduler.", "ADDRESS", affects_results=False),
]


@dataclass(frozen=True, kw_only=True)
class RunsOptions(MotionOptions):
    """Linkages, engines, settings and quantities of runs; empty means the default."""

    mechanisms: Annotated[tuple[str, ...], Argument("MECHANISM", "mechanisms")] = ()
    engine: Engines = ()
    setting: Settings = ()
    quantity: Annotated[
        tuple[str, ...],
        Option(
            "Quantity, such as Mkr; repeatable; default: all (bench: Mkr, Jeq, phi, joint_force).",
            "NAME",
            names="quantities",
        ),
    ] = ()


@dataclass(frozen=True, kw_only=True)
class CompareOptions(RunsOptions):
    """The runs of ``linkproof compare``."""

    full: Annotated[bool, Option("Run the files' regimes in every setting, not only in tuned.")] = False


@dataclass(frozen=True, kw_only=True)
class BenchOptions(RunsOptions):
    """The runs of ``linkproof bench``, which has settings and methods of its own."""

    quick: Annotated[bool, Option("Measure only the fronts, over one turn, in under a minute.")] = False


@dataclass(frozen=True, kw_only=True)
class StressOptions:
    """Stability maps or cells for ``linkproof stress``; empty means the default."""

    words: Annotated[tuple[str, ...], Argument("AXIS|CELL", "axes")] = ()
    engine: Engines = ()
    setting: Settings = ()
    quick: Annotated[bool, Option("Fewer cells, coarser borders: about a minute.")] = False


@dataclass(frozen=True, kw_only=True)
class StandardOptions:
    """Files of limits, and of results recorded before."""

    limits: Annotated[Path | None, Option("Your limits, which precede the suite's.", "FILE")] = None
    against: Annotated[
        Path | None,
        Option(
            "Compare with results that --record wrote or that are in a folder of --out: what newly fails, has grown "
            "threefold, has vanished or has changed fails.",
            "FILE|DIR",
        ),
    ] = None
    record: Annotated[
        Path | None,
        Option(
            "Write errors, and figures of the closed form, into this CSV file for --against.",
            "FILE",
            affects_results=False,
        ),
    ] = None


@dataclass(frozen=True, kw_only=True)
class RunLimits:
    """Limits of each run, s and GiB, and worker processes, or those of a Dask scheduler; None means the default."""

    time_limit: Annotated[float | None, Option("Wall time that one run may take; default: 600.", "SECONDS")] = None
    memory_limit: Annotated[float | None, Option("Memory that one run may add; default: 4.", "GIB")] = None
    jobs: Jobs = None
    scheduler: Scheduler = None


# The commands about many designs of one linkage: sweep, optimise, tolerance.

NOT_STEADY: Final = (*TIMED, "regime")  # options of a motion that is not at constant speed


@dataclass(frozen=True, kw_only=True)
class SteadyOptions(MotionOptions):
    """A motion at constant speed, without the options ``NOT_STEADY``."""

    mechanism: Annotated[str, Argument("MECHANISM", "mechanisms", is_required=True)] = ""
    scale_mass: Annotated[
        bool, Option("Scale mass and inertia of a link with its lengths; default: as in the file.")
    ] = False
    refine: bool = True


@dataclass(frozen=True, kw_only=True)
class _Designs:
    """The designs of a sweep, and the figures to compute; the first in the help."""

    vary: Annotated[
        tuple[str, ...],
        Option(
            "Values of a number of the file or of the speed, in the file's units or others: rod.B.x=17cm:18cm:100; "
            "several make a grid.",
            "NAME=FIRST:LAST:COUNT",
            names="parameters",
        ),
    ] = ()
    table: Annotated[Path | None, Option("Designs one by one: columns rod.B.x or rod.B.x [mm].", "CSV")] = None
    quantity: Annotated[
        tuple[str, ...],
        Option(
            "Figure of a design: SIGNAL.peak, .mean, .rms, .max, .min or .range, SIGNAL@DEGREES, joint_force.peak of "
            "every joint, stroke; repeatable; default: peaks of torque and joint forces, least transmission angles, "
            "the stroke.",
            "NAME",
            names="figures",
        ),
    ] = ()


@dataclass(frozen=True, kw_only=True)
class SweepOptions(SteadyOptions, _Designs):
    """The designs of ``linkproof sweep``."""

    refine: Annotated[bool, Option("Find the exact extremes between the sampled angles.")] = False


@dataclass(frozen=True, kw_only=True)
class _Aim:
    """The aim of an optimisation, its variables, and the figures to hold; the first in the help."""

    minimise: Annotated[str | None, Option("Minimise this figure, such as Mkr.peak.", "FIGURE", names="figures")] = None
    maximise: Annotated[str | None, Option("Maximise it: transmission_angle.min.", "FIGURE", names="figures")] = None
    over: Annotated[
        tuple[str, ...],
        Option(
            "A number of the file, or the speed, to vary within bounds, or NAME=±10%; repeatable.",
            "NAME=LOW:HIGH",
            names="parameters",
        ),
    ] = ()
    keep: Annotated[
        tuple[str, ...],
        Option(
            "Hold a figure at its present value, at =VALUE, or in a range; repeatable.",
            "FIGURE[=LOW:HIGH]",
            names="figures",
        ),
    ] = ()


@dataclass(frozen=True, kw_only=True)
class OptimiseOptions(SteadyOptions, _Aim):
    """The optimisation of ``linkproof optimise``."""

    everywhere: Annotated[bool, Option("Search the whole region within the bounds.", flags=("--global",))] = False
    step: Annotated[
        str | None, Option("Round lengths to this step, such as 0.1mm, and report the loss.", "STEP", ("--round",))
    ] = None


@dataclass(frozen=True, kw_only=True)
class ToleranceOptions(SteadyOptions):
    """The tolerances of ``linkproof tolerance``."""

    tolerances: Annotated[Path, Argument("TOLERANCES.toml", is_required=True)] = Path()
    samples: Annotated[
        int | None, Option("Random designs; default: 10000, 200 where a group has no closed form.", "N")
    ] = None
