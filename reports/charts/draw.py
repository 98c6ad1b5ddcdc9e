"""Figures of matplotlib in the house's looks, and their files: SVG that follows the reader's colours, PNG on white.

Figures are drawn through matplotlib's object interface, with the fonts it brings along, so that two reports of the same
results are the same text. Nothing here knows an engine by name.
"""

from __future__ import annotations

import io
import re
import textwrap
from collections.abc import Callable, Sequence
from typing import Any, Final

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.ticker import MultipleLocator
from numpy.typing import NDArray

from reports.document.templates import FOLDER

Array = NDArray[np.float64]
Host = Figure | SubFigure

# Okabe and Ito first, dark enough for words, for colour-blind readers, too; the closed form is always ink.
PALETTE = ("#0072b2", "#c75300", "#00855f", "#aa4499", "#5b45c9", "#8a6b00", "#007c91", "#c9205f", "#7a4a21")
DARK_PALETTE = ("#4aa8e8", "#f08a3c", "#33c79a", "#e08ad2", "#a99cf5", "#d9b93b", "#3fb8cc", "#ff85ad", "#c99a6b")
INK, MUTED, FAINT, REFERENCE = "#1d2733", "#5b6673", "#d8dde3", "#a9b3bf"
LIMIT = "#a02020"
PAPER, PLATE, GHOST = "#ffffff", "#e4e9ef", "#a8b8c8"  # behind a drawing, inside a link, what is faintly drawn

# What each of a drawing's colours becomes where the reader's scheme is dark.
DARK = {
    INK: "#e4e8ed",
    MUTED: "#a3aebb",
    FAINT: "#37414d",
    REFERENCE: "#6f7b88",
    LIMIT: "#ff7b72",
    PAPER: "#12171e",
    PLATE: "#2b333d",
    GHOST: "#4d5a68",
    **dict(zip(PALETTE, DARK_PALETTE, strict=True)),
}
FONT, FONT_SIZE = "DejaVu Sans", 9.0
STYLE = FOLDER / "figures.mplstyle"  # how figures look, and how they are written: colours, sizes, fonts

# Inches of a figure that shares the page's width with another, of one that has it to itself, of a line of words.
WIDTH, FULL_WIDTH, LINE = 5.4, 11.0, 0.16
LETTERS = 13.0  # to the inch, the broad ones of a name among them
PAPER_DOTS = 300  # to the inch
STEADY = 1e-6  # a curve that varies by less than this share of its size is flat
FROM_ZERO = 0.4  # an axis starts at zero where the least value is below this share of the largest
HATCHED: Final[dict[str, Any]] = {"facecolor": PLATE, "edgecolor": REFERENCE, "hatch": "////", "linewidth": 0.0}

_COORDINATES = re.compile(r'\b(?:d|x|y|x1|x2|y1|y2|width|height|transform|points)="[^"]*"')
_LONG_NUMBER = re.compile(r"(\d\.\d\d)\d+")
_STYLE = re.compile(r"(<style[^>]*>)(.*?)(</style>)", re.DOTALL)


def drawn(width: float, height: float, draw: Callable[[Figure], object], *, placed: bool = True) -> Figure:
    """A new figure of this width and height, in, that ``draw`` fills, in the house style.

    ``draw`` gets the figure. Its parts are arranged so that they do not touch, unless ``placed`` is False.
    """
    with matplotlib.rc_context(fname=STYLE):
        figure = Figure(figsize=(width, height), layout="constrained" if placed else None)
        draw(figure)
        if engine := figure.get_layout_engine():
            engine.execute(figure)  # once, not for every file
            figure.set_layout_engine("none")
    return figure


def inches(host: Host) -> Array:
    """Width and height, (2,), in, of a figure or of a part of one."""
    return np.array(host.bbox.size) / host.dpi


def wrap(text: str, room: float) -> str:
    """A text broken by line ends into lines of about ``room`` inches, eight letters at least."""
    return textwrap.fill(text, max(int(LETTERS * room), 8))


def head_lines(lines: Sequence[str], width: float) -> list[str]:
    """The lines of a figure's head, folded to its width in inches, each part a line of its own."""
    return [part for line in lines for part in wrap(line, width).splitlines()]


