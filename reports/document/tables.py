"""One table of a report, and how it is written in Markdown and on a terminal; ``templates/table.html`` writes HTML."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Group

RULES = {"l": "---", "r": "---:"}


@dataclass(frozen=True)
class ReportTable:
    """A table ready to be written, with a sentence before it and a note in small print after it.

    ``align`` has a letter per column, "l" for words and "r" for figures; the last letter holds for all that follow.
    The column ``bold`` is set in bold. A cell may be ``Markup``, which only a page may show.
    """

    caption: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    align: str = "lr"
    note: str = ""
    bold: int | None = None

    def side(self, column: int) -> str:
        """The letter of a column."""
        return self.align[min(column, len(self.align) - 1)]

    def __rich__(self) -> Group:
        """The table as a terminal shows it: no rules, and no text is read as markup."""
        from rich.console import Group  # noqa: PLC0415  a page needs no terminal

        from reports.document.screen import line, table  # noqa: PLC0415

        shown = (line(self.caption), table(self.head, self.rows, self.align), line(self.note))
        return Group(*(part for part in shown if part))


def markdown(table: ReportTable) -> str:
    """Caption, table and note as paragraphs of Markdown."""
    rows = [[_bold(cell) if n == table.bold else str(cell) for n, cell in enumerate(row)] for row in table.rows]
    rule = [RULES[table.side(column)] for column in range(len(table.head))]
    return "\n\n".join(filter(None, (table.caption, markdown_rows([table.head, rule, *rows]), table.note)))


def _bold(cell: object) -> str:
    return f"**{cell}**"


def markdown_rows(rows: Iterable[Sequence[str]]) -> str:
    """Lines of a Markdown table; bars inside a cell are escaped."""
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows)
