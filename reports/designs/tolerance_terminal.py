"""A tolerance study for a terminal: of each result what moves it, the worst case and the random designs."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure

from analytic.errors import printable
from analytic.written import csv_text, finite, plain
from comparisons.designs.tolerance_study import EXACT, ToleranceStudy
from comparisons.designs.tolerances import Tornado
from reports.charts import draw
from reports.document import numbers
from reports.document.chart import Chart, Curve, Mark, Panel
from reports.document.numbers import ABSENT, figure, printed
from reports.document.parts import Paragraph, Table
from reports.document.terminal import Printed, Printout

HEAD: Final = ("parameter", "±", "", "derivative", "", "moves it by ±", "share of variance")
NOTE: Final = "± of a normal distribution are three standard deviations, of a uniform one its limits."
TIED, NONE = "none: equal local maxima", "none"


def printout(study: ToleranceStudy) -> Printout:
    """A table per result, rows by contribution, then in sentences the worst case and the random designs."""
    parts: list[Printed] = [Paragraph(study.request.conditions, colour="bold")]
    for row in range(len(study.request.figures)):
        parts += ["", _table(study, row), *_sentences(study, row)]
    lost = 1.0 - study.assembled
    random = f"{study.request.samples} random designs, seed {study.request.seed}"
    closing = [f"{random}: " + (f"{lost:.2%} of them do not assemble" if lost else "all of them assemble"), NOTE]
    return Printout([*parts, ""], closing)


def _table(study: ToleranceStudy, row: int) -> Table:
    named_figure, cells = study.request.figures[row], _cells(study, row)
    order = np.argsort(-study.contributions[row], kind="stable")
    rows = [_row(cells[column], study.how) for column in order]
    return Table(
        f"{named_figure.shown}: {figure(study.nominal[row] / named_figure.unit.size, 6)}", HEAD, rows, "lrlrlrr"
    )


def _row(cells: Sequence[Any], how: str) -> tuple[str, ...]:
    """The cells of one toleranced number, as a terminal shows them."""
    name, unit, plus_minus, distribution, derivative, contribution, share, *_ = cells
    return (
        name,
        printed(plus_minus),
        f"{unit} {distribution}".strip(),
        figure(derivative),
        how if derivative is not None else TIED if how == EXACT else NONE,
        figure(contribution),
        ABSENT if share is None else f"{share:.1%}",
    )


def _sentences(study: ToleranceStudy, row: int) -> Iterator[str]:
    """Worst case and random designs, each beside what is linear."""
    unit = study.request.figures[row].unit
    end = f" {unit.name}".rstrip()
    nominal, worst = study.nominal[row] / unit.size, study.worst[row] / unit.size
    low, high = study.corners[row] / unit.size
    which = "all" if study.has_all_corners else "the two to which derivatives point,"
    corners = 2 ** len(study.request.tolerances) if study.has_all_corners else 2
    lost = f", of which {study.lost_corners} do not assemble" if study.lost_corners else ""
    yield (
        f"worst case: {figure(nominal - worst, 6)} to {figure(nominal + worst, 6)}{end} linear; "
        f"{figure(low, 6)} to {figure(high, 6)}{end} of {which} {corners} corners{lost}"
    )
    linear, deviation = study.deviations[row] / unit.size, study.deviation[row] / unit.size
    least, most = study.quantiles[row] / unit.size
    apart = f", linear {figure(linear)}, {figure(abs(deviation / linear - 1.0) * 100.0, 2)} % apart" if linear else ""
    yield (
        f"random: mean {figure(study.mean[row] / unit.size, 6)}{end}, standard deviation {figure(deviation)}{apart}; "
        f"99.73 % from {figure(least, 6)} to {figure(most, 6)}{end}"
    )


# A tolerance study as data, in the units of the linkage's file: JSON and a table of results times parameters.

COLUMNS: Final = (
    *("result", "result unit", "nominal", "parameter", "parameter unit", "plus_minus", "distribution", "derivative"),
    *("derivative is", "contribution", "share of variance", "at lower limit", "at upper limit"),
)


def document(study: ToleranceStudy) -> dict[str, Any]:
    """Everything but the random designs themselves; what is not finite is null."""
    request = study.request
    return {
        "mechanism": request.mechanism.linkage.name,
        "variant": request.mechanism.linkage.variant,
        "conditions": request.conditions,
        "samples": request.samples,
        "seed": request.seed,
        "assembled": study.assembled,
        "derivatives": study.how,
        "results": {figure.name: _result(study, row) for row, figure in enumerate(request.figures)},
    }


def _result(study: ToleranceStudy, row: int) -> dict[str, Any]:
    """The JSON of one result, in its unit of the file."""
    unit = study.request.figures[row].unit
    return {
        "units": unit.name,
        "nominal": float(study.nominal[row] / unit.size),
        "tolerances": [
            dict(zip(("parameter", "units", *COLUMNS[5:8], *COLUMNS[9:]), cells, strict=True))
            for cells in _cells(study, row)
        ],
        "worst case": {
            "linear": finite(float(study.worst[row] / unit.size)),
            "corners": plain(study.corners[row] / unit.size),
            "every corner": study.has_all_corners,
            "corners that do not assemble": study.lost_corners,
        },
        "linear standard deviation": finite(float(study.deviations[row] / unit.size)),
        "random": {
            "mean": float(study.mean[row] / unit.size),
            "standard deviation": float(study.deviation[row] / unit.size),
            "quantiles": plain(study.quantiles[row] / unit.size),
        },
    }


def _cells(study: ToleranceStudy, row: int) -> list[list[Any]]:
    """Of every tolerance the cells of its row, from its name on, less what the derivative is."""
    unit = study.request.figures[row].unit
    rows = []
    for column, tolerance in enumerate(study.request.tolerances):
        own = tolerance.parameter.unit
        effects = (
            study.derivatives[row, column] * own.size / unit.size,
            study.contributions[row, column] / unit.size,
            study.shares[row, column],
            *study.changes[row, column] / unit.size,
        )
        known = (tolerance.name, own.name, tolerance.plus_minus / own.size, str(tolerance.distribution))
        rows.append([*known, *plain(np.array(effects))])
    return rows


def csv_table(study: ToleranceStudy) -> str:
    """A row per result and parameter."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row, named in enumerate(study.request.figures):
        nominal = float(study.nominal[row] / named.unit.size)
        for cells in _cells(study, row):
            row_cells = [named.name, named.unit.name, nominal, *cells[:5], study.how, *cells[5:]]
            writer.writerow(csv_text(cell) if isinstance(cell, str) else cell for cell in row_cells)
    return text.getvalue()


