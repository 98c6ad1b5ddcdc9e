"""Records as tables: limits, and one mechanism at a time."""

import numpy as np
import pytest

from comparisons.judging.records import Verdict
from reports.records import anchor, blank_repeats, views
from tests.reports.made_up_results import made_up_results


@pytest.fixture(scope="module")
def results():
    return made_up_results(engines=("beta", "alpha"), broken={"alpha": Verdict.UNAVAILABLE}, samples=101)


@pytest.fixture(scope="module")
def view_results():
    return made_up_results(engines=("beta", "alpha"), samples=201)


def test_traces_leave_out_what_the_comparison_left_out(view_results):
    (view,) = views(view_results)
    (regime,) = view.regimes
    for quantity in ("Mkr", "Jeq"):
        for trace in view.traces(regime, quantity):
            assert np.nanmax(trace.error) == pytest.approx(trace.record.error_max, rel=1e-6)
    assert np.isnan(view.traces(regime, "Mkr")[0].error[0])


def test_anchors_hold_no_character_that_a_link_cannot():
    assert (
        anchor("juki-mf7923d", "as-built", "joint_force:P4 in rocker")
        == "juki-mf7923d-as-built-joint_force-P4-in-rocker"
    )


@pytest.mark.parametrize(
    ("heads", "shown"),
    [
        (1, [("a", "x", "1"), ("", "x", "2"), ("b", "x", "3"), ("", "y", "4")]),
        (2, [("a", "x", "1"), ("", "", "2"), ("b", "x", "3"), ("", "y", "4")]),
    ],
)
def test_what_rows_share_stands_once(heads, shown):
    assert list(blank_repeats([("a", "x", "1"), ("a", "x", "2"), ("b", "x", "3"), ("b", "y", "4")], heads)) == shown
