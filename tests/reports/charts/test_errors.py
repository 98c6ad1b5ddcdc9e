"""Every deviation at a glance."""

from comparisons.judging.records import Verdict
from comparisons.stress.verdict import SAID as INVARIANTS
from reports.charts import errors
from reports.records.views import views
from tests.reports.made_up_results import made_up_results


def rows(axes):
    return [text.get_text() for text in axes.get_yticklabels()]


def test_rows_are_quantities_then_invariants_and_engines_that_ran_are_named():
    results = made_up_results(
        samples=51, engines=("alpha", "beta", "gamma"), broken={"gamma": Verdict.UNSUPPORTED}, quantities=("Mkr", "Jeq")
    )
    (view,) = views(results)
    (axes,) = errors.errors_figure(view, view.regimes[0]).axes
    assert rows(axes) == ["Jeq", "Mkr", *(name.replace("_", " ") for name in INVARIANTS)]
    words = [text.get_text() for text in axes.get_legend().get_texts()]
    assert words == ["alpha", "beta", "naive", "tuned", "best", "limit (tuned)"]


def test_every_record_has_a_dot_and_those_of_the_view_s_setting_a_limit():
    (view,) = views(made_up_results(samples=51))
    (axes,) = errors.errors_figure(view, view.regimes[0]).axes
    dots, limits = 0, 0
    for line in axes.get_lines():
        dots += len(line.get_xdata()) if line.get_marker() in errors.MARKERS else 0
        limits += len(line.get_xdata()) if line.get_marker() == "|" else 0
    assert dots == len(view.records)
    assert limits == sum(record.setting == "tuned" for record in view.records)
