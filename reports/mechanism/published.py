"""The figures printed in a mechanism's sources beside ours, a column for every variant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from reports.document.numbers import figure, per_cent, printed
from reports.document.parts import Cell, Section, Table
from reports.document.signs import PUBLISHED
from reports.document.templates import worded

VISIBLE = 5e-4  # a deviation from which on it is told, in per cent with one decimal
Rows = Sequence[Mapping[str, Any]]


def published_section(rows: Rows) -> Section:
    """All of them, and how many every variant meets."""
    return Section(
        "published", "Published figures against ours", (_table(rows, list(dict.fromkeys(map(_variant, rows)))),)
    )


def _variant(row: Mapping[str, Any]) -> str:
    return str(row["variant"])


def _met(rows: Rows, variant: str) -> str:
    """How many figures a variant meets, in words."""
    signs = [PUBLISHED[row["verdict"]].style for row in rows if row["variant"] == variant]
    near = f" and {signs.count('near')} within 6 %" if "near" in signs else ""
    return f"{variant} {signs.count('pass')} of {len(signs)} to the last printed digit{near}"


def _table(rows: Rows, variants: list[str]) -> Table:
    keys = dict.fromkeys((row["quantity"], row["unit"], row["published"], row["source"], row["note"]) for row in rows)
    lines: list[tuple[Cell | str, ...]] = []
    for key in keys:
        quantity, unit, value, source, note = key
        ours = {
            row["variant"]: row
            for row in rows
            if (row["quantity"], row["unit"], row["published"], row["source"], row["note"]) == key
        }
        cells = [_cell(ours[variant]) if variant in ours else Cell("–", "absent") for variant in variants]
        name = f"{worded(quantity)}, {unit}" if unit else worded(quantity)
        lines.append((name, _signed(printed(value)), *cells, Cell(source, note=note)))
    align = "lr" + "r" * len(variants) + "l"
    met = "; ".join(_met(rows, variant) for variant in variants)
    return Table(
        f"Every printed figure beside ours. Reproduced: {met}.",
        ("figure", "published", *variants, "place"),
        tuple(lines),
        align=align,
    )


def _cell(row: Mapping[str, Any]) -> Cell:
    sign, deviation = PUBLISHED[row["verdict"]], row["deviation"]
    seen = deviation is not None and abs(deviation) >= VISIBLE
    note = f"{per_cent(deviation)}, {sign.word}" if seen else sign.word
    return Cell(f"{sign.symbol} {_signed(figure(row['ours']))}", style=sign.style, colour=sign.colour, note=note)


def _signed(text: str) -> str:
    return f"−{text[1:]}" if text.startswith("-") else text
