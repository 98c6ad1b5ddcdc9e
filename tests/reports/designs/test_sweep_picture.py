"""Pictures of sweeps: curves, words, marks and hatches; words that touch nothing."""

from __future__ import annotations

import re

import numpy as np
import pytest
import xarray
from matplotlib.patches import Rectangle

from reports.charts import draw
from reports.charts.scales import INK, LIMIT_COLOUR, MUTED
from reports.designs.sweep_picture import sweep_figure
from tests.reports.drawn_words import check_words, texts

FIGURES = {
    "Mkr.peak": "N*m",
    "joint_force:needle_bar on ground.peak": "N",
    "transmission_angle:rocker + rod (RRR).peak": "deg",
    "stroke": "mm",
    **{f"point:D:y@{n}": "mm" for n in range(7)},
}
PARAMETERS = ("rod.B.x", "links.coupler_upper.centre.y", "crank.mass")
CONDITIONS = "4000 rpm, sampled at 180 crank angles"
ABOUT = {"mechanism": "made-up", "variant": "as-printed", "conditions": f"made-up (as-printed): {CONDITIONS}"}


def sweep(*counts, figures=1, fails=0.0, table=False, change=lambda values: values):
    """A grid, or a table of as many designs; the upper share ``fails`` of the first parameter does not assemble."""
    names = PARAMETERS[: len(counts)]
    places = [np.linspace(10.0 * n + 170.0, 10.0 * n + 180.0, count) for n, count in enumerate(counts)]
    mesh = np.meshgrid(*places, indexing="ij")
    failing = mesh[0] > 180.0 - 10.0 * fails
    data = {}
    for number, (name, unit) in enumerate(list(FIGURES.items())[:figures]):
        values = change(sum((one - 173.0) ** 2 for one in mesh) * 10.0 ** (3 * number - 6) + 1e-7)
        values = np.where(failing, np.nan, values)
        data[name] = ("design" if table else names, values.ravel() if table else values, {"units": unit})
    columns = {
        name: ("design" if table else name, whole.ravel() if table else place, {"units": "mm"})
        for name, place, whole in zip(names, places, mesh, strict=True)
    }
    return xarray.Dataset(data, columns, ABOUT)


OWN = {"rod.B.x": 174.0, "links.coupler_upper.centre.y": 184.0, "crank.mass": 194.0}


def drawn(dataset, own=OWN, always=()):
    return sweep_figure(dataset, own, always)


def hatches(axes):
    return [one for one in axes.get_children() if isinstance(one, Rectangle) and one.get_hatch()]


def marked(axes, marker, colour):
    """Where a marker of a colour stands."""
    return [tuple(map(float, line.get_xydata()[0])) for line in axes.lines
            if line.get_marker() == marker and line.get_color() == colour]  # fmt: skip


def panels(figure):
    """All axes but colour bars."""
    return [axes for axes in figure.axes if axes.get_label() != "<colorbar>"]


CASES = {
    "five lines": (sweep(50, figures=5, fails=0.3), 5),
    "four maps": (sweep(20, 30, figures=4, fails=0.3), 4),
    "eleven lines": (sweep(9, figures=11), 9),
    "eleven parallel": (sweep(5, 6, 7, figures=11, fails=0.3), 1),
    "a row": (sweep(1, 9), 1),
    "nothing assembles, table": (sweep(9, 9, fails=1.1, table=True), 1),
    "constant map": (sweep(9, 9, change=lambda values: 0.0 * values), 1),
    "huge": (sweep(9, change=lambda values: -1e200 * values), 1),
}


@pytest.mark.parametrize(("dataset", "count"), CASES.values(), ids=CASES)
def test_panels_are_counted_and_no_words_touch_or_leave_the_figure(dataset, count):
    figure = drawn(dataset)
    assert len(panels(figure)) == count or figure.axes[0].get_label() == "parallel"
    assert ("The first 9 of 11 figures are drawn." in texts(figure)) == (len(dataset.data_vars) == 11)
    check_words(figure, 3.5)


def test_a_line_names_its_designs_and_hatches_those_that_fail():
    figure = drawn(sweep(101, fails=0.3))
    (axes,) = panels(figure)
    words = texts(figure)
    assert "made-up, as-printed: 101 designs, 30 of which do not assemble" in words
    assert {CONDITIONS, "least", "design of the file", "does not assemble"} <= set(words)
    assert {"Mkr.peak, N*m", "rod.B.x, mm"} <= set(words)
    (band,) = hatches(axes)
    assert (band.get_x(), band.get_x() + band.get_width()) == pytest.approx((177.05, 180.05))
    assert marked(axes, "*", LIMIT_COLOUR) == [pytest.approx((173.0, 1e-7))]
    assert [line.get_xdata()[0] for line in axes.lines if line.get_color() == MUTED and line.is_dashed()] == [174.0]


