"""Seeds of a search everywhere: what counts as agreeing, and that a search gives what is counted."""

import pytest

from tests.targets.global_seeds import SETS, SPREAD, Seeded, seeded


def test_seeds_agree_with_the_lowest_of_them():
    found = Seeded((2.0, 2.0 * (1.0 + 0.5 * SPREAD), 2.0002), (6, 6, 13), (100, 110, 400), 3.0)
    assert found.agreeing == 2
    assert found.spread == pytest.approx(1e-4)


def test_a_seed_is_one_search():
    found = seeded(SETS[0][:1], 1)
    assert (found.agreeing, found.spread, len(found.ends)) == (1, 0.0, 1)
    assert found.gradients[0] > found.ends[0] > 0
