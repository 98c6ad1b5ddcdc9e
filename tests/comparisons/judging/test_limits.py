"""Every quantity has a limit with a reason in every setting and regime."""

import itertools

import pytest

from analytic.description.crank_motion import REGIMES
from comparisons.judging.limits import limit
from comparisons.judging.quantities import QUANTITIES
from comparisons.stress.verdict import SAID as INVARIANTS
from engines.contract import Setting

GIVEN = {"Mkr", "Peq"}  # by the drive of a released crank, not results


def test_the_table_is_complete():
    for quantity in (*QUANTITIES, *INVARIANTS, "joint_force:A"):
        for setting, regime in itertools.product(Setting, [*REGIMES, "a-regime-of-its-own"]):
            if quantity in GIVEN and regime not in REGIMES:
                continue
            row = limit(quantity, setting, regime)
            least_strict = 0.06 if setting is Setting.NAIVE else 0.02  # no looser than what the sources claim
            assert 0.0 < row.value <= least_strict, (quantity, setting, regime)
            assert len(row.reason.split()) > 4, (quantity, setting, regime)


def test_best_is_held_to_more_than_tuned():
    assert limit("Mkr", "best", "run-up-quintic").value < limit("Mkr", "tuned", "run-up-quintic").value


def test_an_uncovered_quantity_says_what_to_add():
    with pytest.raises(LookupError, match="add one with its reason"):
        limit("colour", "tuned", "run-up")
