"""Printing: the only place that writes to a terminal, a pipe or a file on stdout; no text is read as markup.

Foreign text (names, titles, notes, paths) may hold anything: its control characters are shown as escapes. On a terminal
lines are folded to its width; elsewhere they are as wide as they need to be and nothing is cut off.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple, TextIO

from rich.console import Console
from rich.table import Table as Grid
from rich.text import Text

from analytic.errors import printable
from reports.document.parts import Paragraph, Table, TableCell, Words, as_text

Printed = str | Paragraph | Table  # parts of a command's output; a text may have several lines
UNBOUNDED = 1_000_000  # columns where nobody's terminal sets a width


class Printout(NamedTuple):
    """The output of a command: ``tables`` unless it is quiet, ``closing`` always, ``details`` if it is verbose."""

    tables: Iterable[Printed]
    closing: Sequence[Printed]
    details: Iterable[Printed] = ()


def show(*parts: Printed, stderr: bool = False) -> None:
    """Print parts one below the other on stdout or, with ``stderr``, there; print nothing without parts.

    On a terminal they are in colour and folded to its width.
    """
    if not parts:
        return
    screen = Console(stderr=stderr, markup=False, emoji=False, highlight=False)
    if screen.is_terminal:
        screen.print(*_lines(parts), sep="\n")
    else:
        write(rendered(*parts), sys.stderr if stderr else sys.stdout)


def write(text: str, stream: TextIO) -> None:
    """Write text to a stream and flush it; once its reader has left, nothing more is written, without an error."""
    try:
        stream.write(text)
        stream.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def rendered(*parts: Printed, width: int = UNBOUNDED) -> str:
    """The parts as text for a pipe, at most ``width`` columns wide: no colours, no spaces at the ends of lines."""
    screen = Console(width=width, no_color=True, force_terminal=False, markup=False, emoji=False, highlight=False)
    with screen.capture() as captured:
        screen.print(*_lines(parts), sep="\n")
    return "\n".join(text.rstrip() for text in captured.get().split("\n"))


def harmless(text: str) -> str:
    """A text, of one line or several, whose control characters are shown as escapes."""
    return "\n".join(map(printable, text.split("\n")))


def _lines(parts: Sequence[Printed]) -> Iterator[Text | Grid]:
    """Yield the parts as Rich's texts and grids, several for a table with caption or note."""
    for part in parts:
        if isinstance(part, Table):
            yield from _table(part)
        elif isinstance(part, Paragraph):
            yield _text(part.words, part.colour)
        else:
            yield _text(part)


def _table(table: Table) -> Iterator[Text | Grid]:
    """Yield a table for the terminal, without rules: caption, grid, note."""
    if table.caption:
        yield _text(table.caption)
    grid = Grid(box=None, pad_edge=False)
    for number, head in enumerate(table.head):
        right = table.side(number) == "r"
        grid.add_column(_cell(head), justify="right" if right else "left", overflow="fold")
    for row in table.rows:
        grid.add_row(*map(_cell, row))
    yield grid
    if table.note:
        yield _text(table.note)


def _cell(cell: TableCell | Words) -> Text:
    """A cell as Rich's text, in its colour."""
    return _text(cell.words, cell.colour) if isinstance(cell, TableCell) else _text(cell)


def _text(words: Words, colour: str = "") -> Text:
    """Words as Rich's text, control characters escaped, in a ``colour``, a style of Rich's or ""."""
    return Text(harmless(as_text(words)), style=colour)
