"""Exit codes tell engines' failures from faults of ours and from runs that say nothing."""

from dataclasses import replace

import pytest

from analytic.errors import LinkproofError
from comparisons.trials.judging.changes import Change, ChangeKind
from comparisons.trials.judging.records import Error
from comparisons.trials.stress.campaign import Stress
from comparisons.trials.stress.cells import StressVerdict, find_cell
from reports.studies.trials import Benchmark, StabilityMaps, campaign_exit_code
from tests.made_up import bench_of, row


def _record(outcome, setting="tuned"):
    return Error("m", "v", "run-up", "", "direct", setting, "Mkr", outcome=outcome, detail=f"it is {outcome}")


@pytest.mark.parametrize(
    ("outcomes", "code"),
    [
        (["passed"], 0),
        (["passed", "unsupported", "undefined", "computed", "not-provided"], 0),
        (["passed", "adapter-error"], 1),
        (["passed", "crashed"], 1),
        (["over-limit", "suite-error"], 3),
    ],
)
def test_a_campaign_fails_by_its_worst_record(outcomes, code):
    assert campaign_exit_code([_record(outcome) for outcome in outcomes]) == code


def test_naive_records_count_only_where_nothing_else_ran():
    assert campaign_exit_code([_record("diverged", "naive"), _record("passed")]) == 0
    assert campaign_exit_code([_record("diverged", "naive")]) == 1


@pytest.mark.parametrize(
    ("kind", "code"), [(ChangeKind.CHANGED, 1), (ChangeKind.VANISHED, 1), (ChangeKind.APPEARED, 0)]
)
def test_what_is_not_as_recorded_fails(kind, code):
    change = Change(kind, ("m", "v", "run-up", "c", "closed form", "", "Mkr.peak"), 1.0, 1.01)
    assert campaign_exit_code([_record("passed")], [change]) == code


def test_nothing_judged_is_no_success():
    with pytest.raises(LinkproofError, match=r"got none: unsupported, it is unsupported \(and 1 other reasons\)$"):
        campaign_exit_code([_record("unsupported"), _record("unsupported"), _record("computed")])
    with pytest.raises(LinkproofError, match="nothing to run"):
        campaign_exit_code([])


def _cell(verdict):
    blank = find_cell("start/positions/1e-08/direct/tuned")
    return replace(blank, verdict=verdict, reason="so it is")


def test_a_map_fails_by_its_worst_cell():
    within, missed, ours = map(_cell, (StressVerdict.WITHIN, StressVerdict.MISSED, StressVerdict.SUITE_ERROR))
    every = [[within, *more] for more in ([], [missed], [missed, ours])]
    assert [StabilityMaps(Stress({}, cells)).exit_code for cells in every] == [0, 1, 3]
    with pytest.raises(LinkproofError, match="got none: unsupported, so it is"):
        _ = StabilityMaps(Stress({}, [_cell(StressVerdict.UNSUPPORTED)])).exit_code


def _bench_code(*runs):
    return Benchmark(bench_of(*runs)).exit_code


def test_a_benchmark_fails_where_an_engine_gave_nothing():
    absent = row(engine="beta", outcome="unavailable", error_max=None, detail="not installed")
    broken, ours = (row(engine="beta", outcome=outcome, error_max=None) for outcome in ("adapter-error", "suite-error"))
    others = (row(engine="beta"), absent, broken, ours)
    assert [_bench_code(row(), other) for other in others] == [0, 0, 1, 3]
    with pytest.raises(LinkproofError, match="got none: unavailable, not installed"):
        _bench_code(absent)
