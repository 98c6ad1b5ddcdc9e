"""Words and tables of a report as Markdown; pictures and what answers stand on pages alone."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Final

from reports.document.parts import (
    Bullets,
    Facts,
    Fold,
    Mono,
    PageLink,
    Paragraph,
    Part,
    Section,
    Table,
    TableCell,
    Words,
)

RULES = {"l": "---", "r": "---:"}
# Characters of markup: of Markdown, unless within a word, and of a tag or an entity of HTML.
MARKUP: Final = re.compile(r"[\\`*\[\]]|(?<![^\W_])_|_(?![^\W_])|<(?=[A-Za-z/!?])|&(?=#?\w+;)")


def written(parts: Iterable[Part], level: int = 2) -> str:
    """Parts as Markdown text, a blank line between them; ``level`` is that of a heading, the number of its #.

    Parts that only pages have are left out; a section in a section has the next level.
    """
    return "\n\n".join(filter(None, (_part(part, level) for part in parts)))


def _part(part: Part, level: int) -> str:  # noqa: PLR0911  a case each
    """One part as Markdown text; ``level`` is that of a heading. "" for a part that only pages have."""
    match part:
        case Paragraph(words):
            return inline(words)
        case Bullets(items):
            return "\n".join(f"- {inline(item)}" for item in items)
        case Facts(rows):
            return "\n".join(f"- {inline(name)}: {inline(words)}" for name, words in rows)
        case Table():
            return table(part)
        case Fold(summary, parts):
            return written((Paragraph(summary), *parts), level)
        case Section(heading=heading, parts=parts):
            return f"{'#' * level} {inline(heading)}\n\n{written(parts, level + 1)}"
    return ""


def table(result: Table) -> str:
    """A table as Markdown text with caption and note; a heading over several columns is repeated in each."""
    over = [words for words, columns in result.groups for _ in range(columns)] or [""] * len(result.head)
    head = [f"{inline(words)} {_cell(cell)}".strip() for words, cell in zip(over, result.head, strict=True)]
    rule = [RULES[result.side(column)] for column in range(len(result.head))]
    rows = [head, rule, *(map(_cell, row) for row in result.rows)]
    return "\n\n".join(filter(None, (inline(result.caption), "\n".join(map(_row, rows)), inline(result.note))))


def _cell(cell: TableCell | Words) -> str:
    """A cell as Markdown text, its note in brackets; style, colour, tooltip and span are left out."""
    if isinstance(cell, TableCell):
        return inline(cell.words) + (f" ({inline(cell.note)})" if cell.note else "")
    return inline(cell)


def _row(cells: Iterable[str]) -> str:
    """A line of a Markdown table; bars inside a cell are escaped."""
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def inline(words: Words) -> str:
    """Words as Markdown text, with links and commands; nothing in the words themselves is markup."""
    match words:
        case tuple():
            return "".join(map(inline, words))
        case PageLink(text, href):
            return f"[{inline(text)}]({href})"
        case Mono(text):
            return f"`` {text} ``" if "`" in text else f"`{text}`"
    return MARKUP.sub(r"\\\g<0>", words)
