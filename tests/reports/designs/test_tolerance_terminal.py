"""A tolerance study in words: rows by contribution, derivatives, worst case; and as bars sorted by size."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from analytic.description.crank_motion import RPM
from comparisons.designs.parameters import steady_motion
from comparisons.designs.tolerances import Tolerances, tolerance_request, tolerance_study
from reports.charts import draw
from reports.charts.scales import PALETTE
from reports.designs.tolerance_terminal import NONE, TIED, WIDE, document, printout, tornado_chart
from reports.document.terminal import rendered
from tests.analytic.linkages import IN_LINE, from_text, mechanism
from tests.reports.drawn_words import texts


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
