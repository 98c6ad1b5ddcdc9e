"""The results of one linkage: key figures or every signal at chosen instants in tables, files, and labelled arrays.

Tables, CSV and workbook are in the units of the linkage's file; JSON and labelled arrays are in SI.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from analytic.description.written import plain
from analytic.errors import UnknownNameError, symbol
from analytic.numerics.arrays import Array
from analytic.signals import COMPONENTS, MAGNITUDE, THREAD_FEED
from comparisons.designer.building import page_sheet, sheet
from comparisons.designer.curves import TIME
from comparisons.designer.sheet import Sheet
from comparisons.motion.case import Case
from reports.document.numbers import figure
from reports.document.parts import Paragraph, Table
from reports.document.study import PICTURES, Content, Study
from reports.document.terminal import Printed, Printout
from reports.mechanism.shown import HEADS, figures_table, number, place_cells, places, required_table, warning_texts

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

DRIVE_COLUMNS: Final = (
    ("omega", "epsilon", "Mkr", "Peq"),
    ("Teq", "Jeq", "S", "v", "a", THREAD_FEED),
)  # of two tables


@dataclass(frozen=True, repr=False)
class Results(Study):
    """Every signal of a linkage over a motion of its crank; ``chosen`` are the instants (n,), s, of the tables.

    With None these have key figures. ``dataset`` is in SI, what is printed in the units of the file. ``save`` takes the
    ``decimal`` mark of a .csv, and the one ``figure`` of a picture. Whatever needs the motion raises LinkproofError
    where the linkage cannot make it.
    """

    suffixes: ClassVar = (".csv", ".json", ".xlsx", *PICTURES, ".dxf")
    case: Case
    chosen: Array | None = None

    @cached_property
    def sheet(self) -> Sheet:
        """The sheet with signals and key figures; raises LinkproofError where the linkage cannot make the motion."""
        return sheet(self.case, self.chosen)

    @cached_property
    def _whole_sheet(self) -> Sheet:
        """The sheet with the peaks of all signals, also of those without a table; raises as ``sheet`` does."""
        return sheet(self.case, self.chosen, every_peak=True)

    @cached_property
    def dataset(self) -> xarray.Dataset:
        """The signals in SI over ``phi``, rad, where the crank turns at one speed, else ``time``, s.

        The other stands beside it. Points, links, joints and groups are dimensions of their own, as are the components
        x and y of a vector.
        """
        from reports.designs.labels import labelled  # noqa: PLC0415 - half a second that tables save

        about = {"regime": self.case.motion.regime, "conditions": self.sheet.conditions}
        if self.sheet.open_end_warning:
            about["open_ends"] = self.sheet.open_end_warning
        return labelled(self.sheet.linkage, self.sheet.axis, self.sheet.table, about)

    def __getitem__(self, name: str) -> xarray.DataArray:
        """A variable of the dataset by symbol or word (``torque`` for ``Mkr``); raises UnknownNameError for another."""
        known = self.dataset.variables
        if symbol(name) not in known:
            raise UnknownNameError("signal", name, map(str, known))
        return self.dataset[symbol(name)]

    @property
    def warnings(self) -> Sequence[str]:
        """Warnings about extremes at open ends, and about probable slips of the file; [] without any."""
        return warning_texts(self.sheet)

    def printout(self) -> Printout:
        """The printed tables of key figures, or of every signal at the chosen instants."""
        return Printout(printed(self.sheet), ())

    def sentence(self) -> Printed:
        """The conditions of the motion, in a sentence."""
        return self.sheet.conditions

    def to_dict(self) -> Mapping[str, Any]:
        """The sheet with the peaks of all signals, as JSON prints it: SI, angles in rad, None for no finite number."""
        return document(self._whole_sheet)

    def json(self) -> str:
        """The JSON text in one line, since its lists are long."""
        return json.dumps(self.to_dict(), ensure_ascii=False, allow_nan=False) + "\n"

    def to_pandas(self) -> Any:  # noqa: ANN401 - a DataFrame
        """A DataFrame with a column per signal, by name and unit of the file, and a row per instant."""
        import pandas as pd  # noqa: PLC0415

        return pd.DataFrame(self.sheet.columns)

    def plot(self, figure: str | None = None) -> Figure:
        """A figure of the scheme and the curves, or of one ``figure``, by name, alone.

        Raises LinkproofError for an unknown one and for one that the linkage lacks.
        """
        from reports.designs.results_drawing import results_figure  # noqa: PLC0415 - a second that other files save

        return results_figure(page_sheet(self.case), figure)

    def content(self, suffix: str, *, decimal: str = ".", figure: str | None = None) -> Content:
        """The content of a file with this suffix: text of .csv, .dxf and .json, bytes of .xlsx, a picture.

        A .csv has the ``decimal`` mark, "." or ",", a picture the one ``figure``, by name, or all; a .dxf is at the
        first of the chosen instants, or as sketched. Raises as ``plot`` does.
        """
        if suffix == ".csv":
            return csv_table(self.sheet, decimal)
        if suffix == ".xlsx":
            from reports.designs.results_workbook import workbook  # noqa: PLC0415 - half a second

            return workbook(self.sheet)
        if suffix == ".dxf":
            from reports.designs.results_dxf import dxf  # noqa: PLC0415 - half a second

            result = self.sheet
            assert result.positions is not None
            return dxf(result.linkage, result.positions, None if self.chosen is None else float(result.table["phi"][0]))
        return super().content(suffix, figure=figure) if suffix in PICTURES else self.json()

    def write(self, folder: str | Path) -> Path:
        """Save the case among those of a report's folder and write all its pages; returns the linkage's page's path.

        That is index.html where it is the only page. Raises LinkproofError where another command writes there or a file
        cannot be written.
        """
        from comparisons.trials.campaign.results import save_case  # noqa: PLC0415 - figures cost a second
        from comparisons.trials.runs.files import claim  # noqa: PLC0415
        from reports.mechanism.page import file_of  # noqa: PLC0415
        from reports.site import write_site  # noqa: PLC0415

        out = Path(folder)
        _claimed = claim(out)  # until the pages are written
        save_case(out, self.case)
        index, page = write_site(out, processes=0), out / file_of(self.case.mechanism.linkage)
        return page if page.is_file() else index  # the only one


def printed(sheet: Sheet) -> list[Printed]:
    """The conditions, tables of the key figures or of every signal at the chosen instants, and remarks, as parts.

    The remarks are sentences on signs and what the file does not give.
    """
    tables = _key_figures(sheet) if sheet.chosen is None else _at_instants(sheet)
    parts = (part for table in tables for part in ("", table))
    return [Paragraph(sheet.conditions, colour="bold"), *parts, "", *sheet.remarks]


def _key_figures(sheet: Sheet) -> Iterator[Table]:
    """Yield the tables of key figures with their places: those of ``HEADS`` in order, the output, the required feed.

    Those of ``HEADS`` are drive, flywheel, forces, shaking moment, transmission angles and thread. Those that the
    linkage lacks are left out.
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
    """The tables at the chosen instants: crank and output, points, links, joint forces, the shaking force.

    Tables without rows are left out. Transmission angles and the shaking moment are in none.
    """
    tables = [_instants_table(sheet, [name for name in names if name in sheet.values]) for names in DRIVE_COLUMNS]
    for kind, head in (("point", "point"), ("link", "link"), ("joint_force", "force in"), ("shaking_force", "force")):
        tables += _part_tables(sheet, kind, head)
    return [table for table in tables if table.rows]


