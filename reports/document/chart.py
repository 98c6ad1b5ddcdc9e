"""A chart described as data: panels, curves, marks. ``reports.charts.draw`` draws it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# "ink", "muted", "faint", "reference", "limit", or the number of a colour of the palette.
Ink = str | int


@dataclass(frozen=True)
class Curve:
    """Points (n,) and how they are drawn; ``line`` is one of matplotlib's, or empty for marks alone.

    ``stacked`` fills the area down to the curve before it. ``name`` stands in the key or at the right end.
    """

    x: Array
    y: Array
    name: str = ""
    ink: Ink = 0
    line: str = "-"
    width: float = 1.4
    marker: str = ""
    stacked: bool = False


@dataclass(frozen=True)
class Mark:
    """A line across a panel, at a place of its x or y axis, and its name."""

    place: float
    along: Literal["x", "y"] = "x"
    name: str = ""
    ink: Ink = "muted"


@dataclass(frozen=True)
class Note:
    """A few words at a point of a panel."""

    x: float
    y: float
    text: str


@dataclass(frozen=True)
class Panel:
    """One pair of axes.

    ``scale`` is linear, logarithmic in y, in x or in both, or equal in both directions; ``turn``: x is the crank angle
    of a whole turn, degrees. ``names`` says where the curves' names stand. ``rows`` name y = 0, 1, … from above.
    """

    curves: tuple[Curve, ...]
    x_label: str = ""
    y_label: str = ""
    marks: tuple[Mark, ...] = ()
    notes: tuple[Note, ...] = ()
    scale: Literal["linear", "log", "logx", "loglog", "equal"] = "linear"
    turn: bool = False
    names: Literal["ends", "key", ""] = "ends"
    title: str = ""
    rows: tuple[str, ...] = ()


@dataclass(frozen=True)
class Chart:
    """Panels in ``columns``; those of one column share their x axis. ``height`` is that of the figure, inches.

    ``axis`` is "phi" or "time" where x is that of the mechanism's motion, so that a page may show where it is.
    """

    panels: tuple[Panel, ...]
    height: float = 3.0
    columns: int = 1
    wide: bool = False
    axis: Literal["", "phi", "time"] = ""
