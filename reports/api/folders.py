"""A study in the folder of ``--out``: what is finished there, and how an interrupted call goes on."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple

from analytic.errors import LinkproofError
from reports.api.options import Announce, changed_arguments, command_line, with_arguments

if TYPE_CHECKING:
    from analytic.description.linkage import Linkage
    from comparisons.trials.runs.store import Runs


class OwnStudy(NamedTuple):
    """Whether a folder's own study is asked for and finished; else the arguments by which it was begun, or None."""

    is_finished: bool
    begun: dict[str, Any] | None


def own_study(function: Callable[..., Any], given: Mapping[str, Any]) -> OwnStudy:
    """The state of the study in the folder ``out``: finished or not, and the arguments that began it, if needed.

    The folder is only read if nothing else is given that affects the results. Raises LinkproofError for a damaged one.
    """
    folder, name = given["out"], function.__name__
    if folder is None or changed_arguments(function, given):
        return OwnStudy(is_finished=False, begun=None)
    from comparisons.trials.runs.store import has_study, unfinished_command

    try:
        begun, changed = json.loads(unfinished_command(folder) or "[null, {}]")
        arguments = with_arguments(function, given, changed) if begun == name and changed else None
    except (ValueError, TypeError, AttributeError, RecursionError) as error:
        raise LinkproofError(f"'{folder}' has a damaged command ({error}): type the whole command") from error
    return OwnStudy(is_finished=begun != name and has_study(folder, name), begun=arguments)


class StoredRuns(NamedTuple):
    """The runs of a call that its folder keeps, None without a folder, and what counts them."""

    finished: Runs | None
    announce: Announce


@contextmanager
def stored_runs(
    function: Callable[..., Any],
    given: Mapping[str, Any],
    engines: Iterable[str],
    linkages: Iterable[Linkage] = (),
    without: Sequence[str] = (),
) -> Iterator[StoredRuns]:
    """The runs of a call that are finished in its folder ``out``; they are removed when the study is saved.

    Ctrl-C raises KeyboardInterrupt with the number of runs in the folder, and the command that finishes them. Options
    ``without`` a part in what is run may differ from those of the call that began them.
    """
    folder, announce = given["out"], given["announce"]
    number = total = 0

    def announce_run(label: str, begun: int, count: int) -> None:
        """Pass an announcement on and remember its numbers for the message on Ctrl-C."""
        nonlocal number, total
        number, total = begun, count
        announce(label, begun, count)

    finished = None if folder is None else _finished_runs(function, given, engines, linkages, without)
    try:
        yield StoredRuns(finished, announce_run)
    except KeyboardInterrupt as interrupt:
        if folder is None or not total:
            raise
        raise KeyboardInterrupt(
            f"{number} of {total} runs are saved in {folder}: repeat the command, or linkproof {function.__name__} "
            f"--out {shlex.quote(str(folder))}, to finish"
        ) from interrupt
    if finished is not None:
        finished.clear()


def _finished_runs(
    function: Callable[..., Any],
    given: Mapping[str, Any],
    engines: Iterable[str],
    linkages: Iterable[Linkage],
    without: Sequence[str],
) -> Runs:
    """The finished runs of the same request; those of another one are removed.

    Two requests are the same if the command, the linkage files, and the versions of linkproof, its libraries and the
    engines are equal.
    """
    import hashlib

    from comparisons.trials.runs.environment import INCIDENTAL, environment
    from comparisons.trials.runs.plugins import engine
    from comparisons.trials.runs.store import begin
    from reports.document.terminal import show

    facts = {name: value for name, value in environment(()).items() if name not in INCIDENTAL}
    facts |= {f"engine {name}": engine(name).version() or "not installed" for name in engines}
    facts |= {f"file of {k.name}": hashlib.sha256(k.text.encode()).hexdigest()[:16] for k in linkages}
    command = command_line(function, given, without)
    request = "\n".join([command, *(f"{name} {value}" for name, value in facts.items())])
    arguments = json.dumps([function.__name__, changed_arguments(function, given)], default=str)
    finished, other = begin(given["out"], request, arguments)
    if other:
        show(f"what was unfinished in '{given['out']}' was another request ({other}): it is begun anew", stderr=True)
    return finished
