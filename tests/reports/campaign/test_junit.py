"""A campaign as JUnit's XML: every verdict a test case, failed, skipped or passed as the exit code counts it."""

from dataclasses import replace
from xml.etree import ElementTree

import pytest

from comparisons.campaign.key_figures import KeyFigure
from reports.campaign.junit import junit
from tests.comparisons.judging.test_baseline import RECORD

FIGURE = KeyFigure("m", "v", "r", "c", "Mkr.peak", 1.0, 1.0, changed=False)


def _cases(records, figures=(), departures=()):
    root = ElementTree.fromstring(junit(records, figures, departures))
    return {(case.get("classname"), case.get("name")): case for case in root.iter("testcase")}


def test_a_record_is_a_case_of_its_run():
    (case,) = _cases([RECORD]).items()
    assert case[0] == ("m/v/r/e/tuned", "Mkr")
    assert list(case[1]) == []


@pytest.mark.parametrize(
    ("outcome", "tag"),
    [
        ("over-limit", "failure"),
        ("crashed", "failure"),
        ("adapter-error", "failure"),
        ("suite-error", "error"),
        ("unavailable", "skipped"),
        ("computed", "skipped"),
        ("undefined", "skipped"),
    ],
)
def test_what_did_not_pass_says_why(outcome, tag):
    record = replace(RECORD, outcome=outcome, detail="because <it> is\x07 so", baseline=2e-5)
    ((told,),) = _cases([record]).values()
    assert (told.tag, told.get("type")) == (tag, outcome)
    assert told.get("message") == "because <it> is� so"
    assert told.text.splitlines()[1:] == [
        "error 1.235e-05 of the peak, 1 N m", "limit 1.000e-04", "three times the recorded error 2.000e-05",
    ]  # fmt: skip


def test_naive_failures_count_only_where_nothing_else_ran():
    naive = replace(RECORD, setting="naive", outcome="over-limit", detail="too far")
    ((told,),) = _cases([naive]).values()
    assert told.tag == "failure"
    (told,) = _cases([naive, RECORD])["m/v/r/e/naive", "Mkr"]
    assert (told.tag, told.get("message")) == ("skipped", "decides nothing beside other settings: too far")


def test_key_figures_are_cases_too():
    changed = replace(FIGURE, figure="Jeq.mean", now=1.01, changed=True)
    unknown = replace(FIGURE, figure="Peq.peak", recorded=None)
    found = _cases([RECORD], [FIGURE, changed, unknown])
    tags = {name: [told.tag for told in case] for (place, name), case in found.items() if place == "m/v/r/key figures"}
    assert tags == {"Mkr.peak": [], "Jeq.mean": ["failure"], "Peq.peak": ["skipped"]}
    assert found["m/v/r/key figures", "Jeq.mean"][0].get("message") == changed.sentence


def test_what_departs_from_the_baseline_is_a_case_that_fails():
    ((told,),) = (case for (place, _), case in _cases([RECORD], (), ["a.toml is new"]).items() if place == "baseline")
    assert (told.tag, told.get("message")) == ("failure", "a.toml is new")


def test_suites_count_their_cases_and_the_time_of_every_run_once():
    first = [replace(RECORD, seconds=1.5), replace(RECORD, seconds=1.5, quantity="Jeq", outcome="diverged", detail="x")]
    other = replace(RECORD, mechanism="n", seconds=0.25, outcome="unsupported", detail="y")
    root = ElementTree.fromstring(junit([*first, other], [FIGURE]))
    suites = {one.get("name"): one for one in root}
    counts = ("tests", "failures", "errors", "skipped", "time")
    assert [suites["m/v/r"].get(name) for name in counts] == ["3", "1", "0", "0", "1.500000"]
    assert [suites["n/v/r"].get(name) for name in counts] == ["1", "0", "0", "1", "0.250000"]
    assert [root.get(name) for name in counts[:-1]] == ["4", "1", "0", "1"]
