"""Interrupted commands: the journal of finished runs, and the sentence that names the way to resume."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType

from analytic.description.linkage import Linkage
from comparisons.runs.environment import INCIDENTAL, environment
from comparisons.runs.plugins import engine
from comparisons.runs.study import Journal
from comparisons.runs.workers import PoolLostError

Announce = Callable[[str, int, int], None]


def journal(
    folder: Path,
    command: str,
    engines: Iterable[str] = (),
    linkages: Iterable[Linkage] = (),
    *,
    resume: bool,
    files: Mapping[str, str] = MappingProxyType({}),
) -> Journal:
    """The journal of a request: empty, or with the finished runs of the same request if it is resumed.

    Two requests are the same if the command, the linkage files, the digests of other ``files`` by name, and the
    versions of linkproof, its libraries and the engines are equal.
    """
    facts = {name: value for name, value in environment(()).items() if name not in INCIDENTAL}
    facts |= {f"engine {name}": engine(name).version() or "not installed" for name in engines}
    facts |= {f"file of {k.name}": hashlib.sha256(k.text.encode()).hexdigest()[:16] for k in linkages}
    facts |= {f"file {name}": digest[:16] for name, digest in files.items()}
    records = Journal(folder, "\n".join([command, *(f"{name} {value}" for name, value in facts.items())]))
    if not resume:
        records.clear()
    return records


@contextmanager
def interruptible(folder: Path | None, what: str = "runs") -> Iterator[Callable[[Announce], Announce]]:
    """A wrapper that counts the runs passed to ``announce``.

    Ctrl-C, and the loss of the machines of a cluster, raise KeyboardInterrupt with the number of runs saved in
    ``folder``.
    """
    finished, total = 0, 0

    def counting(announce: Announce) -> Announce:
        def heard(label: str, number: int, count: int) -> None:
            nonlocal finished, total
            finished, total = number, count
            announce(label, number, count)

        return heard

    try:
        yield counting
    except (KeyboardInterrupt, PoolLostError) as interrupt:
        why = f"{interrupt}; " if isinstance(interrupt, PoolLostError) else ""
        if folder is None or not total:
            raise KeyboardInterrupt(f"{why}nothing was written" if why else str(interrupt)) from interrupt
        raise KeyboardInterrupt(
            f"{why}{finished} of {total} {what} are saved in {folder}: repeat the command with --resume to finish"
        ) from interrupt
