"""A campaign's tables hold what they should, at 80 columns and without colour."""

import dataclasses

import pytest

from comparisons.judging.records import run_record
from reports.campaign.terminal import printout
from reports.document.terminal import rendered
from reports.records.environment import AT_A_TIME
from tests.comparisons.judging.test_baseline import RECORD


def _text(printout):
    return rendered(*printout.tables, *printout.closing, width=80)


def _result(**changes):
    records = [dataclasses.replace(RECORD, quantity=q, **changes) for q in ("Jeq", "joint_force:A", "joint_force:B")]
    return run_record(records[0], records)


def test_deviations_stand_beside_their_limits():
    text = _text(printout([_result()]))
    assert "m (v), r: c" in text
    assert "1.2e-05 ✓" in text
    assert "1e-04" in text
    assert text.count("joint_force") == 1
    assert "3 deviations: 3 passed" in text


def test_set_up_stands_beside_stepping():
    lines = [line.split() for line in _text(printout([_result(setup_seconds=0.65, seconds=0.04)])).splitlines()]
    place = lines.index(["seconds,", "set-up", "0.650"])
    assert lines[place + 1] == ["seconds,", "stepping", "0.040"]


def test_times_of_runs_side_by_side_say_so():
    lines = _text(printout([_result(seconds=0.04)], environment={AT_A_TIME: "4"})).splitlines()
    assert [*map(str.split, lines)].count(["seconds,", "stepping", "while", "4", "ran", "0.040"]) == 1


@pytest.mark.parametrize(
    ("origin", "runs", "words", "line"),
    [
        ("read", 1, "1 run, read", ""),
        ("partly computed", 1, "read in part", "partly computed by its adapter: Jeq, joint_force"),
        ("computed", 1, "read in part", "computed by its adapter: Jeq, joint_force"),
        ("partly computed", 4, "4 runs, extrapolated", "partly computed by its adapter: Jeq, joint_force"),
    ],
)
def test_what_is_computed_is_not_said_to_be_read(origin, runs, words, line):
    text = _text(printout([_result(origin=origin, runs=runs)]))
    assert words in text
    assert ("read" in text) is ("read" in words)
    assert f"{RECORD.engine} {RECORD.setting}: {line}" in text or not line


def test_the_worst_joint_stands_for_all():
    result = _result()
    worse = dataclasses.replace(result.records[2], error_max=7.7e-3, outcome="over-limit", detail="over its limit")
    text = _text(printout([run_record(worse, (*result.records[:2], worse))]))
    assert "7.7e-03 ✗" in text


def test_a_run_that_failed_says_why_once():
    failed = _result(error_max=None, outcome="diverged", detail="the crank ran away")
    text = _text(printout([failed]))
    assert text.count("the crank ran away") == 1
    assert "3 deviations: 3 diverged" in text


CHECKED = ("joint_gap", "closure", "crank_phase", "torque_two_routes", "force_balance")


@pytest.mark.parametrize(
    ("failing", "words"),
    [
        (("Mkr", "torque_two_routes", "joint_force:A", "force_balance"), "gravity or a load of the engine's model"),
        (("joint_force:A", "force_balance"), "the joint forces do not balance: they are read on the other body"),
        (("Mkr", "torque_two_routes"), "the drive torque is not the one it takes: it is read with the wrong sign"),
        (("joint_gap", "closure"), "the positions do not fit the joints"),
        (("Mkr",), ""),  # no check of the motion fails
        ((), ""),
    ],
)
def test_rows_that_fail_together_have_their_meaning_once(failing, words):
    rows = {
        name: dataclasses.replace(
            RECORD, engine="e", quantity=name, outcome="over-limit" if name in failing else "passed", detail=""
        )
        for name in ("Mkr", "joint_force:A", *CHECKED)
    }
    run = run_record(RECORD, [rows["Mkr"], rows["joint_force:A"]], [rows[name] for name in CHECKED])
    text = rendered(*printout([dataclasses.replace(run, engine="e")] * 2).closing, width=400)
    assert text.count("check-engine e'") == bool(words)
    assert words in text


def test_details_hold_every_record_and_all_its_figures():
    text = rendered(*printout([_result(detail="because")]).details)
    assert all(name in text for name in ("Jeq", "joint_force:A", "joint_force:B"))
    assert text.count("because") == 3


def test_a_failed_run_is_explained_where_tables_are_left_out():
    failed = _result(error_max=None, outcome="diverged", detail="the crank ran away")
    assert "the crank ran away" in rendered(*printout([failed]).closing)
