"""The README's picture of a report: ``python -m docs.preview DIR docs/preview.png``, DIR as given to ``--out``."""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from comparisons.campaign.results import Results, load
from comparisons.runs.files import write_file
from reports.charts.errors import draw_errors
from reports.charts.inertia import draw_inertia
from reports.charts.old_scheme import draw_scheme, scheme_of
from reports.charts.run_up import draw_history
from reports.charts.style import DOTS_PER_INCH, drawn
from reports.records.views import View, views

WIDTH, HEIGHT = 11.0, 7.0
SCHEME_BOX = (0.05, 0.075, 0.205, 0.84)


def preview(results: Results, path_png: Path) -> None:
    """Write the report's key figures of its largest mechanism as one PNG."""
    turning = [view for view in views(results) if view.makes_full_turn]
    view = max(turning, key=lambda one: len(one.linkage.links))

    def draw(figure: Figure) -> None:
        _draw(figure, view)

    figure = drawn(WIDTH, HEIGHT, draw)
    with matplotlib.rc_context({"font.family": "DejaVu Sans"}):
        write_file(
            path_png, lambda path: figure.savefig(path, format="png", dpi=DOTS_PER_INCH, metadata={"Software": None})
        )


def _draw(figure: Figure, view: View) -> None:
    figure.suptitle(f"{view.linkage.title}: engines against the closed form", x=0.05, ha="left", y=0.975, fontsize=12)
    left = figure.add_axes(SCHEME_BOX)
    scheme = scheme_of(view.mechanism)
    low, high = scheme.extent
    box = np.array([SCHEME_BOX[2] * WIDTH, SCHEME_BOX[3] * HEIGHT])
    scale = float(np.min((box - 0.7) / np.maximum(high - low, 1e-9)))
    middle, half = 0.5 * (low + high), 0.5 * box / scale
    left.set_xlim(middle[0] - half[0], middle[0] + half[0])
    left.set_ylim(middle[1] - half[1], middle[1] + half[1])
    draw_scheme(left, scheme, 0.042 / scale)
    regime = view.regimes[0]
    inertia = _panels(figure, 0.325, 0.545, "Reduced moment of inertia")
    torque = _panels(figure, 0.715, 0.895, f"Crank torque, {regime.name}")
    draw_inertia(*inertia, view)
    draw_history(*torque, view, regime, "Mkr")
    below = figure.add_axes((0.365, 0.075, 0.62, 0.31))
    draw_errors(below, view, regime)


def _panels(figure: Figure, left: float, right: float, title: str) -> tuple[Axes, Axes]:
    """Two panels, one above the other, over a common x axis."""
    grid = figure.add_gridspec(2, 1, left=left, right=right, top=0.89, bottom=0.5, height_ratios=(1.35, 1), hspace=0.14)
    lower = figure.add_subplot(grid[1])
    upper = figure.add_subplot(grid[0], sharex=lower)
    upper.tick_params(labelbottom=False)
    upper.set_title(title)
    return upper, lower


if __name__ == "__main__":
    preview(load(Path(sys.argv[1])), Path(sys.argv[2]))
