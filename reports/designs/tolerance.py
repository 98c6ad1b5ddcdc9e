"""A tolerance study in the units of the linkage's file: tables, CSV, JSON, labelled arrays and a picture."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from analytic.description.written import csv_text, finite, plain
from analytic.errors import printable
from comparisons.designer.linkage_check import warnings
from comparisons.designer.tolerances import EXACT, QUANTILES, SEED, ToleranceStudy
from reports.document.numbers import ABSENT, figure, printed
from reports.document.parts import Paragraph, Table
from reports.document.study import PICTURES, Content, Study
from reports.document.terminal import Printed, Printout

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

HEAD: Final = ("parameter", "±", "", "derivative", "", "moves it by ±", "share of variance")
NOTE: Final = "± of a normal distribution are three standard deviations, of a uniform one its limits."
TIED, NONE = "none: equal local maxima", "none"


@dataclass(frozen=True, repr=False)
class Tolerance(Study):
    """The effect of tolerances on results, in the units of the file."""

    suffixes: ClassVar = (".csv", ".json", *PICTURES)
    study: ToleranceStudy

    @property
    def warnings(self) -> Sequence[str]:
        """Warnings about results at open ends and about probable slips of the file; [] without any."""
        return [*self._open_ends, *warnings(self.study.case.linkage)]

    @property
    def _open_ends(self) -> list[str]:
        """The sentence on results at open ends as the only member; [] without any."""
        return [*filter(None, [self.study.at_open_end.sentence])]

    @cached_property
    def dataset(self) -> xarray.Dataset:
        """The study over ``result`` and ``parameter``.

        ``contribution`` (±), ``share`` (of the variance), ``worst`` (±, all together) and ``linear_deviation`` follow
        from ``derivative``, whose attribute ``derivatives`` is exact or difference. ``change`` (over ``limit``) is
        computed with one number at its limit, ``corner`` (``end``) with all; ``mean``, ``deviation`` and ``quantile``
        are of random designs. Derivatives are NaN where two local maxima are equal, and so are values of designs that
        do not assemble.
        """
        import xarray as xr  # noqa: PLC0415 - half a second that tables save

        study, numbers = self.study, self.study.tolerances
        size = np.array([figure.unit.size for figure in study.figures])
        own = np.array([number.parameter.unit.size for number in numbers])
        of, by = ("result",), ("result", "parameter")
        return xr.Dataset(
            {
                "nominal": (of, study.nominal / size),
                "derivative": (by, study.derivatives * own / size[:, None]),
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
                "result": [figure.name for figure in study.figures],
                "units": (of, [figure.unit.name for figure in study.figures]),
                "parameter": [number.name for number in numbers],
                "parameter_units": (("parameter",), [number.parameter.unit.name for number in numbers]),
                "plus_minus": (("parameter",), [number.plus_minus for number in numbers] / own),
                "distribution": (("parameter",), [str(number.distribution) for number in numbers]),
                "limit": ["lower", "upper"],
                "end": ["least", "largest"],
                "level": [*QUANTILES],
            },
            attrs={**self._about, "corners": "all" if study.has_all_corners else "the two that derivatives single out"},
        )

    @property
    def _about(self) -> dict[str, Any]:
        """The linkage, the conditions, and how derivatives and random designs were found, JSON-ready."""
        linkage = self.study.case.linkage
        return {
            "mechanism": linkage.name,
            "variant": linkage.variant,
            "conditions": self.study.case.conditions,
            "samples": self.study.random.shape[1],
            "seed": SEED,
            "assembled": self.study.assembled,
            "derivatives": self.study.how,
        }

    def printout(self) -> Printout:
        """The printed study: a table per result, the largest contribution first; then worst case and random designs."""
        parts: list[Printed] = [Paragraph(self.study.case.conditions, colour="bold")]
        for result in range(len(self.study.figures)):
            parts += ["", self._table(result), *_sentences(self.study, result)]
        return Printout([*parts, ""], [self.sentence(), NOTE])

    def sentence(self) -> Printed:
        """The number of random designs and the share of them that does not assemble, in a sentence."""
        lost, count = 1.0 - self.study.assembled, self.study.random.shape[1]
        outcome = f"{lost:.2%} of them do not assemble" if lost else "all of them assemble"
        return f"{count} random designs, seed {SEED}: {outcome}"

    def _table(self, result: int) -> Table:
        """The table of one result, by its index, a row for each tolerance, the largest contribution first."""
        named, rows = self.study.figures[result], self._rows_of(result)
        order = np.argsort(-self.study.contributions[result], kind="stable")
        cells = [_cells(rows[number]) for number in order]
        return Table(f"{named.shown}: {figure(rows[0]['nominal'], 6)}", HEAD, cells, "lrlrlrr")

    def rows(self) -> Sequence[Mapping[str, Any]]:
        """A row for each result and each toleranced number, in the file's units, JSON-ready."""
        return [row for result in range(len(self.study.figures)) for row in self._rows_of(result)]

    def _rows_of(self, result: int) -> list[dict[str, Any]]:
        """The rows of one result, by its index, a row per toleranced number, in the file's units, JSON-ready."""
        study, named = self.study, self.study.figures[result]
        rows = []
        for column, number in enumerate(study.tolerances):
            unit = number.parameter.unit
            low, high = plain(study.changes[result, column] / named.unit.size)
            rows.append({
                "result": named.name,
                "result unit": named.unit.name,
                "nominal": float(study.nominal[result] / named.unit.size),
                "parameter": number.name,
                "units": unit.name,
                "plus_minus": number.plus_minus / unit.size,
                "distribution": str(number.distribution),
                "derivative": finite(float(study.derivatives[result, column] * unit.size / named.unit.size)),
                "derivative is": study.how,
                "contribution": finite(float(study.contributions[result, column] / named.unit.size)),
                "share of variance": finite(float(study.shares[result, column])),
                "at lower limit": low,
                "at upper limit": high,
            })  # fmt: skip
        return rows

    def to_dict(self) -> Mapping[str, Any]:
        """The study as JSON prints it, without the single random designs; None for numbers that are not finite."""
        results = {figure.name: self._document(row) for row, figure in enumerate(self.study.figures)}
        return {**self._about, "results": results, "warnings": self._open_ends}

    def _document(self, result: int) -> dict[str, Any]:
        """The data of one result, by its index, in the file's units, JSON-ready."""
        study, named = self.study, self.study.figures[result]
        size = named.unit.size
        return {
            "units": named.unit.name,
            "nominal": float(study.nominal[result] / size),
            "at_open_end": named.name in study.at_open_end.names,
            "tolerances": self._rows_of(result),
            "worst case": {
                "linear": finite(float(study.worst[result] / size)),
                "corners": plain(study.corners[result] / size),
                "every corner": study.has_all_corners,
                "corners that do not assemble": study.lost_corners,
            },
            "linear standard deviation": finite(float(study.deviations[result] / size)),
            "random": {
                "mean": float(study.mean[result] / size),
                "standard deviation": float(study.deviation[result] / size),
                "quantiles": plain(study.quantiles[result] / size),
            },
        }

    def plot(self) -> Figure:
        """A figure of the change of each result by each tolerance, 25 at most in a panel."""
        return tornado_figure(self.study)

    def content(self, suffix: str, **form: Any) -> Content:  # noqa: ANN401
        """The content of a file with this suffix: picture, JSON, or CSV text with a line per row of ``rows``."""
        if suffix != ".csv":
            return super().content(suffix, **form)
        rows, text = self.rows(), io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(rows[0])
        writer.writerows([csv_text(cell) if isinstance(cell, str) else cell for cell in row.values()] for row in rows)
        return text.getvalue()


