"""A tolerance study for a terminal: of each result what moves it, the worst case and the random designs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from comparisons.designs.tolerance.tolerance_study import EXACT, ToleranceStudy
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
    named_figure = study.request.figures[row]
    order = np.argsort(-study.contributions[row], kind="stable")
    rows = [_row(study, row, int(column)) for column in order]
    return Table(
        f"{named_figure.shown}: {figure(study.nominal[row] / named_figure.unit.size, 6)}", HEAD, rows, "lrlrlrr"
    )


def _row(study: ToleranceStudy, row: int, column: int) -> tuple[str, ...]:
    tolerance, unit = study.request.tolerances[column], study.request.figures[row].unit
    derivative = study.derivatives[row, column]
    own = tolerance.parameter.unit
    return (
        tolerance.name,
        printed(tolerance.plus_minus / own.size),
        f"{own.name} {tolerance.distribution}".strip(),
        figure(derivative * own.size / unit.size),
        study.how if not np.isnan(derivative) else TIED if study.how == EXACT else NONE,
        figure(study.contributions[row, column] / unit.size),
        ABSENT if np.isnan(study.shares[row, column]) else f"{study.shares[row, column]:.1%}",
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
