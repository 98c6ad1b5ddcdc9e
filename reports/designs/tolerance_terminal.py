"""A tolerance study for a terminal: of each result what moves it, the worst case and the random designs."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from analytic.description.written import csv_text, finite, plain
from analytic.errors import printable
from comparisons.designer.tolerances import EXACT, QUANTILES, SEED, ToleranceStudy
from reports.document.numbers import ABSENT, figure, printed
from reports.document.parts import Paragraph, Table
from reports.document.terminal import Printed, Printout

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

HEAD: Final = ("parameter", "±", "", "derivative", "", "moves it by ±", "share of variance")
NOTE: Final = "± of a normal distribution are three standard deviations, of a uniform one its limits."
TIED, NONE = "none: equal local maxima", "none"


def printout(study: ToleranceStudy) -> Printout:
    """The printed study: a table per result, the largest contribution first; then worst case and random designs."""
    parts: list[Printed] = [Paragraph(study.request.case.conditions, colour="bold")]
    for row in range(len(study.request.figures)):
        parts += ["", _table(study, row), *_sentences(study, row)]
    lost = 1.0 - study.assembled
    random = f"{study.request.samples} random designs, seed {SEED}"
    closing: list[Printed] = [
        f"{random}: " + (f"{lost:.2%} of them do not assemble" if lost else "all of them assemble"),
        NOTE,
    ]
    return Printout([*parts, ""], closing)


def _table(study: ToleranceStudy, row: int) -> Table:
    """The table of one result, a row for each tolerance, the largest contribution first."""
    named_figure = study.request.figures[row]
    order = np.argsort(-study.contributions[row], kind="stable")
    rows = [_row(study, row, int(column)) for column in order]
    return Table(
        f"{named_figure.shown}: {figure(study.nominal[row] / named_figure.unit.size, 6)}", HEAD, rows, "lrlrlrr"
    )


def _row(study: ToleranceStudy, row: int, column: int) -> tuple[str, ...]:
    """The cells of one toleranced number in the table of one result, in the file's units."""
    name, unit, plus_minus, distribution, derivative, contribution, share, *_ = _values(study, row, column)
    return (
        name,
        printed(plus_minus),
        f"{unit} {distribution}".strip(),
        figure(derivative),
        study.how if derivative is not None else TIED if study.how == EXACT else NONE,
        figure(contribution),
        ABSENT if share is None else f"{share:.1%}",
    )


def _values(study: ToleranceStudy, row: int, column: int) -> tuple[Any, ...]:
    """The ``COLUMNS`` of one toleranced number and one result, in the file's units."""
    tolerance, unit = study.request.tolerances[column], study.request.figures[row].unit
    own = tolerance.parameter.unit
    return (
        tolerance.name,
        own.name,
        tolerance.plus_minus / own.size,
        str(tolerance.distribution),
        finite(float(study.derivatives[row, column] * own.size / unit.size)),
        finite(float(study.contributions[row, column] / unit.size)),
        finite(float(study.shares[row, column])),
        *plain(study.changes[row, column] / unit.size),
    )


