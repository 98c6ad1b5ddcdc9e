"""Charts as drawn: words that touch nothing, round scales, files that follow the reader's colours."""

import re

import numpy as np
import pytest

from reports.charts import draw, scales
from reports.charts.scales import DARK, PALETTE
from reports.document.chart import Chart, Curve, Mark, Note, Panel
from tests.reports.drawn_words import check_words, texts

TURN = np.linspace(0.0, 360.0, 181)
WAVE = np.sin(np.radians(TURN))
NAMES = ("needle bar", "take-up lever of the machine", "A", "B", "frame", "crank", "O1", "O2")


def panel(**more):
    curves = tuple(Curve(TURN, WAVE * (1.0 + 1e-3 * n), name, n) for n, name in enumerate(NAMES))
    return Panel(curves, "φ, °", "F, N", turn=True, **more)


def error_panel(**more):
    return Panel((Curve(TURN, 1e-9 * np.abs(WAVE), "engine"),), "φ, °", "error", scale="log", turn=True, **more)


CHARTS = {
    "names at the ends": Chart((panel(),), 3.0),
    "names in a key": Chart((panel(names="key", title="Forces"),), 3.0),
    "more names than room": Chart((panel(),), 1.3, wide=True),
    "names that take all the room": Chart(
        (panel(), Panel(tuple(Curve(TURN, WAVE, f"link number {n}", n) for n in range(40)), "φ, °", "F, N")), 2.0
    ),
    "one above the other": Chart(
        (panel(names="", notes=(Note(90.0, 1.0, "1 at 90°"), Note(95.0, 1.0, "2 at 95°"))),
         error_panel(marks=(Mark(90.0, name="jump"), Mark(93.0, name="jump"), Mark(1e-9, "y", "limit", "limit")))),
        4.0,
    ),
    "to one scale": Chart(
        tuple(Panel((Curve(n * WAVE, 40.0 * WAVE[::-1]),), "Fx, N", "Fy, N", scale="equal", title=f"joint {n}")
              for n in range(1, 7)),
        5.0, columns=4, wide=True,
    ),
}  # fmt: skip


@pytest.mark.parametrize("chart", CHARTS.values(), ids=CHARTS)
def test_no_words_touch_others_leave_the_figure_or_are_small(chart):
    check_words(draw.figure(chart), 2.5)


def test_a_turn_has_its_sixths_and_errors_whole_decades():
    figure = draw.figure(CHARTS["one above the other"])
    upper, lower = figure.axes
    assert {str(60 * n) for n in range(7)} <= set(texts(figure, lower))
    assert "360" not in texts(figure, upper)
    assert np.log10(lower.get_ylim()) == pytest.approx(np.round(np.log10(lower.get_ylim())))
    assert set(texts(figure, lower)) >= {scales.power_of_ten(end) for end in lower.get_ylim()}


@pytest.mark.parametrize("name", ["names in a key", "one above the other"])
def test_a_file_keeps_its_words_and_turns_every_colour_it_has(name):
    chart = CHARTS[name]
    text = draw.svg(draw.figure(chart))
    assert text == draw.svg(draw.figure(chart))
    assert chart.panels[0].y_label in text
    used = set(re.findall(r"(?:fill|stroke): (#[0-9a-f]{6})", text))
    assert used & set(PALETTE)
    assert used - {"#000000"} <= set(DARK)
    assert all(f'="{colour}"]{{' in text for colour in used & set(DARK))
    assert 'id="patch_1"' not in text or not re.search(r'id="patch_1">\s*<path[^>]*fill: #ffffff', text)


# Limits and round scales of a panel.

X = np.linspace(0.0, 1.0, 101)


def drawn(values, **more):
    """A figure of a curve, and the limits of its y axis."""
    figure = draw.figure(Chart((Panel((Curve(X[: len(values)], np.asarray(values)),), "t, s", "F, N", **more),)))
    return figure, figure.axes[0].get_ylim()


@pytest.mark.parametrize("values", [np.full(101, 3.3), 3.3 * (1.0 + 1e-15 * np.sin(1e3 * X)), np.zeros(101), [np.nan]])
def test_a_flat_curve_stands_in_the_middle_whatever_its_rounding(values):
    figure, (low, high) = drawn(values)
    middle = np.nan_to_num(values[0], nan=0.5 * (low + high))
    assert middle - low == pytest.approx(high - middle)
    assert high - low > 1e-2 * abs(middle)
    assert len(texts(figure)) > 8


@pytest.mark.parametrize(("factor", "label"), [(1.0, "F, N"), (1e6, "F, 10⁶ N"), (1e-7, "F, 10⁻⁷ N")])
def test_small_and_large_values_share_a_power_of_ten_in_the_label(factor, label):
    words = texts(drawn(factor * (1.0 + X))[0])
    assert label in words
    assert {"0.0", "1.0", "2.0"} <= set(words)
    assert not any("e" in word for word in words)
