"""Words in a chart that do not touch: names beside the ends of curves and above marks, notes at points."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path
from matplotlib.transforms import Bbox
from numpy.typing import NDArray

from reports.charts.scales import FONT, FONT_SIZE, INK

Array = NDArray[np.float64]

LINE = FONT_SIZE * 1.2 / 72.0  # in, of one line of words
BEFORE_UNIT = re.compile(r"(?<=\d) (?=\S+$)")
LONGEST = 1.7  # in, of a name beside the axes before it goes on in a second line
# Where words may stand about a point, in halves of their size, the best first.
SHIFTS = np.array([(0, 1), (0, -1), (1, 0.4), (-1, 0.4), (1, -0.4), (-1, -0.4), (1, 1.6), (-1, 1.6), (0, 2.6)])
INSIDE_NAME, JOINT = re.compile(r"(?<=[.:])(?=[^\W\d])"), "\u2060"
BOLD = 1.12  # how much wider bold words are
GAP = 4.0  # points, between a curve's end or a note's point and its words
END, UPRIGHT, NOTE = "end", "upright", "note"  # places of words: beside an end of a curve, a vertical line, a point


@cache
def width(text: str) -> float:
    """Width of the longest line of a text, in."""
    prop = FontProperties(family=FONT, size=FONT_SIZE)
    sizes = [text_to_path.get_text_width_height_descent(name, prop, ismath=False) for name in text.splitlines()]
    return max((size[0] for size in sizes), default=0.0) / 72.0


def wrap(text: str, room: float = LONGEST) -> str:
    """A text in lines of so many inches at most, however bold; a name may also break behind a point or a colon."""
    longest = max(int(len(text) * room / (BOLD * width(text) or 1.0)), 1)
    joined = INSIDE_NAME.sub(f"{JOINT} ", BEFORE_UNIT.sub("\u00a0", text))
    return "\n".join(textwrap.wrap(joined, longest, break_long_words=False)).replace(f"{JOINT} ", "").replace(JOINT, "")


def spread(places: Sequence[float], sizes: Sequence[float], room: float) -> Array:
    """Increasing places moved as little as needed for words of these sizes not to touch, from 0 to ``room``."""
    tall = np.asarray(sizes)
    offsets = np.cumsum([0.0, *(0.5 * (tall[1:] + tall[:-1]))])[: len(tall)]
    free = np.clip(np.asarray(places) - offsets, 0.0, max(room - float(max(offsets, default=0.0)), 0.0))
    up, down = np.maximum.accumulate(free), np.minimum.accumulate(free[::-1])[::-1]
    return np.asarray(0.5 * (up + down) + offsets)


def write(axes: Axes, place: tuple[float, float], name: str, kind: str, colour: str = INK) -> None:
    """Words at the right of a height (``END``), above a place of the x axis (``UPRIGHT``) or at a point (``NOTE``)."""
    if not name:
        return
    coordinates = {END: axes.get_yaxis_transform(), UPRIGHT: axes.get_xaxis_transform(), NOTE: axes.transData}[kind]
    beside, across, up = ((GAP, 0.0), "left", "center") if kind == END else ((0.0, GAP), "center", "bottom")
    axes.annotate(wrap(name), place, beside, coordinates, "offset points", color=colour, annotation_clip=False,
                  label=kind, ha=across, va="center" if kind == NOTE else up)  # fmt: skip


def move_words_apart(axes: Axes) -> None:
    """Move the words of axes apart; called once the layout has placed the axes."""
    words = {kind: [label for label in axes.texts if label.get_label() == kind] for kind in (END, UPRIGHT, NOTE)}
    _move_apart(axes, words[UPRIGHT], 0)
    _move_apart(axes, words[END], 1)
    _place_notes(axes, words[NOTE])


def _move_apart(axes: Axes, names: list[Any], way: int) -> None:
    """Names beside the axes, apart in x (``way`` 0) or y."""
    start, dots = axes.bbox.min[way], axes.figure.dpi / 72.0
    anchors = {name: name.xycoords.transform(name.xy)[way] - start for name in names}
    order = sorted(names, key=lambda name: anchors[name])
    sizes = [name.get_window_extent().size[way] + dots for name in order]
    places = spread([anchors[name] for name in order], sizes, axes.bbox.size[way])
    for name, place in zip(order, places, strict=True):
        shift = np.array(name.xyann)
        shift[way] = (place - anchors[name]) / dots
        name.set_position(shift)


def _place_notes(axes: Axes, notes: list[Any]) -> None:
    """Words about points, where they hide no other and as little of the curves as can be."""
    dots, taken = axes.figure.dpi / 72.0, [Bbox.null()]
    spots = np.concatenate([np.zeros((0, 2)), *(axes.transData.transform(line.get_xydata()) for line in axes.lines)])
    for note in notes:
        point, half = axes.transData.transform(note.xy), 0.5 * note.get_window_extent().size
        outward = (1.0, 1.0 if point[1] > np.mean(axes.bbox.intervaly) else -1.0)
        places = point + SHIFTS * outward * (half + GAP * dots)
        areas = [Bbox([place - half, place + half]).padded(dots) for place in places]
        costs = [
            3.0 * n + 1e6 * area.count_overlaps(taken) - 1e3 * axes.bbox.count_contains(area.corners())
            + area.count_contains(spots)
            for n, area in enumerate(areas)
        ]  # fmt: skip
        best = int(np.argmin(costs))
        taken.append(areas[best])
        note.set_position((places[best] - point) / dots)
