"""The options of every function of ``linkproof``: how they are declared, what they share, how a call is repeated.

An option is an annotated parameter, or a field of a frozen dataclass that is a parameter. The command line and the
command in saved results are derived from it. A module of such functions annotates without ``from __future__``.
"""

from __future__ import annotations

import inspect
import math
import shlex
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import Field, dataclass, fields, is_dataclass
from functools import cache, wraps
from numbers import Integral, Real
from pathlib import Path
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    Final,
    NamedTuple,
    ParamSpec,
    TypeVar,
    get_args,
    get_origin,
    get_type_hints,
)

from analytic.errors import LinkproofError, shortened

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from analytic.description.linkage import Linkage

    LinkageLike = str | Path | Mapping[str, Any] | Linkage
    Numbers = Sequence[float] | NDArray[np.float64] | float | str
else:  # help and completion do without numpy
    LinkageLike, Numbers = Any, Sequence[float]

P = ParamSpec("P")
R = TypeVar("R")
Words = str | Iterable[str]  # a name, or several
Ranges = Mapping[str, str | float | tuple[float | None, float | None] | None] | Sequence[str]
Announce = Callable[[str, int, int], None]  # the label of a run, its number, the number of all


def silent(_label: str, _number: int, _count: int) -> None:
    """Ignore an announcement: the label of a run, its number, the number of all."""


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


class Positive(Option):
    """An option whose value is a positive finite number."""


@dataclass(frozen=True)
class Argument:
    """A positional argument of a command; the help of the command explains it.

    ``names`` is as of ``Option``.
    """

    metavar: str
    names: str = ""


class DeclaredOption(NamedTuple):
    """A parameter, or a field of a parameter's dataclass, that is an option or an argument, with its value's type.

    ``group`` is the name of the parameter whose dataclass has the field, "" without one.
    """

    field: Field[Any] | inspect.Parameter
    kind: Any
    info: Option | Argument
    group: str = ""

    @property
    def name(self) -> str:
        """The option as typed, without the dashes in front: the last of its flags, or its field's name with dashes."""
        flags = self.info.flags if isinstance(self.info, Option) else ()
        return flags[-1].removeprefix("--") if flags else self.field.name.replace("_", "-")


@cache
def declared_options(source: Any) -> tuple[DeclaredOption, ...]:  # noqa: ANN401 - a dataclass or a function
    """The options and arguments of a function, those of its dataclasses last; or those of a dataclass; in order.

    Kept for each. A parameter that is not annotated as one is left out.
    """
    if is_dataclass(source):
        hints = get_type_hints(source, include_extras=True)
        annotated: list[tuple[Any, Any]] = [(field, hints[field.name]) for field in fields(source)]
    else:
        annotated = [(each, each.annotation) for each in inspect.signature(source).parameters.values()]
    own = [DeclaredOption(field, *get_args(hint)) for field, hint in annotated if get_origin(hint) is Annotated]
    groups = option_groups(source).items()
    return (*own, *(each._replace(group=name) for name, kind in groups for each in declared_options(kind)))


def option_groups(function: Callable[..., Any]) -> dict[str, type]:
    """The dataclasses of options among a function's defaults, by the name of the parameter."""
    parameters = inspect.signature(function).parameters.values()
    return {each.name: type(each.default) for each in parameters if is_dataclass(type(each.default))}


