"""A chart described as data: panels, curves, marks. ``reports.charts.draw`` draws it."""

from __future__ import annotations

import base64
from dataclasses import dataclass, field
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
FULL_SHARE: Final = 65534  # of the way between the ends of a packed column
# A colour: "ink", "muted", "faint", "reference", "limit", "paper", or its number in the palette.
Ink = str | int


def packed(*columns: Array) -> dict[str, Any]:
    """Columns (n,) for a drawing, which has fewer places than 16 bits: ends of each, and shares of the way between.

    The shares are whole numbers up to ``FULL_SHARE``, the lower byte first, in base64; one more stands for a value that
    is not finite, and is not drawn.
    """
    ends, shares = [], []
    for column in columns:
        finite = np.isfinite(column)
        known = column[finite] if finite.any() else np.zeros(1)
        low, high = float(np.min(known)), float(np.max(known))
        share = np.where(finite, column - low, 0.0) / ((high - low) or 1.0)
        shares.append(np.where(finite, np.rint(FULL_SHARE * share), FULL_SHARE + 1))
        ends.append((low, high))
    return {"ends": ends, "shares": base64.b64encode(np.concatenate(shares).astype("<u2").tobytes()).decode("ascii")}


def axis_label(name: str, unit: str) -> str:
    """The label of an axis: a name and its unit, if it has one."""
    return f"{name}, {unit}" if unit else name


@dataclass(frozen=True)
class Curve:
    """Points (n,), none for an entry of a key, and how they are drawn; ``line`` is one of matplotlib's, or no line.

    ``stacked`` fills the area down to the curve before it. ``name`` stands in the key or at the right end; ``size`` is
    that of a marker, points. Wide lines end where their points are, so that they serve as bars. Without points it is an
    entry of a key.
    """

    x: Array = field(default_factory=lambda: np.zeros(0))
    y: Array = field(default_factory=lambda: np.zeros(0))
    name: str = ""
    ink: Ink = 0
    line: str = "-"
    width: float = 1.4
    marker: str = ""
    stacked: bool = False
    size: float = 4.5


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
class Hatch:
    """Intervals (n, 2) of a panel's x axis, hatched over its whole height, and the name of the hatch."""

    stretches: Array
    name: str = ""


@dataclass(frozen=True)
class Surface:
    """Values (rows, columns) of cells between edges x (columns + 1,) and y (rows + 1,), ascending, as colours.

    ``label`` stands beside the colour bar, whose round numbers have contour lines; nan is left open, so that a hatch
    below shows.
    """

    x: Array
    y: Array
    values: Array
    label: str = ""


@dataclass(frozen=True)
class Panel:
    """One pair of axes.

    ``scale`` is linear, logarithmic in y or in x, or equal in both directions; ``turn``: x is the crank angle
    of a whole turn, degrees. ``names`` is the place of the curves' names. ``rows`` name y = 0, 1, … from above.
    Curves are cut off outside ``span`` in y, and the colours of a surface differ between its ends.
    """

    curves: tuple[Curve, ...]
    x_label: str = ""
    y_label: str = ""
    marks: tuple[Mark, ...] = ()
    notes: tuple[Note, ...] = ()
    scale: Literal["linear", "log", "logx", "equal"] = "linear"
    turn: bool = False
    names: Literal["ends", "key", ""] = "ends"
    title: str = ""
    rows: tuple[str, ...] = ()
    hatch: Hatch | None = None
    surface: Surface | None = None
    span: tuple[float, float] | None = None


@dataclass(frozen=True)
class Chart:
    """Panels in ``columns``; those of one column share their x axis unless they have ``rows``. ``height`` is in inches.

    ``head`` are lines above all panels, the first in bold, and ``key`` what the panels have in common.
    """

    panels: tuple[Panel, ...]
    height: float = 3.0
    columns: int = 1
    wide: bool = False
    head: tuple[str, ...] = ()
    key: tuple[Curve | Hatch, ...] = ()
