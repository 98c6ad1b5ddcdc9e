"""The fixture for a user's tests: green, red with the words of a record, skipped; equal calls compare once."""

from types import SimpleNamespace

import pytest

from comparisons.campaign.project import JudgedCampaign
from comparisons.judging.records import Record, run_record
from engines.pymunk_adapter.adapter import PymunkEngine
from reports.pytest_plugin import campaign as asserting
from reports.python.campaign import Comparison
from reports.requests.campaign_options import CompareOptions
from tests.reports.pytest_plugin.projects import project, run

pytest_plugins = ["pytester"]
CALL = 'linkproof_compare("linkages/bar.toml", engine="direct", quantity="Mkr", speed=500)'


def in_test(pytester, *lines):
    """Run a user's test that has the fixture."""
    body = "\n    ".join(lines)
    pytester.makepyfile(f"def test_bar(linkproof_compare):\n    {body}\n")
    return run(pytester, "-rs", "test_in_project.py")


@pytest.fixture(autouse=True)
def _named_test(pytester, monkeypatch):
    """The test's file has one name, whatever test of ours writes it."""
    monkeypatch.setattr(pytester, "_name", "test_in_project")


def test_a_comparison_that_passes_is_given(pytester):
    project(pytester)
    lines = ["found = " + CALL, "assert [r.quantity for r in found.records] == ['Mkr']", "assert found.passed",
             "assert '500 rpm' in found.records[0].conditions"]  # fmt: skip
    in_test(pytester, *lines).assert_outcomes(passed=1)


def test_one_over_its_limit_fails_with_the_command_that_repeats_it(pytester):
    project(pytester, 'engines = ["direct"]', "[[limit]]", 'quantities = ["Mkr"]', "value = 1e-30")
    done = in_test(pytester, CALL)
    done.assert_outcomes(failed=1)
    done.stdout.fnmatch_lines([
        "error * of peak is over its limit 1e-30",
        "repeat it: linkproof compare linkages/bar.toml --regime run-up --speed 500 --engine direct --setting tuned "
        "--quantity Mkr",
    ])  # fmt: skip
    done.stdout.no_fnmatch_line("*asserting.py*")


def test_an_engine_that_is_not_installed_skips_the_test(pytester, monkeypatch):
    project(pytester)
    monkeypatch.setattr(PymunkEngine, "why_unavailable", lambda _: "engine 'pymunk' is not installed: install it")
    done = in_test(pytester, 'linkproof_compare("linkages/bar.toml", engine=["direct", "pymunk"])')
    done.assert_outcomes(skipped=1)
    done.stdout.fnmatch_lines(["SKIPPED * engine 'pymunk' is not installed: install it"])


def test_where_nothing_is_judged_the_test_is_skipped(pytester, monkeypatch):
    record = Record("bar", "base", "run-up", "", "direct", "0", "tuned", outcome="unsupported", detail="no springs")
    judged = JudgedCampaign(None, [run_record(record, [record])], (), ())
    campaign = SimpleNamespace(options=CompareOptions())
    monkeypatch.setattr(asserting, "compare", lambda *_, **__: Comparison(judged, campaign))
    done = in_test(pytester, CALL)
    done.assert_outcomes(skipped=1)
    done.stdout.fnmatch_lines(["SKIPPED * unsupported: no springs"])


def test_equal_calls_compare_once(pytester, monkeypatch):
    made, compare = [], asserting.compare
    monkeypatch.setattr(
        asserting, "compare", lambda *given, **options: made.append(options) or compare(*given, **options)
    )
    project(pytester)
    in_test(pytester, CALL, CALL, CALL.replace("500", "600")).assert_outcomes(passed=1)
    assert [options["speed"] for options in made] == [500, 600]
