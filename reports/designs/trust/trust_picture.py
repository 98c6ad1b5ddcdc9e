"""How far engines may be trusted over a space of designs: where they fail, and how far off they are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from analytic.errors import printable
from comparisons.designs.trust.trust import DesignStanding, EngineTrust, SpaceTrust, features, telling
from reports.charts import draw, labels
from reports.charts.style import FULL_WIDTH
from reports.document.chart import Chart, Curve, Ink, Mark, Panel

Array = NDArray[np.float64]

# Of each standing its marker and colour: a shape of its own, for those who do not tell colours apart.
SIGNS: Final[Mapping[DesignStanding, tuple[str, Ink]]] = {
    DesignStanding.WITHIN: ("o", 2),
    DesignStanding.OVER: ("s", 1),
    DesignStanding.NO_RESULT: ("X", "limit"),
    DesignStanding.NOT_JUDGED: ("d", "muted"),
}
COLUMNS, PANEL, SIZE = 4, 2.7, 5.0  # panels beside one another; in, height of a row; points, of a marker
ON_TOP: Final = " (above all errors)"
LEAST: Final = 1e-12  # of a limit: no error below is worth a decade


def trust_svg(trust: SpaceTrust, *head: str) -> str:
    """The picture as an SVG file of its own, on white."""
    return draw.svg(trust_figure(trust, *head), page="white")


def trust_figure(trust: SpaceTrust, *head: str) -> Figure:
    """For every engine its designs over the two features that tell failures best, and the errors over the first.

    Features are the parameters and the least transmission angle; an error is the largest share of its limit. A design
    without a result stands at the top of the axis of errors, one that is not judged only in the plane.
    """
    told = features(trust.sample)
    names = [printable(", ".join(filter(None, feature))) for feature in told]
    values = np.stack([*told.values()], axis=1)
    columns = min(COLUMNS, len(trust.engines) * min(len(names), 2)) or 1
    room = FULL_WIDTH / columns - 1.0
    panels = [panel for engine in trust.engines for panel in _panels(engine, names, values, room)]
    there = {run.standing for engine in trust.engines for run in engine.runs}
    key = [
        _dots(np.zeros((0, 2)), one, f"{one}{ON_TOP if one is DesignStanding.NO_RESULT else ''}")
        for one in SIGNS
        if one in there
    ]
    key.append(Curve(np.zeros(0), np.zeros(0), "limit", "limit", "--", width=0.9))
    height = PANEL * -(-len(panels) // columns)
    return draw.figure(Chart(tuple(panels), height, columns, wide=True, head=head, key=tuple(key), own_x=True))


def _panels(engine: EngineTrust, names: Sequence[str], values: Array, room: float) -> list[Panel]:
    """The plane of two features, if there are two, and the error over the first."""
    standings = np.array([run.standing.value for run in engine.runs])
    lost = standings == DesignStanding.NO_RESULT.value
    shares = np.where(lost, np.nan, np.maximum([run.share for run in engine.runs], LEAST))
    top = 10.0 ** (np.ceil(np.log10(np.nanmax([1.0, *shares]))) + 1.0)
    order = _order(values, shares, np.array([run.gives_way for run in engine.runs]))
    across = [labels.fitting_label(names[place], room) for place in order[:2]]
    within = f"{engine.count(DesignStanding.WITHIN)} of {len(engine.runs)} {DesignStanding.WITHIN}"
    title = f"{engine.engine} {engine.setting}: {within}"

    def curves(upward: Array) -> tuple[Curve, ...]:
        points = np.stack([values[:, order[0]], upward], axis=1)
        return tuple(_dots(points[standings == one.value], one) for one in SIGNS)

    height = np.where(lost, top, shares)
    limit = (Mark(1.0, "y", ink="limit"),)
    error = Panel(curves(height), across[0], "largest error / limit", limit, scale="log", names="")
    if len(across) > 1:
        plane = Panel(curves(values[:, order[1]]), across[0], across[1], names="")
        return [replace(plane, title=labels.fitting(title, room)), error]
    return [replace(error, title=labels.fitting(title, room))]


def _dots(points: Array, standing: DesignStanding, name: str = "") -> Curve:
    """Points (n, 2) of a standing, or its entry in the key."""
    marker, ink = SIGNS[standing]
    return Curve(points[:, 0], points[:, 1], name, ink, "", marker=marker, size=SIZE)


def _order(values: Array, errors: Array, fails: NDArray[np.bool_]) -> list[int]:
    """The features, columns of values (designs, features), the one first that tells best which designs fail.

    Where all fail or none does, the larger half of the errors stands for failures.
    """
    if np.all(fails) or not np.any(fails):
        size = np.where(np.isfinite(errors), errors, np.inf)
        fails = np.argsort(np.argsort(size, kind="stable")) >= len(size) // 2
    return sorted(range(values.shape[1]), key=lambda place: -telling(values[:, place], fails))
