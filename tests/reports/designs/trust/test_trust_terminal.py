"""What is printed of engines over a sample: counts, a sentence where each gives way, and how sure that is."""

import numpy as np

from comparisons.designs.trust.trust import trust
from comparisons.judging.records import Verdict
from reports.designs.trust.trust_terminal import printout
from reports.document.terminal import rendered
from tests.comparisons.designs.samples import made_up, record

LENGTHS = np.linspace(170.0, 179.0, 10)[:, None]


def told(*outcomes):
    """The text of ten designs, of which the first so many end so and all others pass."""
    every = [*outcomes, *[Verdict.PASSED] * (10 - len(outcomes))]
    records = [record(n, one, 4e-3 if one is Verdict.OVER_LIMIT else 1e-4) for n, one in enumerate(every, start=1)]
    found = printout(trust(made_up(LENGTHS), records), "of a Latin hypercube (seed 0)", "1000 rpm")
    return rendered(*found.tables, *found.closing)


def test_an_engine_without_a_fault_is_bounded_by_the_rule_of_three():
    text = told()
    assert "Designs simulated: 10 of a Latin hypercube (seed 0). 1000 rpm" in text
    assert (
        "e tuned: all 10 designs that were judged are within their limits; with 95 % certainty fewer than 30% of"
        in text
    )
    assert "not judged has not passed" not in text


def test_an_engine_that_gives_way_is_told_where():
    text = told(*[Verdict.OVER_LIMIT] * 4)
    row = next(line.split() for line in text.splitlines() if line.startswith("e tuned "))
    assert row[2:6] == ["6", "4", "0", "0"]
    assert "gives way where rod.B.x is below 173.5 mm: there lie 4 of 4 failing designs and 0 of 6 others" in text
    assert "within limits on all 6 designs where rod.B.x is 174.0 mm or more" in text


def test_a_single_failure_is_not_explained():
    text = told(Verdict.PASSED, Verdict.PASSED, Verdict.CRASHED)
    assert "gives way on 1 of 10 designs, which nothing tells apart, none better than chance" in text


def test_what_was_not_judged_is_said():
    assert "What was not judged has not passed." in told(Verdict.UNSUPPORTED)
    assert "e tuned: not judged on any design: unsupported" in told(*[Verdict.UNSUPPORTED] * 10)
    assert "gives way on all 10 designs that were judged: diverged" in told(*[Verdict.DIVERGED] * 10)
