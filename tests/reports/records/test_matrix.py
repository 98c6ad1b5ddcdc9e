"""The limits of a campaign with their reasons, and what its baseline caught."""

from dataclasses import replace

import pytest

from comparisons.judging.records import Verdict
from reports.records import matrix
from tests.reports.made_up_results import changed_results, made_up_results


@pytest.fixture(scope="module")
def results():
    return made_up_results(engines=("beta", "alpha"), broken={"alpha": Verdict.UNAVAILABLE}, samples=101)


def test_limits_carry_their_reasons(results):
    rows = matrix.limit_table(results).rows
    jeq = next(row for row in rows if row[0].startswith("Jeq") and "tuned" in row[1])
    assert jeq[3] == "1e-5"
    assert "smoother than torque" in jeq[4]


def test_what_only_the_baseline_caught_is_told(results):
    grown = {"outcome": Verdict.OVER_LIMIT.value, "detail": "three times its recorded value", "baseline": 2.16e-6}
    tuned = next(record for record in results.records if record.outcome == Verdict.PASSED.value)
    found = changed_results(results, lambda record: record if record != tuned else replace(record, **grown))
    (sentence,) = matrix.past_baseline(found)
    assert sentence.endswith("three times its recorded value")
