"""How every figure looks: colours that a colour-blind reader can tell apart, sizes that stay legible on paper.

Figures are drawn through matplotlib's object interface, with the fonts it brings along, so that two reports of the same
results are the same text. Nothing here knows an engine by name: colours and dashes go by name order.
"""

from __future__ import annotations

import base64
import io
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from html import escape
from typing import Any

import matplotlib
import numpy as np
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, MultipleLocator, NullLocator
from numpy.typing import NDArray

from reports.document.chart import Ink
from reports.document.templates import FOLDER, captions

# Okabe and Ito, the darker ones first; the closed form is always ink.
PALETTE = ("#0072b2", "#c75300", "#00855f", "#aa4499", "#2f8fc4", "#8a6b00")
Dashes = tuple[int, tuple[float, ...]]
DASHES: tuple[Dashes, ...] = ((0, (5, 2.2)), (0, (1.4, 1.4)), (0, (7, 2, 1.4, 2)), (0, (3, 1, 1, 1, 1, 1)))
SETTING_LINES: dict[str, Any] = {"naive": (0, (1, 1.3)), "tuned": "-", "best": (0, (5, 1.6))}
INK, MUTED, FAINT, REFERENCE = "#1d2733", "#5b6673", "#d8dde3", "#a9b3bf"
LIMIT_COLOUR = "#a02020"
PAPER, PLATE, GHOST = "#ffffff", "#e4e9ef", "#a8b8c8"  # behind a drawing, inside a link, what is faintly drawn

# What each of a drawing's colours becomes where the reader's scheme is dark.
DARK = {
    INK: "#e4e8ed",
    MUTED: "#a3aebb",
    FAINT: "#37414d",
    REFERENCE: "#6f7b88",
    LIMIT_COLOUR: "#ff7b72",
    PAPER: "#12171e",
    PLATE: "#2b333d",
    GHOST: "#4d5a68",
    **dict(zip(PALETTE, ("#4aa8e8", "#f08a3c", "#33c79a", "#e08ad2", "#93d2f5", "#d9b93b"), strict=True)),
}
NAMED = {"ink": INK, "muted": MUTED, "faint": FAINT, "reference": REFERENCE, "limit": LIMIT_COLOUR}
FONT, FONT_SIZE = "DejaVu Sans", 9.0

# Inches of a figure that shares the page's width with another, and of one that has it to itself.
WIDTH, FULL_WIDTH = 5.4, 11.0
# Of drawings to scale: inches for the ticks on the left and below, on the other two sides, and of a pin's radius.
LEFT, BELOW, RIM = 0.55, 0.45, 0.08
PIN_INCHES = 0.042
# An inline drawing beyond this many characters goes into the page as a picture instead.
LARGEST_DRAWING = 300_000
DOTS_PER_INCH = 160

_COORDINATES = re.compile(r'\b(?:d|x|y|x1|x2|y1|y2|width|height|transform|points)="[^"]*"')
_LONG_NUMBER = re.compile(r"(\d\.\d\d)\d+")
_PROLOGUE = re.compile(r"^.*?(?=<svg)", re.DOTALL)
_METADATA = re.compile(r"<metadata>.*?</metadata>|<style.*?</style>", re.DOTALL)
_SIZE = re.compile(r'<svg ([^>]*?)width="[\d.]+pt"', re.DOTALL)
_HEIGHT = re.compile(r'(<svg [^>]*?)height="[\d.]+pt" ?', re.DOTALL)


def colour(engine: str, engines: Sequence[str]) -> str:
    """An engine's colour, by its place among the names."""
    return PALETTE[engines.index(engine) % len(PALETTE)]


def dashes(engine: str, engines: Sequence[str]) -> Dashes:
    """An engine's dash pattern, by its place among the names, for readers without colour."""
    return DASHES[engines.index(engine) % len(DASHES)]


def ink(name: Ink) -> str:
    """A colour of the palette by its number, or one that has a name."""
    return NAMED[name] if isinstance(name, str) else PALETTE[name % len(PALETTE)]


@cache
def house_style() -> Any:  # noqa: ANN401  which keys matplotlib's stubs know changes from release to release
    """How figures look, and how they are written: colours, sizes, fonts."""
    return matplotlib.rc_params_from_file(FOLDER / "figures.mplstyle", use_default_template=False)


