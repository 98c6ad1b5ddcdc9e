"""Interrupted commands: what is finished in the folder of ``--out``, and the sentence that says how to go on."""

from __future__ import annotations

import hashlib
import shlex
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError
from comparisons.trials.runs.environment import INCIDENTAL, environment
from comparisons.trials.runs.plugins import engine
from comparisons.trials.runs.store import Runs, begin, has_study, unfinished_command
from reports.api.options import Announce, Option, command_line, declared_options
from reports.command_line.parameters import option_bag
from reports.document.terminal import show


def finished_runs(
    folder: Path,
    command: str,
    engines: Iterable[str] = (),
    linkages: Iterable[Linkage] = (),
    *,
    full_command: str = "",
) -> Runs:
    """The runs of the same request that are finished in a folder; those of another one are removed.

    Two requests are the same if the command, the linkage files, and the versions of linkproof, its libraries and the
    engines are equal. ``full_command`` has limits of time, too, and all else that decides no result.
    """
    facts = {name: value for name, value in environment(()).items() if name not in INCIDENTAL}
    facts |= {f"engine {name}": engine(name).version() or "not installed" for name in engines}
    facts |= {f"file of {k.name}": hashlib.sha256(k.text.encode()).hexdigest()[:16] for k in linkages}
    request = "\n".join([command, *(f"{name} {value}" for name, value in facts.items())])
    finished, other = begin(folder, request, full_command or command)
    if other:
        show(f"what was unfinished in '{folder}' was another request ({other}): it is begun anew", stderr=True)
    return finished


@contextmanager
def report_interruption(folder: Path | None, command: str) -> Iterator[Callable[[Announce], Announce]]:
    """A wrapper that counts the runs passed to ``announce``.

    Ctrl-C raises KeyboardInterrupt with the number of runs saved in ``folder``, and the ``command`` that finishes them.
    """
    finished, total = 0, 0

    def counting(announce: Announce) -> Announce:
        def announce_run(label: str, number: int, count: int) -> None:
            nonlocal finished, total
            finished, total = number, count
            announce(label, number, count)

        return announce_run

    try:
        yield counting
    except KeyboardInterrupt as interrupt:
        if folder is None or not total:
            raise
        raise KeyboardInterrupt(
            f"{finished} of {total} runs are saved in {folder}: repeat the command, or linkproof {command} --out "
            f"{shlex.quote(str(folder))}, to finish"
        ) from interrupt


def own_study(app: click.Group, command: str, folder: Path, bags: tuple[Any, ...]) -> tuple[bool, tuple[Any, ...]]:
    """Whether the folder's own study of a command is asked for and finished; the options of what is to be run.

    It is asked for unless the ``bags`` have an option that affects the results. Of an unfinished study the options are
    those that began it; nothing else is taken from the folder.
    """
    if command_line(command, *bags) != f"linkproof {command}":
        return False, bags
    words = _unfinished_words(command, folder)
    if not words:
        return has_study(folder, command), bags
    typed = app.commands[command].make_context(command, words).params
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
