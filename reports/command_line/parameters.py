"""The command line, derived from signatures: an annotated parameter of a function is an option or an argument."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any, TypeVar, get_args

import click

from analytic.errors import LinkproofError
from reports.api.options import (
    Argument,
    DeclaredOption,
    OutputOptions,
    declared_options,
    member_type,
    option_groups,
    option_value,
)
from reports.command_line import completion, gone

GLOSSARY = Path(__file__).parents[1] / "templates" / "glossary.txt"
Bag = TypeVar("Bag")
OF_PYTHON = re.compile(r"\n\n(?=In Python |>>> )")  # what a docstring says beyond the command
NO_TEXTS: Mapping[str, str] = MappingProxyType({})
SETTINGS = {"help_option_names": ["-h", "--help"]}


class CommandGroup(click.Group):
    """The commands in their own order, with a glossary of symbols below their help."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """The names of the commands in the order in which they were added."""
        return list(self.commands)

    def resolve_command(self, ctx: click.Context, args: list[str]) -> Any:  # noqa: ANN401 - of click
        """The command of the first word; raises LinkproofError for one that is gone."""
        answer = "" if args[0] in self.commands or ctx.resilient_parsing else gone.answer_to_command(args[0])
        if answer:
            raise LinkproofError(answer)
        return super().resolve_command(ctx, args)

    def get_help(self, ctx: click.Context) -> str:
        """The help of click and the glossary."""
        return f"{super().get_help(ctx)}\n\n{GLOSSARY.read_text(encoding='utf-8')}"


class LinkproofCommand(click.Command):
    """A command whose help has sections, and that answers an option that is gone with what to do instead."""

    sections: Mapping[str, str] = NO_TEXTS  # titles by the names of parameters

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options into the help, section by section."""
        groups: dict[str, list[tuple[str, str]]] = {}
        for parameter in self.get_params(ctx):
            record = parameter.get_help_record(ctx)
            if record is not None and isinstance(parameter, click.Option):
                groups.setdefault(self.sections.get(parameter.name or "", "Options"), []).append(record)
        for title, records in groups.items():
            with formatter.section(title):
                formatter.write_dl(records)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the words; raises LinkproofError for an option that is gone."""
        answer = "" if ctx.resilient_parsing else gone.answer_to_json_file(args)
        try:
            if not answer:
                return super().parse_args(ctx, args)
        except click.NoSuchOption as error:
            answer = gone.answer_to_option(self.name or "", error.option_name)
            if not answer:
                raise
        raise LinkproofError(answer)


def study_command(
    app: click.Group,
    name: str,
    function: Callable[..., Any],
    *,
    summary: str,
    offers: Mapping[str, str],
    study: str = "",
    form: type | None = None,
) -> None:
    """Add a function that returns a study to the commands: its options, then those of output that it ``offers``.

    ``offers`` has the help of each, empty for the usual one; ``study`` is the place of the class, module:name; the
    fields of ``form`` are options of what is saved. An ``out`` of the function is an option of output as well.
    """
    own, groups = declared_options(function), option_groups(function)
    titled = {kind.__name__.removeprefix("Steady"): declared_options(kind) for kind in groups.values()}
    bags = [option for options in titled.values() for option in options]
    output = {option.field.name: option for option in declared_options(OutputOptions)}
    taken = {option.field.name for option in own}
    files = [option for name, option in output.items() if name in offers and name not in taken]
    titled["Output"] = (*(declared_options(form) if form else ()), *files)
    sections = {option.field.name: title for title, options in titled.items() for option in options}
    sections |= dict.fromkeys(taken & {"out"}, "Output")
    every = [*own, *bags, *titled["Output"]]

    def called(**words: Any) -> int:  # noqa: ANN401 - of all options
        """Call the function with click's values, print and write its study; the exit code."""
        from reports.command_line.destination import Destination  # noqa: PLC0415 - help does without

        out = option_bag(Destination, {name: words[name] for name in words if name in offers or name == "out"})
        choice = None if form is None else option_bag(form, words)
        given = {option.field.name: _value(option, words[option.field.name]) for option in own}
        out.prepare(study, _read(own, given), choice)
        given |= {each: option_bag(kind, words) for each, kind in groups.items()}
        return out.make(partial(function, **given), choice)

    made = LinkproofCommand(
        name,
        params=[_parameter(option, offers.get(option.field.name, "")) for option in every],
        callback=called,
        help=OF_PYTHON.split(inspect.getdoc(function) or "")[0],
        short_help=summary,
        context_settings=SETTINGS,
    )
    made.sections = sections | {"help": "Output" if titled["Output"] else "Options"}
    app.add_command(made)


def _read(options: Iterable[DeclaredOption], given: Mapping[str, Any]) -> dict[str, Path]:
    """Paths of the files that options read, by their meaning in words."""
    found = {}
    for option in options:
        value = given[option.field.name]
        for each in value if isinstance(value, tuple) else () if value is None else (value,):
            if option.info.reads:
                found[option.info.reads.format(each)] = Path(each)
    return found


def option_bag(kind: type[Bag], given: Mapping[str, Any]) -> Bag:
    """A dataclass of options, filled with the values that click passes, by name."""
    options = {option.field.name: option for option in declared_options(kind)}
    return kind(**{name: _value(option, given[name]) for name, option in options.items() if name in given})


def _parameter(option: DeclaredOption, text: str) -> click.Parameter:
    """The option or argument as click's; ``text`` replaces its help if it is not empty."""
    name, info, kind, default = option.field.name, option.info, option.kind, option.field.default
    several, types = member_type(kind), (kind, *get_args(kind))
    value: Any = float if float in types else int if int in types else str
    if Path in types or several is Path:
        value = click.Path(path_type=Path)
    known = getattr(completion, info.names) if info.names else None
    if isinstance(info, Argument):
        required = info.is_required or default is inspect.Parameter.empty
        usage = (info.metavar if required else f"[{info.metavar}]") + ("..." if several else "")
        return click.Argument(
            [name], type=value, nargs=-1 if several else 1, required=required, metavar=usage,
            shell_complete=_completer(known),
        )  # fmt: skip
    flags = info.flags or (f"--{name.replace('_', '-')}",)
    if kind is bool:
        return click.Option([name, *flags], is_flag=True, help=text or info.help)
    is_multiple = several is not None and several is not float
    return click.Option(
        [name, *flags], type=value, multiple=is_multiple, metavar=info.metavar, help=text or info.help,
        default=None if is_multiple else default, show_default=default is not None and not is_multiple,
        shell_complete=_completer(known),
    )  # fmt: skip


def _completer(known: Callable[[str], list[str]] | None) -> Callable[..., list[str]] | None:
    """A function of names as click's shell completion; None for None."""
    return None if known is None else lambda _context, _parameter, incomplete: known(incomplete)


def _value(option: DeclaredOption, given: Any) -> Any:  # noqa: ANN401 - of any option
    """An option's value from click's; a flag that is set switches off what is on by default."""
    if member_type(option.kind) is float and isinstance(given, str):
        return option_value(option, given)
    return not given if option.field.default is True else given


def run(app: click.Group, name: str, words: Sequence[str]) -> int:
    """Run a command's words, or answer a shell's completion; returns the exit code. Ctrl-C raises KeyboardInterrupt."""
    if completion.is_asked(name):
        return completion.complete(app, name)
    try:
        with app.make_context(name, list(words)) as context:
            return int(app.invoke(context) or 0)
    except click.exceptions.Exit as end:
        return end.exit_code
    except click.ClickException as error:
        error.show()
        return error.exit_code
