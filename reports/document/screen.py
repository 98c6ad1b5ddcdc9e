"""Printing: the only place that writes to a terminal, a pipe or a file on stdout; no text is read as markup.

Foreign text (names, titles, notes, paths) may hold anything: its control characters are shown as escapes. On a terminal
lines are folded to its width; elsewhere they are as wide as they need to be and nothing is cut off.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple, TextIO

from rich.console import Console
from rich.table import Table
from rich.text import Text

from analytic.errors import printable

if TYPE_CHECKING:
    from rich.console import RenderableType

Cell = str | tuple[str, str]  # a text, or a text and its style
UNBOUNDED = 1_000_000  # columns where nobody's terminal sets a width


class Printout(NamedTuple):
    """What a command prints: ``tables`` unless it is quiet, ``closing`` always, ``details`` where it is verbose."""

    tables: Sequence[RenderableType]
    closing: Sequence[RenderableType]
    details: Sequence[RenderableType] = ()


def line(text: str, style: str = "") -> Text:
    """A line, or several, of one style."""
    return Text("\n".join(map(printable, text.split("\n"))), style=style)


def table(head: Sequence[str], rows: Sequence[Sequence[Cell]], align: str = "l") -> Table:
    """A table without rules; ``align`` has "l" or "r" for each column, its last letter holds for all that follow."""
    shown = Table(box=None, pad_edge=False)
    for number, name in enumerate(head):
        right = align[min(number, len(align) - 1)] == "r"
        shown.add_column(line(name), justify="right" if right else "left", overflow="fold")
    for row in rows:
        shown.add_row(*(line(cell) if isinstance(cell, str) else line(*cell) for cell in row))
    return shown


def show(*parts: RenderableType, stderr: bool = False) -> None:
    """Print parts one below the other."""
    screen = Console(stderr=stderr, markup=False, emoji=False, highlight=False)
    if screen.is_terminal:
        screen.print(*parts, sep="\n")
    elif parts:
        write(rendered(*parts), sys.stderr if stderr else sys.stdout)


def write(text: str, stream: TextIO) -> None:
    """Write to a pipe or a file; where the reader has left, this and all that follows is written nowhere."""
    try:
        stream.write(text)
        stream.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def rendered(*parts: RenderableType, width: int = UNBOUNDED) -> str:
    """What a pipe is given: no colours, no spaces at the ends of lines."""
    screen = Console(width=width, no_color=True, force_terminal=False, markup=False, emoji=False, highlight=False)
    with screen.capture() as captured:
        screen.print(*parts, sep="\n")
    return "\n".join(text.rstrip() for text in captured.get().split("\n"))