def drawn(width: float, height: float, draw: Callable[[Figure], None]) -> Figure:
    """A figure of so many inches, drawn in the house style."""
    with matplotlib.rc_context(house_style()):
        figure = Figure(figsize=(width, height))
        draw(figure)
    return figure


def panels(kind: str, draw: Callable[..., object], **arguments: object) -> Figure:
    """A figure of axes one above the other over a common x axis, as ``figures.toml`` has them for its ``kind``.

    ``draw`` is given the axes from the top down, and ``arguments``.
    """
    layout = captions()[kind]
    ratios = layout.get("ratios", (1,))
    edges = dict(zip(("left", "right", "top", "bottom"), layout["edges"], strict=True))
    spacing = {**edges, "height_ratios": ratios, "hspace": layout.get("gap", 0.12)}

    def draw_all(figure: Figure) -> None:
        draw(*figure.subplots(len(ratios), 1, sharex=True, squeeze=False, gridspec_kw=spacing)[:, 0], **arguments)
        if layout.get("aligned"):
            figure.align_ylabels()

    return drawn(FULL_WIDTH if layout.get("wide") else WIDTH, layout["height"], draw_all)


def scaled_figure(
    corners: tuple[NDArray[np.float64], NDArray[np.float64]],
    pad: float,
    largest: tuple[float, float],
    narrowest: float,
    draw: Callable[..., object],
) -> Figure:
    """A figure of the plane between two corners, mm, as large as ``largest``, in, allows to one scale both ways.

    ``pad`` is the room around the corners, in, for pivots, numbers and names; ``narrowest`` the least width of the
    axes. ``draw`` is given the axes and ``size``, a pin's radius, mm.
    """
    (low, high), rims = corners, np.array([LEFT + RIM, BELOW + RIM])
    span = np.maximum(high - low, 1e-9)
    room = largest - rims - 2.0 * pad
    scale = float(np.min(room / span))
    box = np.maximum(span * scale + 2.0 * pad, (narrowest, 0.0))
    full = box + rims

    def draw_all(figure: Figure) -> None:
        axes = figure.add_axes((LEFT / full[0], BELOW / full[1], box[0] / full[0], box[1] / full[1]))
        middle, half = 0.5 * (low + high), 0.5 * box / scale
        axes.set_xlim(middle[0] - half[0], middle[0] + half[0])
        axes.set_ylim(middle[1] - half[1], middle[1] + half[1])
        draw(axes, size=PIN_INCHES / scale)

    return drawn(float(full[0]), float(full[1]), draw_all)


@dataclass(frozen=True)
class ReportFigure:
    """A figure: the sentence before it, its drawing, and whether it takes the page's whole width."""

    lead: str
    drawing: Markup
    wide: bool = False


def picture(figure: Figure, key: str, description: str) -> Markup:
    """The figure for a page: an inline drawing, or a picture where the drawing would be too large."""
    with matplotlib.rc_context(house_style()):
        drawing = _drawing(figure, key, description)
        if len(drawing) <= LARGEST_DRAWING:
            return Markup(drawing)
        buffer = io.BytesIO()
        figure.savefig(buffer, format="png", dpi=DOTS_PER_INCH, metadata={"Software": None})
    data = base64.b64encode(buffer.getvalue()).decode("ascii")
    width = figure.get_figwidth() * 96.0
    return Markup(f'<img width="{width:.0f}" alt="{escape(description)}" src="data:image/png;base64,{data}">')


def svg_text(figure: Figure) -> str:
    """The figure as an SVG file of its own, on white, the same for the same figure."""
    buffer = io.StringIO()
    with matplotlib.rc_context(house_style()):
        figure.savefig(buffer, format="svg", facecolor="white", metadata={"Date": None, "Creator": None})
    return buffer.getvalue()


