"""Every verdict has a sign, and values of an axis are written short."""

import pytest

from comparisons.judging.records import QuantityRecord
from comparisons.stress.cell_result import StressVerdict
from reports.stress.facts import SIGNS, against, value_words


def test_every_verdict_has_a_sign_of_its_own():
    assert set(SIGNS) == set(StressVerdict)
    assert len({sign.symbol for sign in SIGNS.values()}) == len(SIGNS)


@pytest.mark.parametrize(
    ("value", "words"),
    [(1e-6, "1e-6"), (0.0123456, "0.0123"), (200.0, "200"), (1e4, "1e4"), (12000.0, "12000"), (0.0, "0"), (None, "–")],
)
def test_a_value_is_written_short_and_to_three_digits(value, words):
    assert value_words(value) == words


def test_an_error_stands_beside_its_limit_or_not_at_all():
    assert against(QuantityRecord("S", error_max=2e-3, limit=1e-3)) == "S 2.0e-3, limit 1e-3"
    assert against(None) == ""