def _sentences(study: ToleranceStudy, row: int) -> Iterator[str]:
    """Sentences on the worst case and the random designs, each beside the linear estimate."""
    unit = study.request.figures[row].unit
    end = f" {unit.name}".rstrip()
    nominal, worst = study.nominal[row] / unit.size, study.worst[row] / unit.size
    low, high = study.corners[row] / unit.size
    count = 2 ** len(study.request.tolerances)
    where = (
        f"at all {count} combinations of limits"
        if study.has_all_corners
        else f"at the 2 of {count} combinations of limits that the derivatives single out"
    )
    lost = f", of which {study.lost_corners} do not assemble" if study.lost_corners else ""
    yield (
        f"worst case: {figure(nominal - worst, 6)} to {figure(nominal + worst, 6)}{end} linear; "
        f"{figure(low, 6)} to {figure(high, 6)}{end} {where}{lost}"
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
    """The study as JSON-ready data, without the single random designs; None for numbers that are not finite."""
    request = study.request
    return {
        "mechanism": request.case.linkage.name,
        "variant": request.case.linkage.variant,
        "conditions": request.case.conditions,
        "samples": request.samples,
        "seed": SEED,
        "assembled": study.assembled,
        "derivatives": study.how,
        "results": {figure.name: _result(study, row) for row, figure in enumerate(request.figures)},
        "warnings": [request.at_open_end.sentence] if request.at_open_end.names else [],
    }


def _result(study: ToleranceStudy, row: int) -> dict[str, Any]:
    """The data of one result in the file's unit, JSON-ready."""
    unit = study.request.figures[row].unit
    return {
        "units": unit.name,
        "nominal": float(study.nominal[row] / unit.size),
        "at_open_end": study.request.figures[row].name in study.request.at_open_end.names,
        "tolerances": [
            dict(zip(("parameter", "units", *COLUMNS[5:8], *COLUMNS[9:]), cells, strict=True))
            for cells in (_values(study, row, column) for column in range(len(study.request.tolerances)))
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


def csv_table(study: ToleranceStudy) -> str:
    """The study as CSV text, a row per result and parameter."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row, named in enumerate(study.request.figures):
        nominal = float(study.nominal[row] / named.unit.size)
        for column in range(len(study.request.tolerances)):
            cells = _values(study, row, column)
            row_cells = [named.name, named.unit.name, nominal, *cells[:5], study.how, *cells[5:]]
            writer.writerow(csv_text(cell) if isinstance(cell, str) else cell for cell in row_cells)
    return text.getvalue()


# Tornadoes: which parameter moves a result by how much, the largest on top.

FAILS: Final = " (does not assemble)"  # at one of its limits
MOST: Final = 25  # parameters in one panel
ROW, FRAME = 0.27, 0.95  # in, height of a parameter and of all else in a panel


def tornado_figure(study: ToleranceStudy) -> Figure:
    """A figure with a panel per result; parameters that move nothing are left out and counted.

    On top stand parameters at whose limits the linkage does not assemble; their change is nan.
    """
    from reports.charts import draw  # noqa: PLC0415 - a table needs no matplotlib

    panels = [_moving(study, row) for row in range(len(study.request.figures))]
    counts = [max(len(moving[:MOST]), 1) + 1 for moving in panels]

    def place(figure: Figure) -> None:
        """Draw a panel for each result, with one legend above."""
        host = draw.head(figure, [study.request.case.conditions])
        grid = host.subplots(len(panels), squeeze=False, height_ratios=counts)[:, 0]
        for row, (axes, moving) in enumerate(zip(grid, panels, strict=True)):
            _plot_tornado(axes, study, row, moving)
        host.legend(*grid[0].get_legend_handles_labels(), loc="outside upper left", ncols=2)

    return draw.drawn(draw.FULL_WIDTH, sum(ROW * (count - 1) + FRAME for count in counts), place)


def _moving(study: ToleranceStudy, row: int) -> list[int]:
    """Numbers of the parameters that move a result, the largest change first."""
    sizes = np.max(np.nan_to_num(np.abs(study.changes[row]), nan=np.inf), axis=1)
    return [int(column) for column in np.argsort(-sizes, kind="stable") if sizes[column] > 0.0]


def _plot_tornado(axes: Axes, study: ToleranceStudy, row: int, moving: Sequence[int]) -> None:
    """Draw the changes of one result at both limits of each parameter that moves it."""
    from reports.charts import draw  # noqa: PLC0415

    result, tolerances, shown = study.request.figures[row], study.request.tolerances, moving[:MOST]
    changes = study.changes[row] / result.unit.size
    for side, name in enumerate(("at the lower limit", "at the upper limit")):
        places = np.arange(len(shown)) + 0.17 * (2 * side - 1)
        axes.barh(places, changes[shown, side], 0.3, color=draw.PALETTE[side], label=name)
    left = [f"{len(moving) - len(shown)} smaller ones are left out"] if len(moving) > len(shown) else []
    still = len(tolerances) - len(moving)
    left += [f"{still} {'moves' if still == 1 else 'move'} nothing"] if still else []
    unit = result.unit.name
    what = f"{result.name}: {figure(study.nominal[row] / result.unit.size)} {unit}".rstrip()
    names = [printable(tolerances[n].name) + FAILS * bool(np.isnan(changes[n]).any()) for n in shown] or ["–"]
    axes.set(ylim=(len(names) - 0.5, -0.5), title=printable("; ".join([what, *left])))
    axes.set(xlabel=printable(draw.axis_label("change", unit)), yticks=range(len(names)), yticklabels=names)
    axes.margins(x=0.05)
    axes.axvline(0.0, color=draw.MUTED, linewidth=0.9)


def dataset(study: ToleranceStudy) -> xarray.Dataset:
    """The study as labelled arrays, in the units of the linkage's file."""
    import xarray  # noqa: PLC0415 - half a second that tables save

    request = study.request
    size = np.array([figure.unit.size for figure in request.figures])
    parameter_size = np.array([tolerance.parameter.unit.size for tolerance in request.tolerances])
    of, by = ("result",), ("result", "parameter")
    return xarray.Dataset(
        {
            "nominal": (of, study.nominal / size),
            "derivative": (by, study.derivatives * parameter_size / size[:, None]),
            "contribution": (by, study.contributions / size[:, None]),
            "share": (by, study.shares),
            "change": ((*by, "limit"), study.changes / size[:, None, None]),
            "worst": (of, study.worst / size),
            "corner": ((*of, "end"), study.corners / size[:, None]),
            "linear_deviation": (of, study.deviations / size),
            "mean": (of, study.mean / size),
            "deviation": (of, study.deviation / size),
            "quantile": ((*of, "level"), study.quantiles / size[:, None]),
        },
        coords={
            "result": [figure.name for figure in request.figures],
            "units": (of, [figure.unit.name for figure in request.figures]),
            "parameter": [tolerance.name for tolerance in request.tolerances],
            "parameter_units": (("parameter",), [tolerance.parameter.unit.name for tolerance in request.tolerances]),
            "plus_minus": (("parameter",), [tolerance.plus_minus for tolerance in request.tolerances] / parameter_size),
            "distribution": (("parameter",), [str(tolerance.distribution) for tolerance in request.tolerances]),
            "limit": ["lower", "upper"],
            "end": ["least", "largest"],
            "level": [*QUANTILES],
        },
        attrs={
            "mechanism": request.case.linkage.name,
            "variant": request.case.linkage.variant,
            "conditions": request.case.conditions,
            "derivatives": study.how,
            "corners": "all" if study.has_all_corners else "the two that derivatives single out",
            "samples": request.samples,
            "seed": SEED,
            "assembled": study.assembled,
        },
    )