@pytest.mark.parametrize("counts", [(100_000,), (30, 20, 10)])
def test_of_many_designs_a_sample_is_drawn_with_those_named_and_the_picture_says_so(counts):
    peak = 77_777 % int(np.prod(counts))

    def change(values):
        values = 0.0 * values + 1.0
        values.ravel()[peak] = 9.0
        return values

    figure = drawn(sweep(*counts, change=change), OWN | {"rod.B.x": 200.0}, always={peak})
    axes = panels(figure)[0]
    image = [np.nanmax(one.get_array()) for one in axes.images]
    highest = max(image or [np.nanmax(line.get_ydata()) for line in axes.lines if len(line.get_xdata()) > 9])
    assert highest == (1.0 if len(counts) == 3 else 9.0)  # the end of an axis
    assert any(re.search("000 designs, a sample of .* is drawn$", text) for text in texts(figure))
    assert "design of the file" not in texts(figure)


def test_a_map_has_a_colour_bar_contours_with_words_a_hatch_and_its_best_design():
    figure = drawn(sweep(21, 31, fails=0.3))
    (axes,) = panels(figure)
    (image,) = axes.images
    assert image.get_array().shape == (31, 21)
    assert np.count_nonzero(np.ma.getmaskarray(np.ma.masked_invalid(image.get_array()))) == 31 * 6
    assert len(hatches(axes)) == 1
    named = texts(figure, figure.axes[-1])
    assert len(set(named) & set(texts(figure, axes))) >= 3
    assert "value, 10⁻⁴ N*m" in named
    assert marked(axes, "*", LIMIT_COLOUR) == [pytest.approx((173.0, 180.0))]
    assert marked(axes, "D", INK) == [(174.0, 184.0)]


def test_a_transmission_angle_is_best_at_ninety_degrees():
    dataset = sweep(101, figures=3)
    name = list(dataset.data_vars)[-1]
    dataset[name] = dataset[name] * 0.0 + np.linspace(60.0, 130.0, 101)
    figure = drawn(dataset)
    ((place, value),) = marked(panels(figure)[-1], "*", LIMIT_COLOUR)
    assert value == pytest.approx(90.0, abs=0.5)
    assert place == pytest.approx(170.0 + 10.0 * 30.0 / 70.0, abs=0.1)
    assert "nearest to 90°" in texts(figure)


def test_parallel_lines_end_where_designs_do_not_assemble_and_the_best_is_among_a_sample():
    best = int(np.nanargmin(sweep(30, 20, 10, fails=0.3)["Mkr.peak"].values))
    figure = drawn(sweep(30, 20, 10, figures=2, fails=0.3), always={best})
    axes = figure.axes[0]
    lines = {line.get_color(): line.get_xydata() for line in axes.lines if len(line.get_xdata()) > 5}
    count = sum(np.count_nonzero(points[:, 0] == 0.0) for points in lines.values())
    assert 2000 < count <= 2000 + 2  # the best is drawn among the others, and above them
    best = lines[LIMIT_COLOUR]
    assert best[:3, 1] == pytest.approx(np.array([9.0 / 29.0, 0.0, 0.0]), abs=1e-12)
    grey = [points for points in lines.values() if np.all(np.isnan(points[points[:, 0] > 2.0, 1]))]
    assert len(grey) == 1
    assert any(re.search("6 000 designs, a sample of 2 00. is drawn", text) for text in texts(figure))
    assert {"design of the file", "does not assemble", "Mkr.peak: least"} <= set(texts(figure))
    (own,) = [line.get_xydata() for line in axes.lines if line.get_marker() == "D"]
    assert own == pytest.approx(np.array([(n, 0.4) for n in range(3)]))


def test_a_table_is_drawn_as_the_grid_of_the_same_designs_and_a_file_stands_on_white():
    grid, table = (sweep(6, 5, 4, figures=2, fails=0.2, table=one) for one in (False, True))
    first, second, text = (draw.svg(drawn(designs), page="white") for designs in (grid, table, sweep(9, 9, fails=0.3)))
    assert first == second
    assert "<pattern" in text
    assert "fill: #ffffff" in text
    assert "prefers-color-scheme" not in text


def test_descending_values_are_turned():
    dataset = sweep(21, 31)
    figure = drawn(dataset.isel({"rod.B.x": slice(None, None, -1)}))
    assert not hatches(panels(figure)[0])
    assert draw.svg(drawn(dataset)) == draw.svg(figure)


@pytest.mark.parametrize("counts", [(40, 30), (400, 3, 3)])
def test_values_that_grow_without_bounds_are_cut_off_and_the_picture_says_how_far_they_reach(counts):
    dataset = sweep(*counts, change=lambda values: values + 1.0)
    name = "Mkr.peak"
    dataset[name][{"rod.B.x": -1}] = 1e4
    figure = drawn(dataset)
    words = [" ".join(text.split()) for text in texts(figure)]
    assert any(re.fullmatch(r"Mkr\.peak \(1\.000 to 10000\),.N\*m", text) for text in words)
    assert any(text.startswith("If two numbers follow a name") for text in words)
    assert not any(text in {"5000", "10000"} for text in words)
    assert len(marked(panels(figure)[0], "*", LIMIT_COLOUR)) == (len(counts) < 3)