def head(host: Host, lines: Sequence[str]) -> Host:
    """Write lines, folded to its width, at the top of a figure; returns the part below them, to be drawn into."""
    host.suptitle("\n".join(head_lines(lines, inches(host)[0])), x=0.01, ha="left", fontsize="medium")
    return host.add_subfigure(host.add_gridspec()[0])


def axis_label(name: str, unit: str) -> str:
    """The label of an axis: "name, unit", or the name alone for the unit ""."""
    return f"{name}, {unit}" if unit else name


def finish(axes: Axes, x_label: str = "", y_label: str = "", *, turn: bool = False, equal: bool = False) -> None:
    """Set labels, limits and lines at zero of axes that have all their curves.

    A flat curve stands in the middle whatever its rounding, and magnitudes stand above zero. ``turn`` is an x axis of a
    turn, 0 to 360 degrees, ``equal`` is one scale for both axes.
    """
    axes.set(xlabel=x_label, ylabel=y_label)
    if turn:
        axes.set_xlim(0.0, 360.0)
        axes.xaxis.set_major_locator(MultipleLocator(60.0))
    if equal:
        axes.set_aspect("equal", adjustable="datalim")
        axes.axvline(0.0, color=MUTED, linewidth=0.6, zorder=1.5)
    else:
        low, high = axes.dataLim.intervaly
        size = max(abs(low), abs(high))
        if 0.0 < high - low <= STEADY * size:
            axes.set_ylim(low - 0.1 * size, high + 0.1 * size)
        elif 0.0 <= low < FROM_ZERO * high:
            axes.set_ylim(bottom=0.0)
    if axes.get_ylim()[0] < 0.0 < axes.get_ylim()[1]:
        axes.axhline(0.0, color=MUTED, linewidth=0.6, zorder=1.5)


def is_wide(figure: Figure) -> bool:
    """Whether a figure takes a page's whole width, ``FULL_WIDTH``."""
    return figure.get_figwidth() == FULL_WIDTH


def svg(figure: Figure, page: str = "none") -> str:
    """The figure as SVG text, always the same for the same figure; a dark scheme of the reader's changes its colours.

    ``page`` is the colour behind it, "none" for none; with one the colours stay.
    """
    text = _saved(figure, "svg", ("Date", "Creator", "Format", "Type"), facecolor=page).decode("utf-8")
    text = _COORDINATES.sub(lambda match: _LONG_NUMBER.sub(r"\1", match[0]), text)
    dark = "" if page != "none" else f"@media (prefers-color-scheme: dark){{{_dark(text)}}}"
    return _STYLE.sub(lambda match: f"{match[1]}{match[2].strip()}{dark}{match[3]}", text, count=1)


def picture(figure: Figure, kind: str) -> str | bytes:
    """The figure on white as the content of a file, text of an svg, bytes of a png or pdf, the same every time.

    It has its fonts and is for papers. ``kind`` is the suffix without its point.
    """
    if kind == "svg":
        return svg(figure, page="white")
    if kind == "pdf":
        return _saved(figure, kind, ("CreationDate", "Creator", "Producer"), facecolor="white")
    return _saved(figure, kind, ("Software",), facecolor="white", dpi=PAPER_DOTS)


def _saved(figure: Figure, kind: str, left_out: Sequence[str], **more: Any) -> bytes:  # noqa: ANN401
    """The bytes of a figure's file of a ``kind``, without the metadata ``left_out``: equal figures give equal files.

    ``more`` goes to matplotlib's ``savefig``.
    """
    buffer = io.BytesIO()
    with matplotlib.rc_context(fname=STYLE):
        figure.savefig(buffer, format=kind, metadata=dict.fromkeys(left_out), **more)
    return buffer.getvalue()


def _dark(text: str) -> str:
    """CSS rules that replace the colours that an SVG text has where the reader's scheme is dark; "" without any."""
    return "".join(
        f'[style*="{what}: {light}"],[{what}="{light}"]{{{what}:{dark}!important}}'
        for light, dark in DARK.items()
        for what in ("fill", "stroke")
        if re.search(f'{what}(: |="){light}', text)
    )