def _drawing(figure: Figure, key: str, description: str) -> str:
    """SVG fit to stand inside a page: no prologue, ids of its own, short numbers, the page's fonts."""
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None})
    text = _PROLOGUE.sub("", buffer.getvalue(), count=1)
    text = _METADATA.sub("", text)
    text = _COORDINATES.sub(lambda found: _LONG_NUMBER.sub(r"\1", found[0]), text)
    text = text.replace("'DejaVu Sans'", "var(--sans)").replace(", sans-serif", "")
    text = re.sub(r'\bid="', f'id="{key}-', text)
    text = text.replace("url(#", f"url(#{key}-").replace('xlink:href="#', f'xlink:href="#{key}-')
    width = figure.get_figwidth() * 96.0
    text = _HEIGHT.sub(r"\1", _SIZE.sub(rf'<svg \1style="max-width:{width * 1.25:.0f}px"', text, count=1), count=1)
    title = f'role="img" aria-labelledby="{key}-title"><title id="{key}-title">{escape(description)}</title>'
    return text.replace(">", f" {title}", 1)


def over_turn(axes: Axes, label: str = "crank angle φ, °") -> None:
    """A turn on the x axis, in degrees."""
    axes.set_xlim(0.0, 360.0)
    axes.xaxis.set_major_locator(MultipleLocator(60.0))
    axes.set_xlabel(label)


def label_values(axes: Axes, label: str, ticks: int = 5) -> None:
    """A y axis with its label and at most so many round steps."""
    axes.set_ylabel(label)
    axes.yaxis.set_major_locator(MaxNLocator(ticks))


def plane(axes: Axes, across: int, down: int) -> None:
    """Axes of the linkage's plane, to one scale both ways, with at most so many round steps of mm."""
    axes.set_aspect("equal")
    for axis, name, ticks in ((axes.xaxis, "x, mm", across), (axes.yaxis, "y, mm", down)):
        axis.set_label_text(name)
        axis.set_major_locator(MaxNLocator(ticks, steps=[1, 2, 5, 10]))


def error_scale(axes: Axes, lowest: float, highest: float) -> None:
    """A logarithmic y axis over whole decades."""
    axes.set_yscale("log")
    bottom, top = math.floor(math.log10(lowest)), math.ceil(math.log10(highest) + 0.05)
    axes.set_ylim(10.0**bottom, 10.0**top)
    decades(axes.yaxis, 6)


def decades(axis: Axis, ticks: int) -> None:
    """At most so many ticks of a logarithmic axis, labelled as powers of ten."""
    axis.set_major_locator(LogLocator(base=10.0, numticks=ticks))
    axis.set_major_formatter(FuncFormatter(power_of_ten))
    axis.set_minor_locator(NullLocator())


def power_of_ten(value: float, _: int = 0) -> str:
    """10 to a whole power, in plain characters: 10⁻⁵."""
    exponent = round(math.log10(value)) if value > 0.0 else 0
    raised = str(exponent).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"10{raised}"


def label_ends(axes: Axes, ends: Sequence[tuple[float, str, str]], size: float = 7.5, lines: int = 1) -> None:
    """Write names at the right end of their curves, (height, name, colour) each, moved apart where they would touch."""
    if not ends:
        return
    box = axes.get_position()
    figure_height = axes.get_figure(root=True).get_figheight()  # type: ignore[union-attr]
    gap = lines * size * 1.25 / (72.0 * box.height * figure_height)
    to_axes = axes.transLimits
    order = sorted(ends, key=lambda end: end[0])
    heights = [float((axes.transScale + to_axes).transform((1.0, end[0]))[1]) for end in order]
    for place, (_, name, ink) in zip(spread(heights, gap), order, strict=True):
        axes.annotate(name, (1.0, place), xycoords="axes fraction", xytext=(4.0, 0.0), textcoords="offset points",
                      color=ink, fontsize=size, va="center", ha="left", annotation_clip=False)  # fmt: skip


def spread(heights: Sequence[float], gap: float) -> list[float]:
    """Increasing heights moved as little as needed to lie at least ``gap`` apart, within 0 and 1 if they fit."""
    room = max(1.0, gap * (len(heights) - 1))
    steps = gap * np.arange(len(heights))
    pushed_up = np.maximum.accumulate(np.clip(heights, 0.0, room) - steps)
    return list(np.minimum(pushed_up, room - steps[-1]) + steps) if len(heights) else []
