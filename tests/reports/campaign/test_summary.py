"""The summary: tables that line up, an order and digits that diff cleanly."""

import re
from dataclasses import asdict, replace

import pytest

from analytic.description.loading import load
from comparisons.campaign.key_figures import KeyFigure
from comparisons.campaign.results import Results
from comparisons.datasheet.building import usual_sheet
from comparisons.judging.records import Verdict
from reports.campaign.summary import markdown
from tests.reports.made_up_results import changed_results, made_up_results


@pytest.fixture(scope="module")
def results():
    return made_up_results(
        samples=51, engines=("alpha", "beta", "gamma"), broken={"gamma": Verdict.UNAVAILABLE}, regimes=("run-up",)
    )


@pytest.fixture(scope="module")
def text(results):
    return markdown(results, [usual_sheet(load("juki-mf7923d"))])


def tables(text):
    return [block.splitlines() for block in text.split("\n\n") if block.startswith("|")]


def test_every_table_lines_up(text):
    found = tables(text)
    assert len(found) >= 3
    for lines in found:
        assert len({line.replace("\\|", "").count("|") for line in lines}) == 1


def test_sections_in_order(text):
    found = [line[3:] for line in text.splitlines() if line.startswith("## ")]
    assert found == ["Verdict", "Errors", "Published figures against ours", "Limits"]


def test_errors_are_signed_where_they_are_over_and_failures_are_words(text):
    head = "| quantity | limit | alpha naive | alpha tuned | alpha best | beta naive |"
    assert text.count(head) == 1
    assert re.search(r"^\| Jeq [^|]*\(.* kg m²\) \| 6e-2, 1e-5 \| \d\.\de-2 ✗ \| 1\.\de-6 \|", text, re.MULTILINE)
    assert "- gamma naive; tuned; best – not installed: gamma \\<cannot> hold this scene." in text


def test_another_machine_on_another_day_writes_the_same(results, text):
    slow = changed_results(results, lambda record: replace(record, seconds=9.9, setup_seconds=9.9))
    environment = {**results.document["environment"], "date": "another day", "machine": "another"}
    later = Results({**results.document, "environment": environment}, slow.runs)
    assert markdown(later, [usual_sheet(load("juki-mf7923d"))]) == text


def test_the_verdict_is_that_of_the_first_page_without_a_time(text):
    assert "Trust alpha and beta, once tuned" in text
    assert "Nothing was judged of gamma." in text
    assert "quickest" not in text


def test_the_order_of_the_records_changes_nothing(results, text):
    later = Results(results.document, results.runs[::-1])
    assert markdown(later, [usual_sheet(load("juki-mf7923d"))]) == text


def test_round_off_has_no_digits(results):
    tiny = changed_results(results, lambda one: one and replace(one, error_max=one.error_max and 4.4e-16))
    assert "| < 1e-13 |" in markdown(tiny)


def test_key_figures_that_changed_have_a_table(results):
    figure = KeyFigure("juki-mf7923d", "as-built", "run-up", "c", "Mkr.peak", 1.0, 1.01, changed=True, unit="N m")
    told = {"figures": [asdict(figure)], "notes": ["juki.toml has changed"]}
    found = Results({**results.document, **told}, results.runs)
    assert "| juki-mf7923d (as-built) | run-up | Mkr.peak | 1 | 1.01 | N m | +1 % |" in markdown(found).splitlines()
