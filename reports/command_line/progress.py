"""The progress bar of a campaign: on stderr, gone when it is done, absent where nobody looks."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn


@contextmanager
def progress() -> Iterator[Callable[[str, int, int], None]]:
    """A function to announce runs to: label, number of the run, how many there are. The bar starts at the first."""
    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    bar = Progress(*columns, console=console, transient=True, disable=not console.is_terminal)
    task = bar.add_task("", total=None)

    def announce(label: str, number: int, total: int) -> None:
        bar.start()
        bar.update(task, description=label, completed=number, total=total)

    try:
        yield announce
    finally:
        bar.stop()
