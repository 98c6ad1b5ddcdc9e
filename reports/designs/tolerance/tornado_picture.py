"""Tornadoes: which parameter moves a result by how much, the largest on top."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from matplotlib.figure import Figure

from analytic.errors import printable
from comparisons.designs.tolerance.tolerances import Tornado
from reports.charts import draw
from reports.document import numbers
from reports.document.chart import Chart, Curve, Mark, Panel

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
