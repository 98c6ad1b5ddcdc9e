"""Results for a terminal: key figures of a motion, or every signal at chosen instants, in the units of the file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from analytic.signals import COMPONENTS, MAGNITUDE
from comparisons.datasheet.curves import TIME
from comparisons.datasheet.linkage_warnings import warnings
from comparisons.datasheet.sheet import Sheet
from reports.document.numbers import figure
from reports.document.parts import Paragraph, Table
from reports.document.terminal import Printed
from reports.mechanism.shown import HEADS, figures_table, number, place_cells, places

DRIVE_COLUMNS: Final = (
    ("omega", "epsilon", "Mkr", "Peq"),
    ("Teq", "Jeq", "S", "v", "a"),
)  # of two tables


def key_figures(sheet: Sheet) -> list[Printed]:
    """Drive, forces, transmission angles and output, each with where its peak is."""
    return _printed(sheet, [*(figures_table(sheet, name) for name in HEADS if sheet.figures[name]), *_output(sheet)])


def _printed(sheet: Sheet, tables: Sequence[Table]) -> list[Printed]:
    """Conditions, tables, signs, what the file does not give, and the warnings of ``linkproof check``."""
    slips = [Paragraph(f"warning: {text}", colour="yellow") for text in warnings(sheet.linkage)]
    spaced = (part for table in tables if table.rows for part in ("", table))
    return [Paragraph(sheet.conditions, colour="bold"), *spaced, "", *sheet.remarks, *slips]


def _output(sheet: Sheet) -> Iterator[Table]:
    if sheet.linkage.output is not None:
        head = (f"output {sheet.linkage.output.point}", "", "", *places(sheet, "at "))
        rows = [
            (row.what, number(sheet, row), sheet.unit_of(row).name, *place_cells(sheet, row))
            for row in sheet.figures["output"]
        ]
        yield Table("", head, rows, "lrlr")


def at_instants(sheet: Sheet) -> list[Printed]:
    """Every signal at the chosen instants: crank and output, points, links, joints."""
    tables = [_instants_table(sheet, [name for name in names if name in sheet.values]) for names in DRIVE_COLUMNS]
    for kind, head in (("point", "point"), ("link", "link"), ("joint_force", "force in"), ("shaking_force", "force")):
        tables += _part_tables(sheet, kind, head)
    return _printed(sheet, tables)


def _instants_table(sheet: Sheet, names: Sequence[str]) -> Table:
    """One row per chosen instant, one column per named signal of the drive and the output."""
    head = [*places(sheet), *(_column_head(sheet, name, name) for name in names)]
    columns = [_column(sheet, name) for name in names]
    rows = [(*where, *cells) for where, cells in zip(_instants(sheet), zip(*columns, strict=True), strict=False)]
    return Table("", head, rows, "r")


def _part_tables(sheet: Sheet, kind: str, title: str) -> Iterator[Table]:
    """A table of all signals of a kind, a row for every part and instant."""
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
    return f"{label} {sheet.unit(name).name}"


def _instants(sheet: Sheet) -> list[tuple[str, ...]]:
    """The first cells of every row: φ in the file's unit, before it the time, s, unless φ is the axis."""
    angles = [f"{round(sheet.angle(phi), 9) + 0.0:.6g}" for phi in sheet.table["phi"].tolist()]
    times = [f"{time:.6g}" for time in sheet.table[TIME].tolist()]
    return [(phi,) for phi in angles] if sheet.axis == "phi" else [*zip(times, angles, strict=True)]


def _column(sheet: Sheet, name: str) -> list[str]:
    return [figure(sheet.without_rounding(name, value) / sheet.unit(name).size) for value in sheet.table[name].tolist()]
