"""Sweeps, optima and tolerances in words and pictures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from analytic.description.crank_motion import RPM
from comparisons.designs.optimisation import OptimisationRequest, optimise
from comparisons.designs.parameters import steady_motion
from comparisons.designs.sweep import sweep
from comparisons.designs.tolerances import Tolerances, tolerance_request, tolerance_study
from reports.charts import draw
from reports.charts.scales import MUTED, PALETTE
from reports.designs.optimise_terminal import before_after_chart
from reports.designs.sweep_terminal import document as sweep_document
from reports.designs.sweep_terminal import parts, sentence
from reports.designs.tolerance_terminal import NONE, TIED, WIDE, document, printout, tornado_chart
from reports.document.numbers import figure as digits
from reports.document.terminal import rendered
from tests.analytic.linkages import IN_LINE, from_text, mechanism
from tests.comparisons.designs.sweeps import grid, request
from tests.reports.drawn_words import texts


def summed_up(*texts):
    return sweep(request(grid(*texts), figures=("stroke",)))


def test_designs_that_do_not_assemble_are_counted_and_never_rounded_away():
    assert sentence(summed_up("rod.B.x=175:175:1")) == "1 design, which assembles at every angle"
    assert sentence(summed_up("rod.B.x=175:176:2")) == "2 designs, all of which assemble at every angle"
    told = sentence(summed_up("rod.B.x=160:180:2001"))
    assert told.startswith("2 001 designs, of which ")
    assert "(100 %)" not in told
    assert told.endswith("to 180 mm")


def test_the_table_and_the_document_have_the_same_figures():
    found = summed_up("rod.B.x=170:180:3", "rod.mass=1:2:2")
    lines = rendered(*parts(found)).splitlines()
    stroke = sweep_document(found)["figures"]["stroke"]
    for line, what in zip(lines[4:7], ("least", "own", "largest"), strict=True):
        value, x, mass = map(float, line.split()[-3:])
        assert [x, mass] == [*stroke[what]["at"].values()]
        np.testing.assert_allclose(value, stroke[what]["value"], rtol=1e-5)
    assert stroke["own"]["at"] == {"rod.B.x": 175.0, "rod.mass": 0.17}
    assert sweep_document(found)["parameters"]["rod.B.x"] == {
        "units": "mm", "least": 170.0, "largest": 180.0, "assembles": [170.0, 180.0]
    }  # fmt: skip


# Curves before and after a change: torque first, peaks marked.


def test_torque_comes_first_and_both_peaks_are_marked():
    rimoldi = mechanism("rimoldi-164")
    wanted = OptimisationRequest("joint_force:A.peak", ("rod.B.x=170:180",))
    optimum = optimise(rimoldi, steady_motion(rimoldi, 1000.0 * RPM, samples=90), wanted, lambda *_: None)
    torque = optimum.curves()["Mkr"]
    figure = draw.figure(before_after_chart(optimum, "made-up"))
    first, second = figure.axes
    assert {"before", "after", "made-up"} <= set(texts(figure))
    before, after = (values[np.argmax(np.abs(values))] for values in torque)
    assert f"Mkr: peak {digits(before)} → {digits(after)} N*m" in texts(figure, first)
    assert any(text.startswith("joint_force:A: peak ") for text in texts(figure, second))
    dots = {line.get_color(): line.get_ydata()[0] for line in first.lines if line.get_marker() == "o"}
    assert dots == {MUTED: pytest.approx(before), PALETTE[0]: pytest.approx(after)}
    assert "crank angle φ, °" in texts(figure, second)
    assert second.get_xlim() == (0.0, 360.0)


# A tolerance study in words: rows by contribution, derivatives, worst case; and as bars sorted by size.


def printed(sample, results, table, **options):
    """The text of a study."""
    motion = steady_motion(sample, 900.0 * RPM, samples=24)
    study = tolerance_study(tolerance_request(sample, motion, Tolerances(results, None, table), **options))
    found = printout(study)
    return study, rendered(*found.tables, *found.closing)


def test_rows_stand_by_contribution_and_a_mass_moves_no_stroke():
    table = {"rod.mass": 0.01, "rod.B.x": 0.01, "rocker.B.length": {"plus_minus": 0.05, "distribution": "uniform"}}
    study, text = printed(mechanism("rimoldi-164", "as-built"), ("stroke",), table, samples=30)
    rows = [line.split()[0] for line in text.splitlines() if "exact" in line]
    assert rows == ["rocker.B.length", "rod.B.x", "rod.mass"]
    assert "stroke [mm]: 30.9866" in text
    assert "rocker.B.length  0.05  mm uniform" in text
    low, high = study.corners[0] * 1e3
    assert f"{low:.4f} to {high:.4f} mm of all 8 corners" in text
    assert "30 random designs, seed 0: all of them assemble" in text


def test_what_has_no_derivative_says_why():
    table = {"piston.through.y": 0.001, "rod.B.x": 0.001}
    study, text = printed(from_text(IN_LINE), ("v.peak",), table, samples=4)
    assert text.count(TIED) == 1
    first = document(study)["results"]["v.peak"]["tolerances"][0]
    assert first["derivative"] is None
    assert first["contribution"] > 0.0
    _, text = printed(mechanism("parallelogram"), ("Mkr@30",), {"coupler.mass": 0.01}, samples=4)
    assert "difference" in text
    assert NONE not in text.split()


NAMES = ("rod.B.x", "rocker.B.x", "rod.mass", "crank.mass")
CHANGES = np.array([(-1e-3, 2e-3), (-5e-3, 4e-3), (3e-3, 1e-3), (0.0, 0.0)])  # N m


@pytest.fixture(scope="module")
def study():
    rimoldi = mechanism("rimoldi-164", "as-built")
    asked = Tolerances(("Mkr.peak",), None, dict.fromkeys(NAMES, 0.001))
    motion = steady_motion(rimoldi, 900.0 * RPM, samples=24)
    request = tolerance_request(rimoldi, motion, asked, samples=4)
    return replace(tolerance_study(request), changes=CHANGES[None], nominal=np.array([0.27]))


def bars(axes):
    """(row, end) of the bars at the lower and at the upper limit, from above."""
    found = [line for line in axes.lines if line.get_linewidth() == WIDE and len(line.get_xdata()) == 2]
    return [sorted((round(line.get_ydata()[0]), line.get_xdata()[1]) for line in found if line.get_color() == colour)
            for colour in PALETTE[:2]]  # fmt: skip


def test_the_largest_bar_is_on_top_and_what_moves_nothing_is_counted(study):
    figure = draw.figure(tornado_chart(study))
    (axes,), words = figure.axes, texts(figure)
    assert {study.request.conditions, "at the lower limit", "at the upper limit"} <= set(words)
    assert bars(axes) == [[(0, -5e-3), (1, 3e-3), (2, -1e-3)], [(0, 4e-3), (1, 1e-3), (2, 2e-3)]]
    assert [word for word in words if word in NAMES] == ["rocker.B.x", "rod.mass", "rod.B.x"]
    assert {"Mkr.peak: 0.2700 N*m; 1 moves nothing", "change, N*m"} <= set(words)
    low, high = axes.get_xlim()
    assert low <= -5e-3 < 4e-3 <= high


@pytest.mark.parametrize("ends", [(np.nan, 1.0), (0.0, 0.0), (-1e-300, 1e300)])
def test_results_that_nothing_moves_or_that_break_are_drawn(study, ends):
    assert draw.svg(draw.figure(tornado_chart(replace(study, changes=np.array([[ends] * len(NAMES)])))))