def _cells(row: Mapping[str, Any]) -> tuple[str, ...]:
    """The printed cells of a row of ``rows``: number, ±, unit, distribution, derivative, its kind, effect, share."""
    derivative, share, how = row["derivative"], row["share of variance"], row["derivative is"]
    return (
        row["parameter"],
        printed(row["plus_minus"]),
        f"{row['units']} {row['distribution']}".strip(),
        figure(derivative),
        how if derivative is not None else TIED if how == EXACT else NONE,
        figure(row["contribution"]),
        ABSENT if share is None else f"{share:.1%}",
    )


def _sentences(study: ToleranceStudy, row: int) -> Iterator[str]:
    """Yield sentences on the worst case and the random designs of a result, each beside the linear estimate.

    ``row`` is the result's index.
    """
    unit = study.figures[row].unit
    end = f" {unit.name}".rstrip()
    nominal, worst = study.nominal[row] / unit.size, study.worst[row] / unit.size
    low, high = study.corners[row] / unit.size
    count = 2 ** len(study.tolerances)
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


# Tornadoes: which parameter moves a result by how much, the largest on top.

FAILS: Final = " (does not assemble)"  # at one of its limits
MOST: Final = 25  # parameters in one panel
ROW, FRAME = 0.27, 0.95  # in, height of a parameter and of all else in a panel


def tornado_figure(study: ToleranceStudy) -> Figure:
    """A figure with a panel per result, of the 25 parameters at most that move it most.

    On top stand parameters at whose limits the linkage does not assemble; their change is nan.
    """
    from reports.charts import draw  # noqa: PLC0415 - a table needs no matplotlib

    def place(figure: Figure) -> None:
        """Draw a panel for each result, with one legend above, into a figure."""
        host = draw.head(figure, [study.case.conditions])
        grid = host.subplots(len(study.figures), squeeze=False)[:, 0]
        for result, axes in enumerate(grid):
            _plot_tornado(axes, study, result)
        host.legend(*grid[0].get_legend_handles_labels(), loc="outside upper left", ncols=2)

    height = ROW * min(len(study.tolerances), MOST) + FRAME
    return draw.drawn(draw.FULL_WIDTH, height * len(study.figures), place)


def _plot_tornado(axes: Axes, study: ToleranceStudy, result: int) -> None:
    """Draw the changes of one result, by its index, at both limits of each parameter, the largest change on top.

    Of more than 25 parameters only the first are drawn.
    """
    from reports.charts import draw  # noqa: PLC0415

    named = study.figures[result]
    changes = study.changes[result] / named.unit.size
    sizes = np.max(np.nan_to_num(np.abs(changes), nan=np.inf), axis=1)
    shown = np.argsort(-sizes, kind="stable")[:MOST]
    for side, name in enumerate(("at the lower limit", "at the upper limit")):
        places = np.arange(len(shown)) + 0.17 * (2 * side - 1)
        axes.barh(places, changes[shown, side], 0.3, color=draw.PALETTE[side], label=name)
    left = f"; the {MOST} of {len(sizes)} that move it most" if len(sizes) > MOST else ""
    title = f"{named.name}: {figure(study.nominal[result] / named.unit.size)} {named.unit.name}".rstrip() + left
    names = [printable(study.tolerances[n].name) + FAILS * bool(np.isnan(changes[n]).any()) for n in shown]
    axes.set(ylim=(len(names) - 0.5, -0.5), title=printable(title))
    axes.set(xlabel=printable(draw.axis_label("change", named.unit.name)), yticks=range(len(names)), yticklabels=names)
    axes.margins(x=0.05)
    axes.axvline(0.0, color=draw.MUTED, linewidth=0.9)
