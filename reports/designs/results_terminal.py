"""Results for a terminal, as a tidy table and as JSON: key figures of a motion, or every signal at chosen instants.

Terminal and table are in the units of the linkage's file, JSON is in SI.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.written import plain
from analytic.signals import COMPONENTS, MAGNITUDE, THREAD_FEED
from comparisons.designer.curves import TIME
from comparisons.designer.sheet import Sheet
from reports.document.numbers import figure
from reports.document.parts import Paragraph, Table
from reports.document.terminal import Printed
from reports.mechanism.shown import HEADS, figures_table, number, place_cells, places, required_table, warning_texts

Array = NDArray[np.float64]

DRIVE_COLUMNS: Final = (
    ("omega", "epsilon", "Mkr", "Peq"),
    ("Teq", "Jeq", "S", "v", "a", THREAD_FEED),
)  # of two tables


def printed(sheet: Sheet) -> list[Printed]:
    """The conditions, tables of the key figures or of every signal at the chosen instants, and remarks, as parts.

    The remarks are on signs and what the file does not give.
    """
    tables = _key_figures(sheet) if sheet.chosen is None else _at_instants(sheet)
    parts = (part for table in tables for part in ("", table))
    return [Paragraph(sheet.conditions, colour="bold"), *parts, "", *sheet.remarks]


def _key_figures(sheet: Sheet) -> Iterator[Table]:
    """Yield the tables of key figures: drive, forces, transmission angles, thread and output, with their places.

    Those that the linkage lacks are left out.
    """
    yield from (figures_table(sheet, name) for name in HEADS if sheet.figures[name])
    if sheet.linkage.output is not None:
        head = (f"output {sheet.linkage.output.point}", "", "", *places(sheet, "at "))
        rows = [
            (row.what, number(sheet, row), sheet.unit_of(row).name, *place_cells(sheet, row))
            for row in sheet.figures["output"]
        ]
        yield Table("", head, rows, "lrlr")
    if sheet.required:
        yield required_table(sheet)


def _at_instants(sheet: Sheet) -> list[Table]:
    """The tables of all signals at the chosen instants: crank and output, points, links, joints."""
    tables = [_instants_table(sheet, [name for name in names if name in sheet.values]) for names in DRIVE_COLUMNS]
    for kind, head in (("point", "point"), ("link", "link"), ("joint_force", "force in"), ("shaking_force", "force")):
        tables += _part_tables(sheet, kind, head)
    return [table for table in tables if table.rows]


def _instants_table(sheet: Sheet, names: Sequence[str]) -> Table:
    """The table of some signals: a row per chosen instant, a column per signal."""
    head = [*places(sheet), *(_column_head(sheet, name, name) for name in names)]
    columns = [_column(sheet, name) for name in names]
    rows = [(*where, *cells) for where, cells in zip(_instants(sheet), zip(*columns, strict=True), strict=False)]
    return Table("", head, rows, "r")


def _part_tables(sheet: Sheet, kind: str, title: str) -> Iterator[Table]:
    """Yield the table of all signals of a kind, a row for every part and instant; nothing without parts.

    ``title`` heads the column of parts.
    """
    parts = dict.fromkeys(name.rpartition(":")[0] for name in sheet.units if name.startswith(f"{kind}:"))
    components = [f":{component}" for component in COMPONENTS[kind]] + ([MAGNITUDE] if "force" in kind else [])
    labels = [
        "|F|" if component == MAGNITUDE else f"F{component[1:]}" if "force" in kind else component[1:]
        for component in components
    ]
    rows: list[tuple[str, ...]] = []
    for part in parts:
        columns = [_column(sheet, part + component) for component in components]
        name = part.partition(":")[2] or "shaking"
        for row, (where, cells) in enumerate(zip(_instants(sheet), zip(*columns, strict=True), strict=True)):
            rows.append(("" if row else name, *where, *cells))
    if parts:
        first = next(iter(parts))
        named = (_column_head(sheet, first + key, label) for key, label in zip(components, labels, strict=True))
        yield Table("", (title, *places(sheet), *named), rows)


def _column_head(sheet: Sheet, name: str, label: str) -> str:
    """The label of a signal's column with its unit in the file."""
    return f"{label} {sheet.unit(name).name}"


def _instants(sheet: Sheet) -> list[tuple[str, ...]]:
    """The first cells of every row: the time, s, unless φ is the axis, and φ in the file's unit, as text."""
    angles = [f"{round(sheet.angle(phi), 9) + 0.0:.6g}" for phi in sheet.table["phi"].tolist()]
    times = [f"{time:.6g}" for time in sheet.table[TIME].tolist()]
    return [(phi,) for phi in angles] if sheet.axis == "phi" else [*zip(times, angles, strict=True)]


def _column(sheet: Sheet, name: str) -> list[str]:
    """A signal's values at the instants as text, in the file's unit."""
    return [figure(sheet.without_rounding(name, value) / sheet.unit(name).size) for value in sheet.table[name].tolist()]


# Results as files.


def columns(sheet: Sheet) -> dict[str, Array]:
    """Every signal at every instant of the table, (n,), in the file's units, by name and unit, the axis first."""
    names = sorted(sheet.table, key=lambda name: name != sheet.axis)  # stable: the rest keeps its order
    units = {name: sheet.unit(name) for name in names}
    return {f"{name} [{unit.name}]": sheet.table[name] / unit.size + 0.0 for name, unit in units.items()}


def csv_table(sheet: Sheet, decimal: str = ".") -> str:
    """The sheet as CSV text, a column for each signal; ``decimal`` is the mark in numbers.

    With a decimal comma, semicolons separate the cells, and a byte-order mark makes a spreadsheet read UTF-8, so that
    it shows ° and φ as they are.
    """
    text, table = io.StringIO(), columns(sheet)
    has_comma = decimal == ","
    writer = csv.writer(text, lineterminator="\n", delimiter=";" if has_comma else ",")
    writer.writerow(table)
    rows = ([f"{value:z.15g}" for value in row] for row in np.column_stack([*table.values()]).tolist())
    writer.writerows([cell.replace(".", decimal) for cell in row] for row in rows)
    return f"\ufeff{text.getvalue()}" if has_comma else text.getvalue()


def json_text(sheet: Sheet) -> str:
    """The document of a sheet as JSON in one line, with a line's end."""
    return json.dumps(document(sheet), ensure_ascii=False, allow_nan=False) + "\n"


def document(sheet: Sheet) -> dict[str, Any]:
    """One object, JSON-ready, SI, angles in rad: ``conditions axis units values peaks figures warnings``.

    ``values`` has a list by name, ``peaks`` by name the value and where it is: φ where that is the axis, else the time,
    and whether that is an open end of the motion. ``figures`` has the tables of ``comparisons.designer.figures``,
    ``required``, where the file states it, the feed required of a thread beside the actual one. What is not finite is
    null.
    """
    table: dict[str, Any] = {
        "conditions": sheet.conditions,
        "axis": sheet.axis,
        "units": sheet.units,
        "values": {name: plain(values) for name, values in sheet.table.items()},
        "peaks": {
            name: {"value": peak.value, "at": sheet.place_of(peak), "at_open_end": peak.at_open_end}
            for name, peak in sheet.peaks.items()
        },
        "figures": {name: [vars(row) for row in rows] for name, rows in sheet.figures.items()},
        "warnings": warning_texts(sheet),
    }
    if sheet.required:
        table["required"] = {name: plain(values) for name, values in sheet.required.items()}
    return table
