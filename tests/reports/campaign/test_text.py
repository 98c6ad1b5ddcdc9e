"""A campaign in the terminal, in the summary and as JUnit's XML."""

import re
from xml.etree import ElementTree

import pytest

from comparisons.trials.judging.changes import Change, ChangeKind
from comparisons.trials.judging.records import RunRecord
from reports.campaign.junit import junit
from reports.campaign.terminal import printout
from reports.document.terminal import rendered
from tests.comparisons.trials.judging.test_judging import RECORD


def _text(printout):
    return rendered(*printout.tables, *printout.closing, width=80)


def _result(origin="", runs=1):
    records = [RECORD._replace(quantity=q, origin=origin) for q in ("Jeq", "joint_force:A", "joint_force:B")]
    return _run(*records, runs=runs)


def _run(*errors, **costs):
    return RunRecord(*errors[0][:5], "1", errors[0].setting, errors=errors, **costs)


@pytest.mark.parametrize(
    ("origin", "runs", "words", "line"),
    [
        ("read", 1, "1 run, read", ""),
        ("partly computed", 1, "read in part", "partly computed by its adapter: Jeq, joint_force"),
        ("computed", 1, "read in part", "computed by its adapter: Jeq, joint_force"),
        ("partly computed", 4, "4 runs, extrapolated", "partly computed by its adapter: Jeq, joint_force"),
    ],
)
def test_computed_figures_are_not_called_read(origin, runs, words, line):
    text = _text(printout([_result(origin=origin, runs=runs)]))
    assert words in text
    assert ("read" in text) is ("read" in words)
    assert f"{RECORD.engine} {RECORD.setting}: {line}" in text or not line


PLACE = ("m", "v", "r", "c", "e", "tuned")
CHANGED = Change(ChangeKind.CHANGED, (*PLACE[:4], "closed form", "", "Jeq.mean"), 2.0, 2.02, unit="kg m²")
GROWN = Change(ChangeKind.GROWN, (*PLACE, "Mkr"), 1e-6, 4e-6, "passed")
VANISHED = [Change(ChangeKind.VANISHED, (*PLACE[:5], "best", name), 1e-6, None) for name in ("S", "v")]
APPEARED = Change(ChangeKind.APPEARED, (*PLACE, "Teq"), None, 1e-6, "passed")


def _cases(run, changes=()):
    root = ElementTree.fromstring(junit([run], changes))
    return {(case.get("classname"), case.get("name")): case for case in root.iter("testcase")}


def test_what_has_changed_is_a_table_and_a_line_and_test_cases():
    every = [CHANGED, GROWN, *VANISHED, APPEARED]
    text = rendered(*(printed := printout([_result()], every)).tables, *printed.closing, width=200)
    rows = [re.split(" {2,}", line) for line in text.splitlines() if line.startswith("m (v)  ")]
    assert rows == [
        ["m (v)", "r", "closed form", "Jeq.mean", "changed", "2", "2.02", "kg m²", "+1 %"],
        ["m (v)", "r", "e tuned", "Mkr", "grown threefold", "1.0e-6", "4.0e-6", "4.0 times"],
        ["m (v)", "r", "e best", "2 quantities", "vanished"],
    ]
    assert "not recorded, which is no failure: 1 result of m (v), r, e tuned" in text
    assert "not as recorded: 1 changed, 1 grown threefold, 2 vanished" in text
    found = {
        name: case for (place, name), case in _cases(_run(RECORD), every).items() if place.startswith("changes/m/v/r")
    }
    assert {name: case[0].tag for name, case in found.items()} == {
        **dict.fromkeys(("Jeq.mean", "Mkr", "S", "v"), "failure"), "Teq": "skipped",
    }  # fmt: skip
    assert found["Mkr"][0].get("message") == GROWN.sentence


@pytest.mark.parametrize(
    ("outcome", "tag"),
    [
        ("over-limit", "failure"),
        ("suite-error", "error"),
        ("unavailable", "skipped"),
    ],
)
def test_what_did_not_pass_says_why(outcome, tag):
    record = RECORD._replace(outcome=outcome, detail="because <it> is\x07 so")
    ((told,),) = _cases(_run(record)).values()
    assert (told.tag, told.get("type")) == (tag, outcome)
    assert told.get("message") == "because <it> is� so"
    assert told.text.splitlines()[1:] == ["error 1.235e-05 of the peak, 1 N m", "limit 1.000e-04"]


def test_suites_count_their_cases_and_the_time_of_every_run_once():
    first = _run(RECORD, RECORD._replace(quantity="Jeq", outcome="diverged", detail="x"), seconds=1.5)
    other = _run(RECORD._replace(mechanism="n", outcome="unsupported", detail="y"), seconds=0.25)
    root = ElementTree.fromstring(junit([first, other]))
    suites = {one.get("name"): one for one in root}
    counts = ("tests", "failures", "errors", "skipped", "time")
    assert [suites["m/v/r"].get(name) for name in counts] == ["2", "1", "0", "0", "1.500000"]
    assert [suites["n/v/r"].get(name) for name in counts] == ["1", "0", "0", "1", "0.250000"]
    assert [root.get(name) for name in counts[:-1]] == ["3", "1", "0", "1"]
