"""Sweeps, optima and tolerances in words and pictures: the designs that are named are marked, no words touch."""

from dataclasses import replace

import numpy as np
import pytest
import xarray
from matplotlib.patches import Rectangle

from analytic.description.crank_motion import RPM
from comparisons.designer.parameters import case_at_speed
from comparisons.designer.sweep import sweep
from comparisons.designer.tolerances import Tolerances, tolerance_study
from reports.charts.draw import INK, LIMIT, MUTED
from reports.designs.sweep import DesignSweep
from reports.designs.sweep_picture import sweep_figure
from reports.designs.tolerance import NONE, TIED, Tolerance, tornado_figure
from tests.analytic.linkages import IN_LINE, from_text, mechanism
from tests.comparisons.designer.sweeps import grid, request
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


def made_up_sweep(*counts, figures=1, fails=0.0, table=False, change=lambda values: values):
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


@pytest.mark.parametrize(
    ("dataset", "count"),
    [
        (made_up_sweep(20, 30, figures=4, fails=0.3), 4),
        pytest.param(made_up_sweep(5, 6, 7, figures=11, fails=0.3), 27, marks=pytest.mark.nightly),
        (made_up_sweep(9, 9, fails=1.1, table=True), 2),
        (made_up_sweep(9, change=lambda values: -1e200 * values), 1),
    ],
    ids=["four maps", "eleven over three", "nothing assembles, table", "huge"],
)
def test_panels_are_counted_and_no_words_touch_or_leave_the_figure(dataset, count):
    figure = drawn(dataset)
    assert len(panels(figure)) == count
    assert ("The first 9 of 11 figures are drawn." in " ".join(texts(figure))) == (len(dataset.data_vars) == 11)
    check_words(figure, 3.5)


def test_a_line_names_its_designs_and_hatches_those_that_fail():
    figure = drawn(made_up_sweep(101, fails=0.3))
    (axes,) = panels(figure)
    words = texts(figure)
    assert f"made-up, as-printed: 101 designs, 30 of which do not assemble {CONDITIONS}" in words
    assert {"least", "design of the file", "does not assemble"} <= set(words)
    assert {"Mkr.peak, N*m", "rod.B.x, mm"} <= set(words)
    (band,) = hatches(axes)
    assert (band.get_x(), band.get_x() + band.get_width()) == pytest.approx((177.05, 180.05))
    assert marked(axes, "*", LIMIT) == [pytest.approx((173.0, 1e-7))]
    assert [line.get_xdata()[0] for line in axes.lines if line.get_color() == MUTED and line.is_dashed()] == [174.0]


def test_a_map_has_a_colour_bar_contours_with_words_a_hatch_and_its_best_design():
    figure = drawn(made_up_sweep(21, 31, fails=0.3))
    (axes,) = panels(figure)
    (image,) = axes.images
    assert image.get_array().shape == (31, 21)
    assert np.count_nonzero(np.ma.getmaskarray(np.ma.masked_invalid(image.get_array()))) == 31 * 6
    assert len(hatches(axes)) == 1
    named = texts(figure, figure.axes[-1])
    assert {"0.0001", "0.00015", "0.0002"} <= set(texts(figure, axes))
    assert {"N*m", "1e−4"} <= set(named)
    assert marked(axes, "*", LIMIT) == [pytest.approx((173.0, 180.0))]
    assert marked(axes, "D", INK) == [(174.0, 184.0)]


def summed_up(*texts):
    return DesignSweep(sweep(request(grid(*texts), figures=("stroke",))), "").sentence()


def test_designs_that_do_not_assemble_are_counted_and_never_rounded_away():
    assert summed_up("rod.B.x=175:175:1") == "1 design, which assembles at every angle"
    assert summed_up("rod.B.x=175:176:2") == "2 designs, all of which assemble at every angle"
    told = summed_up("rod.B.x=160:180:2001")
    assert told.startswith("2 001 designs, of which ")
    assert "(100 %)" not in told
    assert told.endswith("to 180 mm")


def printed_study(sample, results, table, **options):
    """A study and its text."""
    case = case_at_speed(sample, 900.0 * RPM, samples=24)
    study = Tolerance(tolerance_study(case, Tolerances(results, None, table), **options))
    return study, str(study)


def test_what_has_no_derivative_says_why():
    table = {"piston.through.y": 0.001, "rod.B.x": 0.001}
    study, text = printed_study(from_text(IN_LINE), ("v.peak",), table, samples=4)
    assert text.count(TIED) == 1
    first = study.to_dict()["results"]["v.peak"]["tolerances"][0]
    assert first["derivative"] is None
    assert first["contribution"] > 0.0
    _, text = printed_study(mechanism("parallelogram"), ("Mkr@30",), {"coupler.mass": 0.01}, samples=4)
    assert "difference" in text
    assert NONE not in text.split()


NAMES = ("rod.B.x", "rocker.B.x", "rod.mass", "crank.mass")
CHANGES = np.array([(-1e-3, 2e-3), (-5e-3, 4e-3), (3e-3, 1e-3), (0.0, 0.0)])  # N m


@pytest.fixture(scope="module")
def study():
    rimoldi = mechanism("rimoldi-164", "as-built")
    asked = Tolerances(("Mkr.peak",), None, dict.fromkeys(NAMES, 0.001))
    case = case_at_speed(rimoldi, 900.0 * RPM, samples=24)
    return replace(tolerance_study(case, asked, samples=4), changes=CHANGES[None], nominal=np.array([0.27]))


def bars(axes):
    """(row, end) of the bars at the lower and at the upper limit, from above."""
    return [
        [(round(bar.get_y() + 0.5 * bar.get_height()), bar.get_width()) for bar in side] for side in axes.containers
    ]


def test_the_largest_bar_is_on_top(study):
    figure = tornado_figure(study)
    (axes,), words = figure.axes, texts(figure)
    assert {study.case.conditions, "at the lower limit", "at the upper limit"} <= set(words)
    assert bars(axes) == [[(0, -5e-3), (1, 3e-3), (2, -1e-3), (3, 0.0)], [(0, 4e-3), (1, 1e-3), (2, 2e-3), (3, 0.0)]]
    assert [word for word in words if word in NAMES] == ["rocker.B.x", "rod.mass", "rod.B.x", "crank.mass"]
    assert {"Mkr.peak: 0.2700 N*m", "change, N*m"} <= set(words)
    low, high = axes.get_xlim()
    assert low <= -5e-3 < 4e-3 <= high
