"""Lines and tables as a terminal shows them, for what is not yet described as parts."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table
from rich.text import Text

from reports.document.terminal import Printout, harmless, rendered, show, write

__all__ = ["Cell", "Printout", "line", "rendered", "show", "table", "write"]

Cell = str | tuple[str, str]  # a text, or a text and its style


def line(text: str, style: str = "") -> Text:
    """A line, or several, of one style."""
    return Text(harmless(text), style=style)


def table(head: Sequence[str], rows: Sequence[Sequence[Cell]], align: str = "l") -> Table:
    """A table without rules; ``align`` has "l" or "r" for each column, its last letter holds for all that follow."""
    shown = Table(box=None, pad_edge=False)
    for number, name in enumerate(head):
        right = align[min(number, len(align) - 1)] == "r"
        shown.add_column(line(name), justify="right" if right else "left", overflow="fold")
    for row in rows:
        shown.add_row(*(line(cell) if isinstance(cell, str) else line(*cell) for cell in row))
    return shown
