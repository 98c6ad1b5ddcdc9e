"""What an interrupted campaign leaves: its journal, and a sentence that says how to go on."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType

from analytic.description.linkage import Linkage
from comparisons.runs.environment import INCIDENTAL, environment
from comparisons.runs.journal import Journal
from comparisons.runs.plugins import engine
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
    """The journal of a request: empty, or what was kept of the same request before where it is resumed.

    The same are the command, the linkage files, other ``files`` by name with a digest of each, and the versions of
    everything that computes.
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
    """What makes an ``announce`` count; Ctrl-C is then raised on with a sentence on how many ``folder`` keeps.

    So is the loss of the machines that make them.
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
