"""Parts of a report as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from reports.document import parts as model
from reports.document.parts import Cell, Link, Mono, Part, Table, Words

RULES = {"l": "---", "r": "---:"}


def written(parts: Iterable[Part], level: int = 2) -> str:
    """Parts as paragraphs with a blank line between; ``level`` is that of a heading."""
    return "\n\n".join(filter(None, (_part(part, level) for part in parts)))


def _part(part: Part, level: int) -> str:  # noqa: PLR0911  a case for every part
    match part:
        case model.Paragraph(words):
            return inline(words)
        case model.Bullets(items):
            return "\n".join(f"- {inline(item)}" for item in items)
        case model.Facts(rows):
            return "\n".join(f"- {name}: {inline(words)}" for name, words in rows)
        case model.Command(text):
            return f"```\n{text}\n```"
        case Table():
            return table(part)
        case model.Figure(caption=caption):
            return inline(caption)
        case model.Figures(figures):
            return written(figures, level)
        case model.Widget(instead=parts):
            return written(parts, level)
        case model.Fold(summary, parts):
            return written((model.Paragraph(summary), *parts), level)
        case model.Cards(cards):
            return written((model.Section("", model.as_text(card.heading), card.parts) for card in cards), level)
        case model.Drawn(alt=alt):
            return alt
        case model.Section(heading=heading, parts=parts):
            return f"{'#' * level} {inline(heading)}\n\n{written(parts, level + 1)}"


def table(found: Table) -> str:
    """Caption, table and note as paragraphs; a heading over several columns stands in the head of each."""
    over = [words for words, columns in found.groups for _ in range(columns)] or [""] * len(found.head)
    head = [f"{words} {_cell(cell)}".strip() for words, cell in zip(over, found.head, strict=True)]
    rows = [[_cell(cell, bold=number == found.bold) for number, cell in enumerate(row)] for row in found.rows]
    rule = [RULES[found.side(column)] for column in range(len(found.head))]
    return "\n\n".join(filter(None, (found.caption, _grid([head, rule, *rows]), found.note)))


def _cell(cell: Cell | Words, *, bold: bool = False) -> str:
    text = inline(cell.words if isinstance(cell, Cell) else cell)
    text += f" ({cell.note})" if isinstance(cell, Cell) and cell.note else ""
    return f"**{text}**" if bold else text


def _grid(rows: Iterable[Sequence[str]]) -> str:
    """Lines of a table; bars inside a cell are escaped."""
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows)


def inline(words: Words) -> str:
    """Words with their links and commands."""
    match words:
        case tuple():
            return "".join(map(inline, words))
        case Link(text, href):
            return f"[{text}]({href})"
        case Mono(text):
            return f"`{text}`"
        case _:
            return words
