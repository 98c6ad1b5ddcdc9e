"""The declaration of options, and the command that repeats a request.

An option is an annotated field of a frozen dataclass: the command line, the keywords of the Python function and the
command in saved results are all derived from it.
"""

from __future__ import annotations

import shlex
from collections.abc import Iterable
from dataclasses import Field, dataclass, fields
from pathlib import Path
from typing import Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints


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
