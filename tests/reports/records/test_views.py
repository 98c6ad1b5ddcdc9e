"""Results seen one mechanism at a time."""

from pathlib import Path

import numpy as np
import pytest

from analytic.description.loading import parse
from comparisons.campaign.results import Results
from engines.contract import Setting
from reports.records.views import NOMINAL_SPEED, View, anchor, engines, views
from tests.analytic.drives import driven
from tests.reports.made_up_results import made_up_results

LINKAGES = Path(__file__).parents[2] / "linkages"


@pytest.fixture(scope="module")
def results():
    return made_up_results(engines=("beta", "alpha"), samples=201)


def test_engines_keep_their_place_by_name(results):
    assert engines(results) == ("alpha", "beta")


def test_traces_leave_out_what_the_comparison_left_out(results):
    (view,) = views(results)
    (regime,) = view.regimes
    for quantity in ("Mkr", "Jeq"):
        for trace in view.traces(regime, quantity):
            assert np.nanmax(trace.error) == pytest.approx(trace.record.error_max, rel=1e-9)
    assert np.isnan(view.traces(regime, "Mkr")[0].error[0])
    assert view.traces(regime, "Mkr") is view.traces(regime, "Mkr")


def test_tuned_stands_for_an_engine_where_it_ran():
    assert views(made_up_results(samples=21))[0].setting == "tuned"
    assert views(made_up_results(samples=21, settings=[Setting.NAIVE]))[0].setting == "naive"


def test_a_regime_may_leave_the_crank_free(results):
    free = Results({**results.document, "motions": []}, results.curves)
    (view,) = views(free)
    (regime,) = view.regimes
    assert regime.motion is None
    assert regime.jumps == ()
    assert view.final_speed == NOMINAL_SPEED
    assert view.traces(regime, "Jeq")[0].angle[-1] > 2.0 * np.pi


def test_full_turns_and_outputs_are_known(results):
    text = (LINKAGES / "parallelogram.toml").read_text(encoding="utf-8")
    rocker = parse(text.replace("B = [25, 0]", "B = [15, 0]"), "sample", "sample.toml")  # it turns instead of the crank
    assert not View(results, rocker).has_output
    assert views(results)[0].has_output
    assert not View(results, driven("linear-motor").linkage).makes_full_turn


def test_anchors_hold_no_character_that_a_link_cannot():
    assert (
        anchor("juki-mf7923d", "as-built", "joint_force:P4 in rocker")
        == "juki-mf7923d-as-built-joint_force-P4-in-rocker"
    )
