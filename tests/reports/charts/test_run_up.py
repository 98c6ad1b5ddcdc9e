"""A regime over time."""

import numpy as np

from comparisons.campaign.results import Results
from comparisons.judging.records import Verdict
from reports.charts import run_up
from reports.records.views import views
from tests.reports.made_up_results import made_up_results


def test_histories_follow_what_was_asked_for():
    (view,) = views(made_up_results(samples=21, quantities=("a", "Peq", "Mkr")))
    assert run_up.histories(view, view.regimes[0]) == ["Mkr", "Peq"]


def test_the_closed_form_is_drawn_even_where_no_engine_gave_a_curve():
    (view,) = views(made_up_results(samples=21, broken={"alpha": Verdict.DIVERGED, "beta": Verdict.DIVERGED}))
    (regime,) = view.regimes
    time, values = run_up.truth(view, regime, "Mkr")
    assert time[-1] == regime.motion.duration
    assert np.abs(values).max() > 0.16
    _, lower = run_up.history_figure(view, regime, "Mkr").axes
    assert [text.get_text() for text in lower.texts] == ["no run gave a curve"]


def test_a_free_crank_has_histories_without_a_prescribed_motion():
    results = made_up_results(samples=201)
    (view,) = views(Results({**results.document, "motions": []}, results.curves))
    upper, _ = run_up.history_figure(view, view.regimes[0], "Teq").axes
    assert upper.get_xlim() == (0.0, 0.7)


def test_symbols_are_the_fields_own():
    assert [run_up.symbol(name) for name in ("phi", "Mkr", "joint_force:A")] == ["φ", "Mkr", "|F|"]