def arguments(function: Callable[..., Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments of a call by name, from the value of every option by its field's name, each in its one form.

    Raises LinkproofError for a value of another type, KeyError for an option without a value.
    """
    given: dict[str, dict[str, Any]] = {"": {}}
    for option in declared_options(function):
        given.setdefault(option.group, {})[option.field.name] = option_value(option, values[option.field.name])
    return given[""] | {name: kind(**given[name]) for name, kind in option_groups(function).items()}


def member_type(kind: Any) -> type | None:  # noqa: ANN401 - a type
    """The type of a tuple's or sequence's members, Path if that is one of several; None for another type.

    A tuple or sequence within a union counts.
    """
    kinds = (kind, *get_args(kind))
    member = next((get_args(entry)[0] for entry in kinds if get_origin(entry) in (tuple, Sequence)), None)
    return Path if Path in get_args(member) else member


# Values: each is checked by the type of its option, whether it comes from Python or as a word.

UNITS: Final = {
    "RPM": " of rpm", "SECONDS": " of s", "DEGREES": " of degrees", "GIB": " of GiB", "SHARE": ", such as 0.01",
}  # fmt: skip


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """The function, made to check each annotated argument of a call, and to give each its one form: names in tuples.

    Paths become Path. The function raises LinkproofError for an argument of another type.
    """
    signature, groups = inspect.signature(function), option_groups(function)
    options = {option.field.name: option for option in declared_options(function) if not option.group}

    @wraps(function)
    def called(*args: P.args, **words: P.kwargs) -> R:
        """Call the function with its arguments checked and in their one form.

        Raises LinkproofError for one of another type, TypeError for arguments that the function does not take.
        """
        bound = signature.bind(*args, **words)
        for name, given in bound.arguments.items():
            if name in options:
                bound.arguments[name] = option_value(options[name], given)
            elif name in groups and type(given) is not groups[name]:
                kind = groups[name].__name__
                raise LinkproofError(f"{name}: expected a {kind}, got {shortened(repr(given))}; pass {kind}(...)")
        return function(*bound.args, **bound.kwargs)

    return called


def option_value(option: DeclaredOption, given: Any) -> Any:  # noqa: ANN401, PLR0911 - of any option, a type each
    """The value of an option in its one form: several in a tuple, paths as Path.

    None is the default where it is allowed. A mapping of ranges becomes words, "rod.B.x=170:180"; other mappings, and
    what may be anything, stay. Raises LinkproofError for a value of another type.
    """
    name, kinds = option.field.name, (option.kind, *get_args(option.kind))
    several = member_type(option.kind)
    if option.kind is Any:
        return given
    if given is None and (type(None) in kinds or several is str):
        return option.field.default
    if several is float:
        return _numbers(option, given)
    if several is Any:
        return words(given)
    if option.kind == Ranges and isinstance(given, Mapping):
        return tuple(range_word(*pair) for pair in given.items())
    if several is not None:
        return given if isinstance(given, Mapping) else tuple(map(several, words(given)))
    if float in kinds or int in kinds:
        return _number(option, given)
    if bool in kinds and not isinstance(given, bool) and type(given).__name__ != "bool":  # numpy's has that name, too
        raise LinkproofError(f"{name}: expected True or False, got {shortened(repr(given))}; pass one of them")
    if Path in kinds:
        return Path(given)
    return str(given) if str in kinds else given


def words(given: Any) -> tuple[Any, ...]:  # noqa: ANN401 - whatever is passed
    """One value, or the members of an iterable, as a tuple; a text, path or mapping is one value."""
    is_one = isinstance(given, str | Path | Mapping) or not isinstance(given, Iterable)
    return (given,) if is_one else tuple(given)


def _numbers(option: DeclaredOption, given: Any) -> tuple[float, ...]:  # noqa: ANN401 - whatever is passed
    """A number or several as a tuple of numbers; a text has commas between them; raises LinkproofError otherwise.

    Those of a text become floats and have to be finite.
    """
    import numpy as np  # noqa: PLC0415 - help does without

    if not isinstance(given, str):
        return tuple(_number(option, each) for each in np.atleast_1d(np.asarray(given, dtype=object)).tolist())
    try:
        numbers = tuple(map(float, given.split(",")))
    except ValueError:
        numbers = (math.nan,)
    if not all(map(math.isfinite, numbers)):
        raise LinkproofError(
            f"--{option.name}: expected finite numbers with commas between them, such as 0,30,60, got '{given}'; "
            "correct it"
        )
    return numbers


def _number(option: DeclaredOption, value: Any) -> float:  # noqa: ANN401 - whatever is passed
    """A number, unchanged; raises LinkproofError for anything else, True and False included.

    It has to be whole, or positive and finite, where the option is.
    """
    is_whole, unit = int in (option.kind, *get_args(option.kind)), UNITS.get(option.info.metavar, "")
    if isinstance(value, bool) or not isinstance(value, Integral if is_whole else Real):
        what = "a whole number" if is_whole else "a number"
        raise LinkproofError(f"{option.field.name}: expected {what}{unit}, got {shortened(repr(value))}; pass a number")
    if isinstance(option.info, Positive) and not 0.0 < float(value) < math.inf:
        raise LinkproofError(f"--{option.name}: expected a positive finite number{unit}, got {value:g}; correct it")
    return value  # type: ignore[return-value]


# The command that repeats a call, and the options of a call that a folder keeps.


def command_line(function: Callable[..., Any], given: Mapping[str, Any], without: Sequence[str] = ()) -> str:
    """The command that repeats a call, as text: arguments, options with values, flags; defaults are left out.

    ``given`` are the arguments of the function by name; groups and options ``without`` are left out, too, and those
    that do not affect results.
    """
    return shlex.join(["linkproof", function.__name__, *option_words(function, changed(function, given, without))])


def option_words(source: Any, values: Mapping[str, Any]) -> list[str]:  # noqa: ANN401 - a dataclass or a function
    """Options' ``values``, by the names of their fields, as words of a command: arguments, options with values, flags.

    A bool, be it True or False, is a flag; an option without a value, or with None, is left out.
    """
    words: tuple[list[str], list[str], list[str]] = ([], [], [])  # arguments, options with values, flags
    for option in declared_options(source):
        value = values.get(option.field.name)
        if isinstance(option.info, Argument):
            words[0].extend(map(str, _values_of(value)))
        elif isinstance(value, bool):
            words[2].append(f"--{option.name}")
        else:
            words[1].extend(word for typed in _typed(option, value) for word in (f"--{option.name}", typed))
    return [word for part in words for word in part]


def changed(source: Any, given: Mapping[str, Any], without: Sequence[str] = ()) -> dict[str, Any]:  # noqa: ANN401
    """The options of a function or a dataclass that affect results and differ from their defaults, by field's name.

    ``given`` are the arguments or fields by name; groups and options ``without`` are left out. Their values are
    unchanged.
    """
    return {
        option.field.name: value
        for option, value in _options_with_values(source, given)
        if value != option.field.default
        and (isinstance(option.info, Argument) or option.info.affects_results)
        and not {option.group, option.field.name} & {*without}
    }


def with_values(function: Callable[..., Any], given: Mapping[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments of a call, ``given`` by name, with other ``values`` of some options, by their fields' names.

    A new dict; the values are checked. Raises LinkproofError for one of another type.
    """
    every = {option.field.name: value for option, value in _options_with_values(function, given)}
    arguments_given = {name: given[name] for name in inspect.signature(function).parameters}
    return arguments_given | arguments(function, {**every, **values})


def _options_with_values(source: Any, given: Mapping[str, Any]) -> Iterator[tuple[DeclaredOption, Any]]:  # noqa: ANN401
    """Yield each option of a function or a dataclass, with its value among the ``given``."""
    for option in declared_options(source):
        holder = vars(given[option.group]) if option.group else given
        yield option, holder[option.field.name]


def _typed(option: DeclaredOption, value: Any) -> tuple[str, ...]:  # noqa: ANN401 - of any option
    """An option's value as words of a command, one for each member, numbers in one with commas; () for None."""
    typed = tuple(map(typed_word, _values_of(value)))
    return (",".join(typed),) if member_type(option.kind) is float else typed  # numbers are one word


def range_word(name: str, values: Any) -> str:  # noqa: ANN401 - of a mapping of names
    """A number's name with its range as the command line takes it: "rod.B.x=170:180"; the name alone for None.

    ``values`` are a pair (low, high), None for an end that is unbounded, a text such as "±10%", a number or None.
    """
    if values is None:
        return name
    if isinstance(values, tuple):
        return f"{name}={':'.join('' if end is None else typed_word(float(end)) for end in values)}"
    return f"{name}={values if isinstance(values, str) else typed_word(float(values))}"


def _values_of(value: Any) -> Iterable[Any]:  # noqa: ANN401 - of any option
    """The members of a tuple, or a single value as the only member; () for None."""
    return value if isinstance(value, tuple) else () if value is None else (value,)


def typed_word(value: Any) -> str:  # noqa: ANN401 - of any option
    """A value as a user types it: all digits of a number, no point behind a whole one, other values by ``str``."""
    return repr(float(value)).removesuffix(".0") if isinstance(value, float | int) else str(value)


# The files of a command's results, and the amount of its output.

OUT = Option("Write records, curves and pages into this folder.", "DIR", affects_results=False)
Out = Annotated[str | Path | None, OUT]


@dataclass(frozen=True, kw_only=True)
class OutputOptions:
    """``json`` is printed in place of everything else; ``out`` is a folder for all files of a command.

    ``save`` has single files, each in the format of its suffix: ``decimal`` is the point or comma in the numbers of a
    CSV file, ``figure`` the single picture to draw instead of all. ``quiet`` prints no progress and no tables,
    ``verbose`` adds the details of every record, ``opens`` shows the page in ``out`` in the browser.
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
    out: Annotated[Path | None, OUT] = None
    save: Annotated[tuple[Path, ...], Option("Write a file in the format of its suffix; repeatable.", "FILE")] = ()
    json: Annotated[bool, Option("Print JSON on stdout in place of the tables.")] = False
    quiet: Annotated[bool, Option("No progress and no tables, only the closing line.", flags=("-q", "--quiet"))] = False
    opens: Annotated[bool, Option("Open the page in the browser.", flags=("--open",))] = False
    verbose: Annotated[bool, Option("Add the details of every record.", flags=("-v", "--verbose"))] = False


# The motion of the crank: options of every command that moves a linkage.

USUAL_SPEED = 1000.0  # rpm
TIMED = ("ramp_time", "hold_time", "start_angle")  # of a crank that turns on: no swing has them

Mechanism = Annotated[LinkageLike, Argument("MECHANISM", "mechanisms")]
Mechanisms = Annotated[LinkageLike | Sequence[LinkageLike], Argument("MECHANISM", "mechanisms")]
Strict = Annotated[bool, Option("Refuse a file with likely mistakes: units, masses, load tables.")]
Variant = Annotated[str | None, Option("Variant of the file; default: its own values.", "NAME", names="variants")]


class Checked:
    """Options each of which takes its one form; raises LinkproofError for a value of another type."""

    def __post_init__(self) -> None:
        """Give every option of this instance its one form; raises LinkproofError for a value of another type."""
        kind: Any = type(self)
        for option in declared_options(kind):
            name = option.field.name
            object.__setattr__(self, name, option_value(option, getattr(self, name)))


@dataclass(frozen=True, kw_only=True)
class SteadyMotion(Checked):
    """A motion of the crank at constant ``speed``, rpm, negative if clockwise, over a turn; None is ``USUAL_SPEED``.

    With ``from_angle`` and ``to_angle``, degrees, the crank swings from one to the other. Of a drive along a line these
    and the speed are in its file's unit of length.
    """

    variant: Variant = None
    speed: Annotated[
        float | None,
        Option(
            "Final crank speed, or the largest of a swing; negative turns clockwise; 0 in results; default: 1000.",
            "RPM",
        ),
    ] = None
    from_angle: Annotated[float | None, Option("Crank angle at the start of a swing.", "DEGREES", ("--from",))] = None
    to_angle: Annotated[float | None, Option("Crank angle at the end of a swing.", "DEGREES", ("--to",))] = None
    gravity: Annotated[bool, Option("Switch gravity off.", flags=("--no-gravity",))] = True

    @property
    def motion(self) -> Motion:
        """The same motion as a new ``Motion``, its other options the defaults."""
        return Motion(**vars(self))


@dataclass(frozen=True, kw_only=True)
class Motion(SteadyMotion):
    """The requested motion of the crank: names, rpm, seconds and degrees; without a regime the default.

    With ``from_angle`` and ``to_angle`` the regime is the law of motion; else as in ``SteadyMotion``.
    """

    regime: Annotated[
        Sequence[str],
        Option(
            "Motion of the crank: run-up, run-up-cubic, run-up-quintic, constant-speed, a regime of the file, own "
            "(all of these), or all; with --from and --to: constant-speed, cubic, polynomial, cycloidal, "
            "modified-sine, or all; repeatable; default: run-up (bench: run-up-quintic and run-up; results: one "
            "turn at constant speed), with --from and --to constant-speed.",
            "NAME",
            names="regimes",
        ),
    ] = ()
    ramp_time: Annotated[float, Option("Time to reach this speed.", "SECONDS")] = 0.6
    hold_time: Annotated[float, Option("Time at this speed.", "SECONDS")] = 0.1
    start_angle: Annotated[float, Option("Crank angle at the start.", "DEGREES")] = 0.0

    @property
    def rpm(self) -> float:
        """The speed, rpm, negative if clockwise; 1000 if none is given."""
        return USUAL_SPEED if self.speed is None else self.speed

    @property
    def turns_back(self) -> bool:
        """Whether the crank turns clockwise: the speed is negative, or -0 of one at rest."""
        return math.copysign(1.0, self.rpm) < 0.0  # of a crank at rest, -0, too

    @property
    def is_timed(self) -> bool:
        """Whether the time of a motion differs from the usual one."""
        return (self.ramp_time, self.hold_time) != (Motion.ramp_time, Motion.hold_time)

    @property
    def swings(self) -> bool:
        """Whether the crank goes from one angle to another: one end at least is given."""
        return self.from_angle is not None or self.to_angle is not None

    @property
    def conditions(self) -> str:
        """Speed, direction, times and angles in words, without gravity, which belongs to the linkages.

        Of a swing both ends have to be given, else TypeError is raised.
        """
        turns_back = self.turns_back
        if self.from_angle is not None and self.to_angle is not None:
            turns_back = self.to_angle < self.from_angle
        turning = f"{abs(self.rpm):g} rpm {'clockwise' if turns_back else 'counter-clockwise'}"
        if self.swings:
            return f"from {self.from_angle:g}° to {self.to_angle:g}°, at most {turning}"
        return f"{turning}, {self.ramp_time:g} s + {self.hold_time:g} s, from {self.start_angle:g}°"


# Runs of engines that compare, bench and stress make.

Engines = Annotated[
    Sequence[str], Option("Engine; repeatable; default: all that are installed.", "NAME", names="engines")
]
Jobs = Annotated[
    int | None, Option("Worker processes; default: one per core; 0: none, no limits.", "N", affects_results=False)
]
Scheduler = Annotated[
    str | None, Option("Make the runs on the workers of this Dask scheduler.", "ADDRESS", affects_results=False)
]


@dataclass(frozen=True, kw_only=True)
class Bounds(Checked):
    """Wall time, s, and memory, GiB, of each run, and worker processes or a Dask scheduler; None is the default.

    With ``jobs=0`` runs are made in this process, without limits.
    """

    time_limit: Annotated[float | None, Positive("Wall time that one run may take; default: 600.", "SECONDS")] = None
    memory_limit: Annotated[float | None, Positive("Memory that one run may add; default: 4.", "GIB")] = None
    jobs: Jobs = None
    scheduler: Scheduler = None
