"""How far engines may be trusted over a space of designs: where they fail, and how far off they are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from analytic.errors import printable
from reports.charts import draw, labels
from reports.charts.style import FULL_WIDTH
from reports.document.chart import Chart, Curve, Ink, Mark, Panel

Array = NDArray[np.float64]

WITHIN, BEYOND, NOTHING = "within limits", "beyond a limit", "gave no result"
# Of each verdict its marker and colour: a shape of its own, for those who do not tell colours apart.
SIGNS: Final[Mapping[str, tuple[str, Ink]]] = {WITHIN: ("o", 2), BEYOND: ("s", 1), NOTHING: ("X", "limit")}
COLUMNS, PANEL, SIZE = 4, 2.7, 5.0  # panels beside one another; in, height of a row; points, of a marker
ON_TOP: Final = " (above all errors)"
LEAST: Final = 1e-16  # no error below is worth a decade


class Trial(NamedTuple):
    """A simulated design: its parameters in the units of the file, its largest error by peak (nan: none), the verdict.

    The verdict is one of ``SIGNS``.
    """

    parameters: tuple[float, ...]
    error: float
    verdict: str


def trust_figure(
    trials: Mapping[str, Sequence[Trial]], parameters: Sequence[str], limit: float | None, *head: str
) -> Figure:
    """For every engine its designs over the two parameters that tell failures best, and the error over the first.

    ``parameters`` are names with their units. What gave no result stands at the top of the axis of errors.
    """
    columns = min(COLUMNS, len(trials) * min(len(parameters), 2)) or 1
    room = FULL_WIDTH / columns - 1.0
    panels = [panel for engine, mine in trials.items() for panel in _panels(engine, mine, parameters, limit, room)]
    verdicts = {trial.verdict for mine in trials.values() for trial in mine}
    key = [_dots((), (), one, f"{one}{ON_TOP if one == NOTHING else ''}") for one in SIGNS if one in verdicts]
    key += [Curve(np.zeros(0), np.zeros(0), "limit", "limit", "--", width=0.9)] if limit else []
    height = PANEL * -(-len(panels) // columns)
    return draw.figure(Chart(tuple(panels), height, columns, wide=True, head=head, key=tuple(key), own_x=True))


def _panels(
    engine: str, trials: Sequence[Trial], parameters: Sequence[str], limit: float | None, room: float
) -> list[Panel]:
    """The plane of two parameters, if there are two, and the error over the first."""
    values = np.array([trial.parameters for trial in trials], dtype=float).reshape(len(trials), len(parameters))
    errors = np.array([trial.error for trial in trials], dtype=float)
    verdicts = np.array([trial.verdict for trial in trials], dtype=object)
    order = telling(values, errors, verdicts != WITHIN)
    there = np.isfinite(errors)
    largest = max([*errors[there], limit or LEAST, LEAST])
    heights = np.where(there, np.maximum(errors, LEAST), 10.0 ** (np.ceil(np.log10(largest)) + 1.0))
    names = [labels.fitting_label(printable(parameters[place]), room) for place in order[:2]]
    title = labels.fitting(f"{engine}: {np.count_nonzero(verdicts == WITHIN)} of {len(trials)} {WITHIN}", room)

    def curves(y: Array) -> tuple[Curve, ...]:
        return tuple(_dots(values[verdicts == one, order[0]], y[verdicts == one], one) for one in SIGNS)

    marks = (Mark(limit, "y", ink="limit"),) if limit else ()
    error = Panel(curves(heights), names[0], "largest |error| / peak", marks, scale="log", names="", title=title)
    if len(names) < 2:
        return [error]
    return [Panel(curves(values[:, order[1]]), names[0], names[1], names="", title=title), replace(error, title="")]


def _dots(x: Array | Sequence[float], y: Array | Sequence[float], verdict: str, name: str = "") -> Curve:
    marker, ink = SIGNS[verdict]
    return Curve(np.asarray(x, dtype=float), np.asarray(y, dtype=float), name, ink, "", marker=marker, size=SIZE)


def telling(values: Array, errors: Array, fails: NDArray[np.bool_]) -> list[int]:
    """The parameters, columns of values (designs, parameters), the one first that tells best which designs fail.

    That is the one with the largest distance between the distributions of both kinds (Kolmogorov and Smirnov). Where
    all fail or none does, the larger half of the errors stands for failures.
    """
    if np.all(fails) or not np.any(fails):
        size = np.where(np.isfinite(errors), errors, np.inf)
        fails = np.argsort(np.argsort(size, kind="stable")) >= len(size) // 2
    distances = []
    for column in values.T:
        sides = [np.sort(column[side]) for side in (fails, ~fails)]
        shares = [np.searchsorted(side, column, side="right") / max(len(side), 1) for side in sides]
        distances.append(float(np.max(np.abs(shares[0] - shares[1]), initial=0.0)))
    return sorted(range(len(distances)), key=lambda place: -distances[place])
