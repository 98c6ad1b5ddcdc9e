"""The figures printed in a mechanism's sources beside ours, a column for every variant."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

from analytic.description.written import signed
from reports.document.numbers import ABSENT
from reports.document.parts import PUBLISHED, Bullets, Section, Table, TableCell, Words
from reports.document.templates import worded

Row = Mapping[str, Any]  # the fields of ``PublishedRecord``
SIGNS: Final = "; ".join(f"{sign.symbol} {sign.word}" for sign in PUBLISHED.values())
VISIBLE: Final = 5e-4  # a deviation from which on it is shown in per cent with one decimal
# What is below it is rounding, and differs from processor to processor: it is shown as none, and digits end above it.
ROUNDING, DIGITS = 1e-13, 13


def published_section(rows: Sequence[Row]) -> Section:
    """The section on a mechanism's printed figures beside ours, with how many each variant meets, and notes.

    ``rows`` are of all variants.
    """
    met = "; ".join(_met_words(rows, variant) for variant in _variants(rows))
    caption = f"Every printed figure beside ours. Reproduced: {met}."
    table = replace(published_table(rows, worded), caption=caption, note=f"{SIGNS}.", style="published")
    noted = notes(rows, worded)
    return Section("published", "Published figures against ours", (table, *((Bullets(noted),) if noted else ())))


def published_table(rows: Sequence[Row], named: Callable[[str], str] = str) -> Table:
    """The table of printed figures beside ours, a column for each variant, "" where one has none.

    ``named`` makes a quantity's name a reader's.
    """
    variants, cells = _variants(rows), []
    for key in dict.fromkeys(map(_key, rows)):
        ours = {row["variant"]: row for row in rows if _key(row) == key}
        first = next(iter(ours.values()))
        entries: list[TableCell | Words] = [
            _variant_cell(ours[variant]) if variant in ours else "" for variant in variants
        ]
        cells.append((named(first["quantity"]), _printed(first), *entries, first["source"]))
    return Table("", ("quantity", "printed", *variants, "place"), tuple(cells), "l")


def notes(rows: Sequence[Row], named: Callable[[str], str] = str) -> tuple[str, ...]:
    """The file's notes on figures, each once, after the first figure that has it; ``named`` makes names a reader's."""
    tables: dict[str, dict[str, None]] = {}
    for row in rows:
        if row["note"]:
            tables.setdefault(row["note"], {})[f"{named(row['quantity'])} {_printed(row)}"] = None
    return tuple(
        f"{next(iter(figures))}{f' and {len(figures) - 1} more' if len(figures) > 1 else ''}: {note}"
        for note, figures in tables.items()
    )


def _variants(rows: Sequence[Row]) -> list[str]:
    """The variants of the rows, each once."""
    return list(dict.fromkeys(row["variant"] for row in rows))


def _key(row: Row) -> tuple[Any, ...]:
    """The key that identifies a printed figure: quantity, value and place in the source."""
    return row["quantity"], row["published"], row["source"]


def _met_words(rows: Sequence[Row], variant: str) -> str:
    """How many printed figures a variant reproduces and, if any, how many it comes near, in words."""
    signs = [PUBLISHED[row["verdict"]].style for row in rows if row["variant"] == variant]
    near = f" and {signs.count('near')} within 6 %" if "near" in signs else ""
    return f"{variant} {signs.count('pass')} of {len(signs)} to the last printed digit{near}"


def _printed(row: Row) -> str:
    """The printed value as text, with its unit."""
    return f"{_as_printed(row)} {row['unit']}".strip()


def _as_printed(row: Row) -> str:
    """The printed value as text, with the zeros at its end, which tell its accuracy; without its unit.

    A zero, a value of unknown accuracy and one with more digits than that have no zeros at the end.
    """
    value, digit = row["published"], 2.0 * row["half_digit"]
    if value and digit:
        digits = math.floor(math.log10(abs(value))) - round(math.log10(digit)) + 1
        text = f"{value:#.{min(max(digits, 1), 15)}g}".removesuffix(".")
        if float(text) == value:
            return text
    return _digits(row, value)


def _variant_cell(row: Row) -> TableCell:
    """Our value in the printed unit, a dash for none, with the sign of the verdict and any deviation in per cent."""
    sign, deviation = PUBLISHED[row["verdict"]], row["deviation"]
    share = ""
    if deviation is not None:
        seen = deviation if abs(deviation) > ROUNDING else 0.0
        share = f" {signed(seen, '.1%' if abs(seen) >= VISIBLE or not seen else '.0e')}"
    value = ABSENT if row["ours"] is None else _digits(row, row["ours"], DIGITS)
    return TableCell(f"{value} {sign.symbol}{share}", sign.style, sign.colour)


def _digits(row: Row, value: float, most: int = 17) -> str:
    """A value as text with as many digits as the source printed, but at least four and at most ``most``.

    Zeros at its end are left out.
    """
    shown = 0.0
    if row["published"] and row["half_digit"]:
        shown = math.log10(abs(row["published"])) - math.log10(row["half_digit"])
    return f"{value:.{min(max(4, math.ceil(shown)), most)}g}"
