"""Options and arguments shared by several commands, with their help and shell completion."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import Field, fields, is_dataclass
from functools import cache, wraps
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args, get_origin, get_type_hints

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


Command = TypeVar("Command", bound=Callable[..., Any])


def with_choices(*, without: Sequence[str] = (), hidden: Sequence[str] = ()) -> Callable[[Command], Command]:
    """A command whose arguments of a dataclass are given by options, one for each annotated field of it.

    A list stands for a tuple, and a flag says that what is True by default is not. Fields ``without`` have no option,
    ``hidden`` ones are not in the help.
    """

    def decorated(command: Command) -> Command:
        hints = get_type_hints(command, include_extras=True)
        choices: dict[str, Any] = {name: kind for name, kind in hints.items() if is_dataclass(kind)}
        parameters: list[inspect.Parameter] = []
        for parameter in inspect.signature(command).parameters.values():
            kind = choices.get(parameter.name)
            if kind is None:
                parameters.append(parameter.replace(annotation=hints[parameter.name]))
            else:
                wanted = [(one, *rest) for one, *rest in _options(kind) if one.name not in without]
                parameters += [_parameter(*one, is_hidden=one[0].name in hidden) for one in wanted]

        @wraps(command)
        def called(**given: Any) -> object:  # noqa: ANN401 - what the command takes
            for name, kind in choices.items():
                own = {one.name: _value(one, given.pop(one.name)) for one, *_ in _options(kind) if one.name in given}
                given[name] = kind(**own)
            return command(**given)

        called.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        called.__annotations__ = {one.name: one.annotation for one in parameters}
        del called.__wrapped__  # whose own signature would be read in place of this one
        return called  # type: ignore[return-value]

    return decorated


def stated(choice: Any) -> dict[str, tuple[str, ...]]:  # noqa: ANN401 - a dataclass
    """The options that differ from their defaults, by name, each with its values: none of a flag."""
    found = {}
    for one, _, info in _options(choice.__class__):
        value = getattr(choice, one.name)
        if value != one.default:
            several = value if isinstance(value, tuple) else () if isinstance(value, bool) else (value,)
            name = info.default if isinstance(info.default, str) else one.name.replace("_", "-")  # as typer holds it
            found[name.removeprefix("--")] = tuple(
                repr(float(each)).removesuffix(".0") if isinstance(each, float | int) else str(each) for each in several
            )
    return found


@cache
def _options(kind: Any) -> list[tuple[Field[Any], Any, OptionInfo]]:  # noqa: ANN401 - a dataclass
    """The fields of a dataclass that are options, each with its type and how it is shown."""
    hints = get_type_hints(kind, include_extras=True)
    return [(one, *get_args(hints[one.name])) for one in fields(kind) if get_origin(hints[one.name]) is Annotated]


def _parameter(one: Field[Any], kind: Any, info: OptionInfo, *, is_hidden: bool) -> inspect.Parameter:  # noqa: ANN401
    """The option of a field as a parameter of a command."""
    default = one.default
    if isinstance(default, tuple):
        kind, default = list[str] | None, None
    elif default is True:
        default = False
    if is_hidden:
        info = copy(info)
        info.hidden = True
    way = inspect.Parameter.POSITIONAL_OR_KEYWORD
    return inspect.Parameter(one.name, way, default=default, annotation=Annotated[kind, info])


def _value(one: Field[Any], given: Any) -> Any:  # noqa: ANN401 - of any option
    """What a field is, of what typer gives."""
    if isinstance(one.default, tuple):
        return tuple(given or ())
    return not given if one.default is True else given


Mechanism = Annotated[str, words("MECHANISM", completion.mechanisms)]
Mechanisms = Annotated[list[str] | None, words("MECHANISM", completion.mechanisms)]
Cells = Annotated[list[str] | None, words("AXIS|CELL", completion.axes)]
Variant = Annotated[
    str | None, valued("NAME", "Variant of the file; default: its own values.", names=completion.variants)
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
Strict = Annotated[bool, flag("Refuse a file with likely mistakes: units, masses, load tables.", "--strict")]
ScaleMass = Annotated[
    bool, flag("Scale mass and inertia of a link with its lengths; default: as in the file.", "--scale-mass")
]
