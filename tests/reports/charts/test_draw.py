"""Figures as drawn: limits that suit the curves, words that leave the figure nowhere, files that turn their colours."""

import re
from functools import partial

import numpy as np
import pytest

from reports.charts import draw
from reports.charts.draw import DARK, PALETTE
from tests.reports.drawn_words import check_words, texts

TURN = np.linspace(0.0, 360.0, 181)
WAVE = np.sin(np.radians(TURN))
NAMES = ("needle bar", "take-up lever of the machine", "A", "B", "frame", "crank", "O1", "O2")


def place(figure, factor=1.0):
    """Eight named curves over a turn beneath a head that is wider than the figure, and a vector to one scale."""
    host = draw.head(figure, ["A motion that has many words. " * 4, "second line"])
    upper, lower = host.subplots(2)
    for n, name in enumerate(NAMES):
        upper.plot(TURN, factor * WAVE * (1.0 + 1e-2 * n), label=name)
    draw.finish(upper, "φ, °", "F, N", turn=True)
    lower.plot(WAVE, 40.0 * WAVE[::-1])
    draw.finish(lower, "Fx, N", "Fy, N", equal=True)
    host.legend(*upper.get_legend_handles_labels(), loc="outside upper left", ncols=4)


@pytest.mark.parametrize("factor", [1.0, 1e6, 1e-7])
def test_no_words_touch_others_leave_the_figure_or_are_small(factor):
    figure = draw.drawn(draw.WIDTH, 5.0, partial(place, factor=factor))
    check_words(figure, 2.5)
    assert {"60", "120", "180", "240", "300", "360", "φ, °", "F, N", *NAMES} <= set(texts(figure))


def test_a_file_keeps_its_words_and_turns_every_colour_it_has():
    figure = draw.drawn(draw.WIDTH, 5.0, place)
    text = draw.svg(figure)
    assert text == draw.svg(figure)
    assert "F, N" in text
    used = set(re.findall(r"(?:fill|stroke): (#[0-9a-f]{6})", text))
    assert used & set(PALETTE)
    assert used - {"#000000"} <= set(DARK)
    assert all(f'="{colour}"]{{' in text for colour in used & set(DARK))
    assert 'id="patch_1"' not in text or not re.search(r'id="patch_1">\s*<path[^>]*fill: #ffffff', text)


X = np.linspace(0.0, 1.0, 101)


def limits(values):
    """The limits of the y axis of a curve."""

    def plot(figure):
        axes = figure.subplots()
        axes.plot(X[: len(values)], values)
        draw.finish(axes)

    return draw.drawn(draw.WIDTH, 3.0, plot).axes[0].get_ylim()


@pytest.mark.parametrize("values", [np.full(101, 3.3), 3.3 * (1.0 + 1e-15 * np.sin(1e3 * X)), np.zeros(101), [np.nan]])
def test_a_flat_curve_stands_in_the_middle_whatever_its_rounding(values):
    low, high = limits(values)
    middle = np.nan_to_num(values[0], nan=0.5 * (low + high))
    assert middle - low == pytest.approx(high - middle)
    assert high - low > 1e-2 * abs(middle)


def test_magnitudes_stand_above_zero_and_values_far_from_it_where_they_are():
    assert limits(1.0 + 9.0 * X)[0] == 0.0
    assert limits(9.0 + X)[0] > 8.5
