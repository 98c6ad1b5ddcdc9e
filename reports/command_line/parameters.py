"""The command line, derived from signatures: an annotated parameter of a function is an option or an argument."""

from __future__ import annotations

import inspect
import os
import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any, get_args

import click

from analytic.errors import LinkproofError
from reports.api.options import (
    Argument,
    DeclaredOption,
    OutputOptions,
    arguments,
    declared_options,
    member_type,
    option_groups,
)
from reports.command_line import completion

TEMPLATES = Path(__file__).parents[1] / "templates"
GLOSSARY, GONE = TEMPLATES / "glossary.txt", TEMPLATES / "gone.txt"  # commands and options of 1.0: what to do instead
OF_PYTHON = re.compile(r"\n\n(?=In Python |>>> )")  # what a docstring says beyond the command
SETTINGS = {"help_option_names": ["-h", "--help"]}


def refuse_gone(name: str, command: str = "") -> None:
    """Raise LinkproofError, with what to do instead, for a command, or an option of a ``command``, that is gone.

    It does nothing for any other. ``name`` is as typed, "--option" of an option.
    """
    answers = dict(line.split(": ", 1) for line in GONE.read_text(encoding="utf-8").splitlines())
    answer = answers.get(f"{command} {name}", answers.get(name))
    if answer:
        raise LinkproofError(f"{name}: {answer}")


class CommandGroup(click.Group):
    """The commands in their own order, with a glossary of symbols below their help."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """The names of the commands in the order in which they were added."""
        return list(self.commands)

    def resolve_command(self, ctx: click.Context, args: list[str]) -> Any:  # noqa: ANN401 - of click
        """The name and command of the first word, and the words after it, as click has them.

        Raises LinkproofError for a command that is gone, click's UsageError for an unknown one.
        """
        if args[0] not in self.commands and not ctx.resilient_parsing:
            refuse_gone(args[0])
        return super().resolve_command(ctx, args)

    def get_help(self, ctx: click.Context) -> str:
        """The help of click and, after a blank line, the glossary, as text."""
        return f"{super().get_help(ctx)}\n\n{GLOSSARY.read_text(encoding='utf-8')}"


class LinkproofCommand(click.Command):
    """A command whose help has sections, and that answers an option that is gone with what to do instead."""

    sections: Mapping[str, str]  # titles by the names of parameters

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options into the help's ``formatter``, by sections; one without a section is under "Options"."""
        groups: dict[str, list[tuple[str, str]]] = {}
        for parameter in self.get_params(ctx):
            record = parameter.get_help_record(ctx)
            if record is not None and isinstance(parameter, click.Option):
                groups.setdefault(self.sections.get(parameter.name or "", "Options"), []).append(record)
        for title, records in groups.items():
            with formatter.section(title):
                formatter.write_dl(records)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the words, as click does, into the context; returns the words that are left.

        Raises LinkproofError for an option that is gone, as is a file after --json, click's errors for other mistakes.
        """
        files = [file for word, file in pairwise(args) if word == "--json" and not ctx.resilient_parsing]
        if any(file == "-" or file.lower().endswith(".json") for file in files):
            refuse_gone("--json")
        try:
            return super().parse_args(ctx, args)
        except click.NoSuchOption as error:
            refuse_gone(error.option_name, self.name or "")
            raise


def study_command(
    app: click.Group,
    name: str,
    function: Callable[..., Any],
    offers: str = "",
    *,
    study: str = "",
    **texts: str,
) -> None:
    """Add to ``app`` the command ``name`` for a function that returns a study: its options, then those of output.

    ``offers`` has the names of these, with blanks between; ``texts`` offer more, with a help of their own. ``study`` is
    the place of the study's class, module:name, whose suffixes --save takes. An ``out`` of the function is an option of
    output as well.
    """
    own, offered = declared_options(function), {*offers.split(), *texts}
    files = [option for option in declared_options(OutputOptions) if option.field.name in offered]
    offered.add("out")
    titles = {each: kind.__name__.removeprefix("Steady") for each, kind in option_groups(function).items()}

    def called(**words: Any) -> int:  # noqa: ANN401 - of all options
        """Call the function with click's values, print and write its study; returns the exit code.

        Raises LinkproofError for bad input.
        """
        from reports.command_line.destination import Destination  # noqa: PLC0415 - help does without

        given = {each: _value(option, words[each]) for option in (*own, *files) if (each := option.field.name)}
        out = Destination(**{each: given[each] for each in offered & given.keys()})
        out.prepare(study, [given[option.field.name] for option in own])
        return out.make(partial(function, **arguments(function, given)))

    text = OF_PYTHON.split(inspect.getdoc(function) or "")[0]
    made = LinkproofCommand(
        name,
        params=[_parameter(option, texts.get(option.field.name, "")) for option in (*own, *files)],
        callback=called,
        help=text,
        short_help=text.partition("\n")[0],
        context_settings=SETTINGS,
    )
    made.sections = {option.field.name: titles[option.group] for option in own if option.group}
    made.sections |= dict.fromkeys([*offered, *(["help"] if files else [])], "Output")
    app.add_command(made)


def _parameter(option: DeclaredOption, text: str) -> click.Parameter:
    """The option or argument as click's; ``text`` replaces its help if it is not empty.

    Raises AttributeError for ``names`` that the module of completion lacks.
    """
    name, info, kind, default = option.field.name, option.info, option.kind, option.field.default
    several, types = member_type(kind), (kind, *get_args(kind))
    value: Any = float if float in types else int if int in types else str
    if Path in types or several is Path:
        value = click.Path(path_type=Path)
    known = getattr(completion, info.names) if info.names else None
    complete = known and (lambda _context, _parameter, incomplete: known(incomplete))
    if isinstance(info, Argument):
        required = default is inspect.Parameter.empty
        usage = (info.metavar if required else f"[{info.metavar}]") + ("..." if several else "")
        return click.Argument(
            [name], type=value, nargs=-1 if several else 1, required=required, metavar=usage,
            shell_complete=complete,
        )  # fmt: skip
    flags = info.flags or (f"--{name.replace('_', '-')}",)
    if kind is bool:
        return click.Option([name, *flags], is_flag=True, help=text or info.help)
    is_multiple = several is not None and several is not float
    return click.Option(
        [name, *flags], type=value, multiple=is_multiple, metavar=info.metavar, help=text or info.help,
        default=None if is_multiple else default, show_default=default is not None and not is_multiple,
        shell_complete=complete,
    )  # fmt: skip


def _value(option: DeclaredOption, given: Any) -> Any:  # noqa: ANN401 - of any option
    """An option's value from click's: unchanged, but a flag that is set is False where the default is True."""
    return not given if option.field.default is True else given


def run(app: click.Group, name: str, words: Sequence[str]) -> int:
    """Run a command's words, or answer a shell's completion, asked for by a variable; returns the exit code.

    ``name`` is that of the program. Click's own errors are printed on stderr. Raises LinkproofError as the command
    does; Ctrl-C raises KeyboardInterrupt.
    """
    if completion.VARIABLE in os.environ:
        return completion.complete(app)
    try:
        with app.make_context(name, list(words)) as context:
            return int(app.invoke(context) or 0)
    except click.exceptions.Exit as end:
        return end.exit_code
    except click.ClickException as error:
        error.show()
        return error.exit_code
