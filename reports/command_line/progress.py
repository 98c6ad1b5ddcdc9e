"""The progress bar of a campaign: on stderr, gone when it is done, absent where nobody looks."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from reports.document.terminal import harmless


@contextmanager
def progress(*, visible: bool = True) -> Iterator[Callable[[str, int, int], None]]:
    """A function to announce runs to: label, number of the run, how many there are. The bar starts at the first."""
    if not (visible and sys.stderr.isatty()):
        yield lambda *_: None
        return
    from rich.console import Console  # noqa: PLC0415  a pipe needs none of it
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn  # noqa: PLC0415

    label_column = TextColumn("{task.description}", markup=False)
    columns = (label_column, BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    bar = Progress(*columns, console=Console(stderr=True, markup=False), transient=True)
    task = bar.add_task("", total=None)

    def announce(label: str, number: int, total: int) -> None:
        bar.start()
        bar.update(task, description=harmless(label), completed=number, total=total)

    try:
        yield announce
    finally:
        bar.stop()
