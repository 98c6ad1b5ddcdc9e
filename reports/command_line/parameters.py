"""Commands of typer from functions whose arguments are declared options, single or in dataclasses."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import is_dataclass, replace
from functools import wraps
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, TypeVar, get_args, get_origin, get_type_hints

import typer
from typer.core import TyperCommand, TyperGroup

from analytic.errors import LinkproofError
from reports.command_line import completion, gone
from reports.requests.options import Argument, DeclaredOption, Option, declared_options, member_type

GLOSSARY = Path(__file__).parents[1] / "templates" / "glossary.txt"
REQUIRED = inspect.Parameter.empty
Bag = TypeVar("Bag")
NO_TEXTS: Mapping[str, str] = MappingProxyType({})


class InterruptedRunError(Exception):
    """Ctrl-C, which typer would turn into a silent exit; the message names the remaining runs."""


class CommandGroup(TyperGroup):
    """The commands, with a glossary of symbols below their help; Ctrl-C raises ``InterruptedRunError``."""

    def invoke(self, ctx: typer.Context) -> object:  # type: ignore[override]  # typer's own click, or click's
        """Run a command; typer would end silently at Ctrl-C."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as interrupt:
            raise InterruptedRunError(str(interrupt) or "nothing was written") from interrupt

    def resolve_command(self, ctx: typer.Context, args: list[str]) -> Any:  # type: ignore[override]  # noqa: ANN401
        """The command of the first word; raises LinkproofError for one that is gone."""
        if args[0] not in self.commands and not ctx.resilient_parsing and args[0] in gone.COMMANDS:
            raise LinkproofError(gone.answer_to_command(args[0]))
        return super().resolve_command(ctx, args)

    def get_help(self, ctx: typer.Context) -> str:  # type: ignore[override]
        """The help of typer and the glossary."""
        return f"{super().get_help(ctx)}\n\n{GLOSSARY.read_text(encoding='utf-8')}"


class LinkproofCommand(TyperCommand):
    """A command that answers an option that is gone with what to do instead."""

    def parse_args(self, ctx: typer.Context, args: list[str]) -> list[str]:  # type: ignore[override]
        """Parse the words; raises LinkproofError for an option that is gone."""
        answer = "" if ctx.resilient_parsing else gone.answer_to_json_file(args)
        try:
            if not answer:
                return super().parse_args(ctx, args)
        except Exception as error:
            option = getattr(error, "option_name", None)  # of typer's own NoSuchOption, or click's
            answer = gone.answer_to_option(self.name or "", option) if option else ""
            if not answer:
                raise
        raise LinkproofError(answer)


def command(
    app: typer.Typer,
    name: str | None = None,
    *,
    summary: str,
    without: Sequence[str] = (),
    texts: Mapping[str, str] = NO_TEXTS,
) -> Callable[[Callable[..., int | None]], Callable[..., int | None]]:
    """Add a function to the commands of an app; it may give the exit code.

    Every declared field of a dataclass becomes an option, except those ``without``; ``texts`` replace the help of some
    options in this command.
    """

    def add_command(function: Callable[..., int | None]) -> Callable[..., int | None]:
        hints = get_type_hints(function, include_extras=True)
        option_classes: dict[str, Any] = {each: kind for each, kind in hints.items() if is_dataclass(kind)}
        parameters: list[inspect.Parameter] = []
        for parameter in inspect.signature(function).parameters.values():
            kind = hints[parameter.name]
            if parameter.name in option_classes:
                chosen = [option for option in declared_options(kind) if option.field.name not in without]
                parameters += [_option_parameter(option, texts) for option in chosen]
            elif get_origin(kind) is Annotated:
                value, info = get_args(kind)
                parameters.append(_typer_parameter(parameter.name, value, info, parameter.default))

        @wraps(function)
        def called(**given: Any) -> None:  # noqa: ANN401 - of all options
            bags = {each: option_bag(kind, given) for each, kind in option_classes.items()}
            plain = {name: value for name, value in given.items() if name in hints and name not in bags}
            raise typer.Exit(function(**plain, **bags) or 0)

        called.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
        called.__annotations__ = {number.name: number.annotation for number in parameters}
        del called.__wrapped__  # its signature would replace this one
        app.command(name, cls=LinkproofCommand, short_help=summary)(called)
        return function

    return add_command


def option_bag(kind: type[Bag], given: Mapping[str, Any]) -> Bag:
    """A dataclass of options from the values that typer passes, by name."""
    options = {option.field.name: option for option in declared_options(kind)}
    return kind(**{name: _field_value(option, given[name]) for name, option in options.items() if name in given})


def _option_parameter(option: DeclaredOption, texts: Mapping[str, str]) -> inspect.Parameter:
    """The parameter of a declared field."""
    info = option.info
    default = REQUIRED if isinstance(info, Argument) and info.is_required else option.field.default
    if option.field.name in texts and isinstance(info, Option):
        info = replace(info, help=texts[option.field.name])
    return _typer_parameter(option.field.name, option.kind, info, default)


def _typer_parameter(
    name: str,
    kind: Any,  # noqa: ANN401 - a type
    info: Option | Argument,
    default: Any,  # noqa: ANN401 - of any option
) -> inspect.Parameter:
    """A parameter in the form of typer: a tuple of words becomes a list; a flag for a field that is True sets False."""
    is_flag, member = kind is bool, member_type(kind)
    if member is float or kind is Any:
        kind = str | None
    elif member is not None:
        kind = list[member] if default is REQUIRED else list[member] | None  # type: ignore[valid-type]
        default = None if default == () else default
    elif is_flag:
        default = False
    names = getattr(completion, info.names) if info.names else None
    if isinstance(info, Argument):
        shown: Any = typer.Argument(metavar=info.metavar, autocompletion=names, hidden=True, readable=False)
    else:
        flags = info.flags or (f"--{name.replace('_', '-')}",)
        metavar = None if is_flag else info.metavar
        shown = typer.Option(*flags, metavar=metavar, help=info.help, autocompletion=names, readable=False)
    way = inspect.Parameter.KEYWORD_ONLY
    return inspect.Parameter(name, way, default=default, annotation=Annotated[kind, shown])


def _field_value(option: DeclaredOption, given: Any) -> Any:  # noqa: ANN401 - of any option
    """Convert the value that typer passes into that of the option's field."""
    member = member_type(option.kind)
    if member is float:
        return None if given is None else _parse_numbers(option.name, given)
    if member is not None:
        return tuple(given or ())
    return not given if option.field.default is True else given


def _parse_numbers(option: str, text: str) -> tuple[float, ...]:
    """Parse numbers with commas between them; raises LinkproofError for what is no finite number."""
    numbers = []
    for word in text.split(","):
        try:
            number = float(word)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise LinkproofError(
                f"--{option}: expected finite numbers with commas between them, such as 0,30,60, got "
                f"'{word.strip()}'; correct it"
            )
        numbers.append(number)
    return tuple(numbers)
