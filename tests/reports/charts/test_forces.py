"""Forces in the joints and on the frame: facts, figures, rows."""

import re
from dataclasses import asdict, replace

import numpy as np
import pytest
from matplotlib.figure import Figure

from analytic.description.loading import load
from comparisons.campaign.results import Results
from reports.charts import forces
from reports.charts.run_up import histories
from reports.facts.forces import TurnForces, lead
from reports.records.joint_rows import joint_table, worst_joint
from reports.records.views import views
from tests.reports.made_up_results import made_up_results

SLOTTED = "slotted-takeup"


@pytest.fixture(scope="module")
def results():
    """Records of two joints in the guise of Jeq's and Mkr's."""
    made = made_up_results([load(SLOTTED)], samples=21, quantities=("Jeq", "Mkr"))
    names = {"Jeq": "joint_force:P1", "Mkr": "joint_force:slot_slider on rocker"}
    records = [replace(record, quantity=names[record.quantity], unit="N", limit=1e-3) for record in made.records]
    records = [r if r.quantity.endswith("P1") or not r.error_max else replace(r, error_max=1e-16) for r in records]
    return Results({**made.document, "records": [asdict(record) for record in records]}, made.curves)


@pytest.fixture(scope="module")
def view(results):
    return views(results)[0]


@pytest.fixture(scope="module")
def found(view):
    return TurnForces(view)


def test_peaks_are_those_of_the_curves_and_the_lead_names_the_largest(found):
    assert max(found.peaks, key=lambda name: found.peaks[name][0]) == "P2"
    assert np.hypot(*found.joints["P2"]).max() == found.peaks["P2"][0]
    assert re.search(r"50\.36 N in P2 at 23°.*32\.40 N and between −0\.\d+ and 0\.\d+ N m about P1", lead(found))


def test_a_curve_and_a_name_per_joint(found):
    (axes,) = forces.magnitudes_figure(found).axes
    names = [text.get_text() for text in axes.texts]
    assert len(names) == len(found.joints) == 7
    assert "slot slider on rocker, 30.2 N" in names
    styles = {(line.get_color(), str(line.get_linestyle())) for line in axes.lines if len(line.get_xdata()) > 1}
    assert len(styles) == 7


def test_hodographs_are_to_scale_and_hold_their_whole_curve(found):
    panels = [axes for axes in forces.hodographs_figure(found).axes if axes.get_visible()]
    assert [axes.get_title(loc="left") for axes in panels] == [name.replace("_", " ") for name in found.joints]
    for axes, force in zip(panels, found.joints.values(), strict=True):
        assert axes.get_aspect() == 1.0
        for limits, values in zip((axes.get_xlim(), axes.get_ylim()), force, strict=True):
            assert limits[0] < min(values.min(), 0.0) <= max(values.max(), 0.0) < limits[1]


def test_crank_angles_beside_a_hodograph_do_not_hide_each_other(found):
    for axes in forces.hodographs_figure(found).axes:
        places = [np.array(text.get_position()) for text in axes.texts]
        half = 0.5 * np.ptp(axes.get_xlim())
        gaps = [np.hypot(*(a - b)) for i, a in enumerate(places) for b in places[:i]]
        assert min(gaps, default=half) > forces.CLEAR * half


def test_only_the_worst_joint_has_a_history_and_all_have_a_row(view):
    (regime,) = view.regimes
    assert worst_joint(view, regime) == ["joint_force:P1"]
    assert histories(view, regime) == ["joint_force:P1"]
    table = joint_table(view, regime)
    head, rows = table.head, table.rows
    assert head[:3] == ("joint", "peak, N", "alpha naive")
    assert {row[0] for row in rows} == {"P1", "slot slider on rocker"}
    assert set(next(row for row in rows if row[0] != "P1")[2:]) == {"< 1e-13"}


def test_no_rows_without_joint_forces():
    (bare,) = views(made_up_results(samples=21, quantities=("Jeq",)))
    assert joint_table(bare, bare.regimes[0]) is None
    assert worst_joint(bare, bare.regimes[0]) == []


def test_a_hodograph_leaves_out_what_has_no_bound():
    angle = np.linspace(0.0, 2.0 * np.pi, forces.POINTS)
    force = np.stack([np.cos(angle), np.sin(angle)])
    force[:, [0, 180]] = np.nan
    axes = Figure().subplots()
    forces.draw_hodograph(axes, force, "k")
    assert np.isfinite([axes.get_xlim(), axes.get_ylim()]).all()
    assert {"0", "180"}.isdisjoint(text.get_text() for text in axes.texts)
