"""``--out DIR`` alone: the study that is in the folder, instead of the default one of the command."""

from __future__ import annotations

import shlex
from dataclasses import replace
from pathlib import Path
from typing import Any

import typer

from analytic.errors import LinkproofError
from comparisons.runs.study import has_study, unfinished_command
from reports.command_line.parameters import option_bag
from reports.requests.options import Option, command_line, declared_options


def own_study(app: typer.Typer, command: str, folder: Path, bags: tuple[Any, ...]) -> tuple[bool, tuple[Any, ...]]:
    """Whether the folder's own study of a command is asked for and finished; the options of what is to be run.

    It is asked for unless the ``bags`` have an option that affects the results. Of an unfinished study the options are
    those that began it; nothing else is taken from the folder.
    """
    if command_line(command, *bags) != f"linkproof {command}":
        return False, bags
    words = _unfinished_words(command, folder)
    if not words:
        return has_study(folder, command), bags
    commands: Any = typer.main.get_command(app)
    typed = commands.commands[command].make_context(command, words).params
    return False, tuple(replace(option_bag(type(bag), typed), **_without_effect(bag)) for bag in bags)


def _unfinished_words(command: str, folder: Path) -> list[str]:
    """The arguments and options of the command that began what is unfinished; empty if it is another command."""
    try:
        words = shlex.split(unfinished_command(folder))
    except ValueError as error:
        raise LinkproofError(f"'{folder}' has a damaged command ({error}): type the whole command") from error
    return words[2:] if words[:2] == ["linkproof", command] else []


def _without_effect(bag: Any) -> dict[str, Any]:  # noqa: ANN401 - a dataclass
    """The given options that do not affect the results."""
    infos = {option.field.name: option.info for option in declared_options(type(bag))}
    names = [name for name, info in infos.items() if isinstance(info, Option) and not info.affects_results]
    return {name: getattr(bag, name) for name in names}