def _instants_table(sheet: Sheet, names: Sequence[str]) -> Table:
    """The table of some signals, by name: a row per chosen instant, a column per signal; without signals no rows."""
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
    """The ``label`` of the column of the signal ``name``, with its unit in the file."""
    return f"{label} {sheet.unit(name).name}"


def _instants(sheet: Sheet) -> list[tuple[str, ...]]:
    """The first cells of every row: the time, s, unless φ is the axis, and φ in the file's unit, as text."""
    angles = [f"{round(sheet.angle(phi), 9) + 0.0:.6g}" for phi in sheet.table["phi"].tolist()]
    times = [f"{time:.6g}" for time in sheet.table[TIME].tolist()]
    return [(phi,) for phi in angles] if sheet.axis == "phi" else [*zip(times, angles, strict=True)]


def _column(sheet: Sheet, name: str) -> list[str]:
    """A signal's values at the instants as text, in the file's unit; what is only rounding is 0."""
    return [figure(sheet.without_rounding(name, value) / sheet.unit(name).size) for value in sheet.table[name].tolist()]


# Results as files.


def csv_table(sheet: Sheet, decimal: str = ".") -> str:
    """The sheet as CSV text, a column for each signal in the file's unit; ``decimal`` is the mark in numbers.

    With a decimal comma, semicolons separate the cells, and a byte-order mark makes a spreadsheet read UTF-8, so that
    it shows ° and φ as they are.
    """
    text, table = io.StringIO(), sheet.columns
    has_comma = decimal == ","
    writer = csv.writer(text, lineterminator="\n", delimiter=";" if has_comma else ",")
    writer.writerow(table)
    rows = ([f"{value:z.15g}" for value in row] for row in np.column_stack([*table.values()]).tolist())
    writer.writerows([cell.replace(".", decimal) for cell in row] for row in rows)
    return f"\ufeff{text.getvalue()}" if has_comma else text.getvalue()


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
