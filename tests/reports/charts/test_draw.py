"""Charts as drawn: words that touch nothing, round scales, files that follow the reader's colours."""

import itertools
import re

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from reports.charts import draw, labels, scales
from reports.charts.style import DARK, PALETTE
from reports.document.chart import Chart, Curve, Mark, Note, Panel

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
        4.0, axis="phi",
    ),
    "to one scale": Chart(
        tuple(Panel((Curve(n * WAVE, 40.0 * WAVE[::-1]),), "Fx, N", "Fy, N", scale="equal", title=f"joint {n}")
              for n in range(1, 7)),
        5.0, columns=4, wide=True,
    ),
}  # fmt: skip


@pytest.fixture(params=CHARTS.values(), ids=CHARTS)
def chart(request):
    return request.param


def words(figure):
    """Every text that shows, with its box, pixels."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    renderer = canvas.get_renderer()
    texts = [text for text in figure.findobj(match=lambda one: hasattr(one, "get_text")) if text.get_text().strip()]
    return [(text, text.get_window_extent(renderer)) for text in texts if text.get_visible()]


def test_no_words_touch_others_leave_the_figure_or_are_small(chart):
    figure = draw.figure(chart)
    found = words(figure)
    for (one, box), (other, another) in itertools.combinations(found, 2):
        wide = min(box.x1, another.x1) - max(box.x0, another.x0)
        high = min(box.y1, another.y1) - max(box.y0, another.y0)
        assert wide < 1.0 or high < 2.5, (one.get_text(), other.get_text())
    for text, box in found:
        assert text.get_fontsize() * 96.0 / 72.0 >= 12.0
        assert min(box.x0, box.y0, figure.bbox.x1 - box.x1, figure.bbox.y1 - box.y1) > -1.0, text.get_text()


def test_a_key_of_many_names_the_largest_and_counts_the_rest():
    upper, lower = draw.figure(CHARTS["names that take all the room"]).axes
    assert set(NAMES) <= {text.get_text() for text in upper.texts}
    names = [text.get_text() for text in lower.texts if re.match("link|and", text.get_text())]
    assert "and 32 more" in names
    assert len(names) == 9


def test_edges_are_those_of_the_axes(chart):
    box = draw.figure(chart).axes[0].get_position()
    assert draw.edges(chart) == pytest.approx((box.x0, box.x1))


def ticks(axes, *, across):
    """The words at the ticks of an axis, by their places on it."""
    transform = axes.get_xaxis_transform() if across else axes.get_yaxis_transform()
    return {
        text.get_position()[not across]: text.get_text() for text in axes.texts if text.get_transform() == transform
    }


def test_a_turn_has_its_sixths_and_errors_whole_decades():
    upper, lower = draw.figure(CHARTS["one above the other"]).axes
    assert ticks(lower, across=True) == {60.0 * n: str(60 * n) for n in range(7)}
    assert not ticks(upper, across=True)
    assert upper.get_position().x0 == lower.get_position().x0
    assert np.log10(lower.get_ylim()) == pytest.approx(np.round(np.log10(lower.get_ylim())))
    assert all(scales.power_of_ten(place) == word for place, word in ticks(lower, across=False).items())


def test_a_metre_is_a_metre_in_both_directions():
    axes = draw.figure(CHARTS["to one scale"]).axes[-1]
    size = axes.get_window_extent()
    assert np.ptp(axes.get_xlim()) / size.width == pytest.approx(np.ptp(axes.get_ylim()) / size.height)


def test_small_values_share_a_power_of_ten_in_the_label():
    axes = draw.figure(Chart((Panel((Curve(TURN, 2e-5 * (2.0 + WAVE)),), "φ, °", "Jeq, kg m²"),))).axes[0]
    assert "Jeq, 10⁻⁵ kg m²" in [text.get_text() for text in axes.texts]
    named = ticks(axes, across=False)
    assert len(named) > 3
    assert all(float(word) == pytest.approx(1e5 * place) for place, word in named.items())


def test_a_file_keeps_its_words_and_turns_every_colour_it_has(chart):
    text = draw.svg(draw.figure(chart))
    assert text == draw.svg(draw.figure(chart))
    assert chart.panels[0].y_label in text
    used = set(re.findall(r"(?:fill|stroke): (#[0-9a-f]{6})", text))
    assert used & set(PALETTE)
    assert used - {"#000000"} <= set(DARK)
    assert all(f': {colour}"]{{' in text for colour in used & set(DARK))
    assert 'id="patch_1"' not in text or not re.search(r'id="patch_1">\s*<path[^>]*fill: #ffffff', text)


def test_labels_move_apart_about_their_own_places_within_the_panel():
    placed = labels.spread([0.5, 0.5, 0.52, 2.0], [0.2, 0.2, 0.4, 0.2], 2.0)
    assert np.all(np.diff(placed) >= np.array([0.2, 0.3, 0.3]) - 1e-12)
    assert abs(np.mean(placed[:3]) - 0.5) < 0.1
    assert max(placed) <= 2.0
