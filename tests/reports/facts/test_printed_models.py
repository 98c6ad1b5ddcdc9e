"""Printed models: one line per erratum and engine, and the two motions side by side."""

import numpy as np
import pytest

from analytic.description.loading import load
from comparisons.campaign.results import Results
from reports.campaign.summary import markdown
from reports.facts.printed_models import judged, judgements, printed_motion
from reports.facts.released import released
from reports.records.views import Regime, views
from tests.reports.made_up_results import made_up_results

NAME, ERRATUM = "two-crank-takeup", "S1 without US1"


def results_of(variant=None):
    made = made_up_results([load(NAME, variant)], samples=21, quantities=("Jeq",))
    rows = [
        {"mechanism": NAME, "erratum": ERRATUM, "engine": "alpha", "sentence": "alpha <supports> the corrected model"},
        {"mechanism": "another", "erratum": ERRATUM, "engine": "alpha", "sentence": "of another mechanism"},
    ]
    return Results({**made.document, "errata": rows}, made.curves)


@pytest.fixture(scope="module")
def results():
    return results_of()


def test_a_mechanism_hears_of_its_own_errata(results):
    (view,) = views(results)
    assert [row["sentence"] for row in judgements(view)] == ["alpha <supports> the corrected model"]
    assert [erratum.name for erratum in judged(view)] == [ERRATUM]


def test_a_variant_is_not_held_against_printed_models():
    (view,) = views(results_of("as-printed"))
    assert judgements(view) == []


def test_the_two_models_part(results):
    (view,) = views(results)
    (erratum,) = judged(view)
    printed, corrected = printed_motion(view, erratum), released(view, Regime("driven", "", None)).motion
    assert float(corrected.angle(1.0)) != pytest.approx(float(printed.angle(np.array(1.0))), rel=1e-3)
    assert printed is printed_motion(view, erratum)


def test_the_summary_says_what_the_engines_said(results):
    assert "- alpha <supports> the corrected model" in markdown(results)
