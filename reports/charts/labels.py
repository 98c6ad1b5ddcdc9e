"""Words in a chart that do not touch: names at the ends of curves, notes at points, names of marks above a panel."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Sequence
from functools import cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path
from matplotlib.transforms import Affine2D
from numpy.typing import NDArray

from reports.charts.style import FONT, FONT_SIZE
from reports.document.chart import Note

Array = NDArray[np.float64]

LINE = FONT_SIZE * 1.2 / 72.0  # in, of one line of words
BEFORE_UNIT = re.compile(r"(?<=\d) (?=\S+$)")
LONGEST = 22  # characters of a name before it goes on in a second line
# Where words may stand about a point, in halves of their size, the best first.
SHIFTS = np.array([(0, 1), (0, -1), (1, 0.4), (-1, 0.4), (1, -0.4), (-1, -0.4), (1, 1.6), (-1, 1.6), (0, 2.6)])
INSIDE_NAME, JOINT = re.compile(r"(?<=[.:])(?=[^\W\d])"), "\u2060"
BOLD = 1.12  # how much wider bold words are
GAP = 0.06  # in, between an end of a curve and its name


@cache
def width(text: str, size: float = FONT_SIZE) -> float:
    """Width of the longest line of a text, in."""
    prop = FontProperties(family=FONT, size=size)
    sizes = [text_to_path.get_text_width_height_descent(one, prop, ismath=False) for one in text.splitlines()]
    return max((size[0] for size in sizes), default=0.0) / 72.0


def wrapped(name: str, longest: int = LONGEST) -> str:
    """A name in lines that leave room for the curves."""
    return "\n".join(textwrap.wrap(BEFORE_UNIT.sub("\u00a0", name), longest, break_long_words=False))


def fitting(text: str, room: float) -> str:
    """A text in lines no wider than so many inches, however bold; a name may also break behind a point or a colon."""
    longest = max(int(len(text) * room / (BOLD * width(text) or 1.0)), 1)
    return wrapped(INSIDE_NAME.sub(f"{JOINT} ", text), longest).replace(f"{JOINT} ", "").replace(JOINT, "")


def fitting_label(label: str, room: float) -> str:
    """A label in lines that are about so wide, in; its unit stays beside the end of the name."""
    name, comma, unit = label.rpartition(", ")
    return fitting(name, room) + comma + unit.replace(" ", "\u00a0") if comma else fitting(label, room)


def lines(text: str) -> int:
    """How many lines a text has."""
    return text.count("\n") + bool(text)


def height(text: str) -> float:
    """Height of a text, in."""
    return LINE * (text.count("\n") + 1)


def spread(places: Sequence[float], heights: Sequence[float], room: float) -> list[float]:
    """Increasing places moved as little as needed for labels of these heights not to touch, from 0 to ``room``."""
    tall = np.asarray(heights)
    offsets = np.cumsum([0.0, *(0.5 * (tall[1:] + tall[:-1]))])[: len(tall)]
    free = np.clip(np.asarray(places) - offsets, 0.0, max(room - float(max(offsets, default=0.0)), 0.0))
    up, down = np.maximum.accumulate(free), np.minimum.accumulate(free[::-1])[::-1]
    return list(0.5 * (up + down) + offsets)


def write_ends(axes: Axes, ends: Sequence[tuple[float, str, str]], tall: float) -> None:
    """Names at the right end of their curves, (share of the height, name, colour) each, on axes ``tall`` in high."""
    order = sorted(ends, key=lambda end: end[0])
    places = spread([tall * end[0] for end in order], [height(end[1]) for end in order], tall)
    for place, (_, name, colour) in zip(places, order, strict=True):
        axes.annotate(name, (1.0, place / tall), xycoords="axes fraction", xytext=(72.0 * GAP, 0.0), color=colour,
                      textcoords="offset points", va="center", ha="left", annotation_clip=False, fontsize=FONT_SIZE,
                      linespacing=1.1)  # fmt: skip


def rows_above(spans: Sequence[tuple[float, float]]) -> list[int]:
    """The row, from 0, in which each of these spans from left to right has room beside those before it."""
    rows: list[float] = []
    found = []
    for left, right in spans:
        row = next((number for number, end in enumerate(rows) if left > end), len(rows))
        rows[row : row + 1] = [right + GAP]
        found.append(row)
    return found


def write_notes(axes: Axes, notes: Sequence[Note], points: Array, box: tuple[float, float]) -> None:
    """Words beside points, where they hide no other and as little of the curves, points (n, 2), as can be.

    ``box`` is the size of the axes, in.
    """
    inches = axes.transData + axes.transAxes.inverted() + Affine2D().scale(*box)
    spots, taken = inches.transform(points), [np.full(4, np.inf)]
    for note in notes:
        half = 0.5 * np.array([width(note.text) + 0.06, height(note.text)])
        point = inches.transform((note.x, note.y))
        outward = np.array([1.0, 1.0 if point[1] > 0.5 * box[1] else -1.0])
        places = [point + shift * outward * (half + 0.05) for shift in SHIFTS]
        areas = [np.concatenate([place - half, place + half]) for place in places]
        best = int(np.argmin([3.0 * n + _cost(area, spots, taken, np.array(box)) for n, area in enumerate(areas)]))
        taken.append(areas[best])
        left, bottom = map(float, places[best] / box)
        axes.text(left, bottom, note.text, transform=axes.transAxes, ha="center", va="center")


def _cost(area: Array, spots: Array, taken: Sequence[Array], size: Array) -> float:
    """How bad words in an area are: on other words, out of the panel, on a curve's points."""
    low, high = area[:2], area[2:]
    touching = sum(bool(np.all(low < other[2:]) and np.all(high > other[:2])) for other in taken)
    beside, above = np.maximum(-low, 0.0) + np.maximum(high - size, 0.0)
    hidden = int(np.sum(np.all((spots > low) & (spots < high), axis=1)))
    return float(1e6 * touching + 1e3 * beside + 40.0 * above + hidden)
