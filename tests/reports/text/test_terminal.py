"""Terminal tables hold what they should, at 80 columns and without colour."""

import dataclasses

from rich.console import Console

from analytic.description.loading import catalogue, load
from comparisons.campaign.campaign import RunResult
from comparisons.reference.published import all_variants, compare_published
from reports.facts.mechanism_summary import portrait
from reports.text import terminal
from tests.comparisons.judging.test_baseline import RECORD


def _text(renderable):
    console = Console(width=80, no_color=True, force_terminal=False)
    with console.capture() as capture:
        console.print(renderable)
    return capture.get()


def _result(**changes):
    records = [dataclasses.replace(RECORD, quantity=q, **changes) for q in ("Jeq", "joint_force:A", "joint_force:B")]
    return RunResult(tuple(records), ())


def test_deviations_stand_beside_their_limits():
    text = _text(terminal.campaign([_result()]))
    assert "m (v), r: c" in text
    assert "1.2e-05 ✓" in text
    assert "1e-04" in text
    assert text.count("joint_force") == 1
    assert "3 deviations: 3 passed" in text


def test_the_worst_joint_stands_for_all():
    result = _result()
    worse = dataclasses.replace(result.records[2], error_max=7.7e-3, outcome="over-limit", detail="over its limit")
    text = _text(terminal.campaign([dataclasses.replace(result, records=(*result.records[:2], worse))]))
    assert "7.7e-03 ✗" in text


def test_a_run_that_failed_says_why_once():
    failed = _result(error_max=None, outcome="diverged", detail="the crank ran away")
    text = _text(terminal.campaign([failed]))
    assert text.count("the crank ran away") == 1
    assert "3 deviations: 3 diverged" in text


def test_catalogue_portrait_and_published_name_their_mechanism():
    linkages = [load(name) for name in catalogue()]
    assert all(linkage.name in _text(terminal.catalogue(linkages)) for linkage in linkages)
    assert "juki-mf7923d (as-built)" in _text(terminal.portrait(portrait(load("juki-mf7923d"))))
    text = _text(terminal.published(compare_published(all_variants("juki-mf7923d"))))
    assert "9.127e-05 ✓" in text
    assert "+0.3%" in text
