"""The matrix in plain rows: every run, its worst cell per family, its limits and reasons."""

from dataclasses import asdict, replace

import pytest

from comparisons.campaign.results import Results
from comparisons.judging.records import Verdict
from comparisons.stress.verdict import SAID as INVARIANTS
from reports.records import matrix
from reports.records.views import columns
from tests.reports.made_up_results import CONDITIONS, PRESCRIBED, made_up_results


@pytest.fixture(scope="module")
def results():
    return made_up_results(engines=("beta", "alpha"), broken={"alpha": Verdict.UNAVAILABLE}, samples=101)


def test_rows_come_by_engine_name_and_setting(results):
    ((heading, conditions, table),) = matrix.blocks(results)
    assert (heading, conditions) == ("juki-mf7923d (as-built), run-up", CONDITIONS)
    found = [row[:2] for row in table.rows]
    assert found == [(engine, setting) for engine in ("alpha", "beta") for setting in ("naive", "tuned", "best")]


def test_a_run_without_a_motion_says_why_in_words(results):
    ((_, _, table),) = matrix.blocks(results)
    assert table.rows[0][3] == "– not installed: alpha <cannot> hold this scene"
    assert not any(table.rows[0][4:])
    assert {len(row) for row in table.rows} == {len(table.head)}


def test_a_cell_has_its_sign(results):
    ((_, _, table),) = matrix.blocks(results)
    naive, tuned = table.rows[3], table.rows[4]
    assert naive[3].startswith("✗ ")
    (jeq,) = (r for r in results.records if (r.setting, r.quantity) == ("tuned", "Jeq") and r.error_max)
    assert float(tuned[3].removeprefix("✓ ")) == pytest.approx(jeq.error_max, rel=0.06)


def test_forces_of_all_joints_share_a_column_that_shows_the_worst(results):
    forces = [
        replace(record, quantity=f"joint_force:{joint}", unit="N", error_max=error)
        for record in results.records
        if record.quantity == "Mkr" and record.error_max is not None
        for joint, error in (("A", 1e-7), ("B", 3e-6))
    ]
    records = [*results.document["records"], *(asdict(force) for force in forces)]
    more = Results({**results.document, "records": records}, results.curves)
    assert columns(more)[0][-1] == "joint_force"
    ((_, _, table),) = matrix.blocks(more)
    assert table.rows[4][table.head.index("joint force")] == "✓ 3.0e-6"


def test_standings_count_and_name_the_record_that_uses_most_of_its_limit(results):
    found = {(one.engine, one.setting): one for one in matrix.standings(results)}
    beta = found["beta", "tuned"]
    every = len(PRESCRIBED) + len(INVARIANTS)
    assert (beta.passed, beta.total) == (every, every)
    assert beta.share == max(r.error_max / r.limit for r in results.records if r.setting == "tuned" and r.limit)
    assert found["alpha", "best"].failures == ("not installed: alpha <cannot> hold this scene",)


def test_limits_carry_their_reasons(results):
    rows = matrix.limit_table(results).rows
    jeq = next(row for row in rows if row[0].startswith("Jeq") and "tuned" in row[1])
    assert jeq[3] == "1e-5"
    assert "smoother than torque" in jeq[4]


def test_what_only_the_baseline_caught_is_told(results):
    grown = {"outcome": Verdict.OVER_LIMIT.value, "detail": "three times its recorded value", "baseline": 2.16e-6}
    tuned = next(record for record in results.records if record.outcome == Verdict.PASSED.value)
    rows = [asdict(r if r != tuned else replace(r, **grown)) for r in results.records]
    found = Results({**results.document, "records": rows}, results.curves)
    (sentence,) = matrix.past_baseline(found)
    assert sentence.endswith("three times its recorded value")