# Tornadoes: which parameter moves a result by how much, the largest on top.

FAILS: Final = " (does not assemble)"  # at one of its limits
MOST: Final = 25  # parameters in one panel
ROW, FRAME = 0.27, 0.95  # in, height of a parameter and of all else in a panel
LANE, WIDE = 0.17, 6.0  # half a row's two bars apart, and their width in points


def tornado_figure(tornados: Sequence[Tornado], *head: str) -> Figure:
    """A panel per result, below lines of words; parameters that move nothing are left out and counted.

    On top stand parameters at whose limits the linkage does not assemble; their change is nan.
    """
    panels = tuple(map(_panel, tornados))
    height = sum(ROW * len(panel.rows) + FRAME for panel in panels)
    key = (_bar((), (), 0, "at the lower limit"), _bar((), (), 1, "at the upper limit"))
    return draw.figure(Chart(panels, height, wide=True, head=head, key=key, own_x=True))


def _panel(tornado: Tornado) -> Panel:
    """The tornado of one result."""
    sizes = {bar: float(np.max(np.nan_to_num(np.abs(bar[1:]), nan=np.inf))) for bar in tornado.bars}
    moving = sorted((bar for bar, size in sizes.items() if size > 0.0), key=lambda bar: -sizes[bar])
    shown = moving[:MOST]
    curves = tuple(
        _bar(ends, (row + side * LANE,) * 2, ink)
        for row, bar in enumerate(shown)
        for ink, (side, ends) in enumerate(((-1.0, (0.0, bar[1])), (1.0, (0.0, bar[2]))))
    )
    left = [f"{len(moving) - len(shown)} smaller ones are left out"] if len(moving) > len(shown) else []
    still = len(tornado.bars) - len(moving)
    left += [f"{still} {'moves' if still == 1 else 'move'} nothing"] if still else []
    what = f"{tornado.result}: {numbers.figure(tornado.nominal)} {tornado.unit}".rstrip()
    label = ", ".join(filter(None, ("change", tornado.unit)))
    rows = tuple(printable(bar[0]) + FAILS * (sizes[bar] == np.inf) for bar in shown) or ("–",)
    title = printable("; ".join([what, *left]))
    return Panel(curves, printable(label), "", (Mark(0.0),), names="", title=title, rows=rows)


def _bar(x: Sequence[float], y: Sequence[float], ink: int, name: str = "") -> Curve:
    return Curve(np.array(x, dtype=float), np.array(y, dtype=float), name, ink, width=WIDE)
