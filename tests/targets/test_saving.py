"""What best saves against the first method's fixed steps."""

import pytest

from tests.comparisons.bench_rows import setting_row, sweep_rows
from tests.targets.saving import saving

SECOND = sweep_rows([0.1 / 4**k for k in range(8)], setting="second")
FOURTH = sweep_rows([0.1 / 16**k for k in range(6)], setting="fourth", cost=4e-3, runs=2)


def test_what_a_setting_saves_against_plain_steps_that_get_there():
    best = setting_row("best", 1e-9, 2e-3)
    found = saving([best, *SECOND, *FOURTH], "best", 0.1 / 4**5)
    assert found.seconds == pytest.approx(1e-3 * 2**5)
    assert found.ratio == pytest.approx(16.0)
    assert "16 × as long" in found.sentence


def test_what_it_saves_against_plain_steps_that_do_not():
    best = setting_row("best", 1e-9, 2e-3)
    found = saving([best, *SECOND], "best", 1e-8)
    assert found.seconds is None
    assert found.ratio is None
    assert found.projected == pytest.approx(1e-3 * (0.1 / 1e-8) ** 0.5, rel=1e-3)
    assert "did not reach 1e-8" in found.sentence
    level = saving([best, *sweep_rows([1.5] * 6)], "best", 1e-6)
    assert level.projected is None
    assert "read-out or model" in level.sentence


def test_a_setting_that_misses_the_error_itself_saves_nothing():
    assert saving([setting_row("best", 1e-5, 1e-3), *SECOND], "best", 1e-6) is None
    assert saving([setting_row("best", 1e-9, 1e-3)], "best", 1e-6) is None
