"""The driver on an engine made up for it: how many passes it makes, and which step it settles on."""

import math

import pytest

from engines.contract import History, Outcome
from engines.stepping.cost import Cost
from engines.stepping.driver import DivergedError, StepSearch, UnsupportedError, refined, run_stepping, whole_steps
from engines.stepping.richardson import Pass


def _refined(estimates, **options):
    """Ratios of the passes that were made where their estimates are as given, by the number of passes."""
    made = []

    def run_pass(ratio):
        made.append(ratio)
        return Pass(1.0 / ratio, History())

    options = {"levels": 2, "accuracy": 1e-3, **options}
    passes, error = refined(run_pass, (1, 3, 5, 7), estimate=lambda passes: estimates[len(passes)], **options)
    assert [round(1.0 / each.step) for each in passes][-len(made) :] == made
    return made, error


def test_passes_are_added_until_they_are_accurate():
    assert _refined({2: 1e-2, 3: 1e-4}) == ([1, 3, 5], 1e-4)
    assert _refined({2: 1e-4}) == ([1, 3], 1e-4)
    assert _refined({4: 1.0}, levels=4) == ([1, 3, 5, 7], 1.0)


def test_passes_that_gain_too_little_are_the_last():
    assert _refined({2: 1e-2, 3: 8e-3}, worthwhile=0.5) == ([1, 3, 5], 8e-3)
    assert _refined({2: math.nan}) == ([1, 3], pytest.approx(math.nan, nan_ok=True))


def test_a_pass_that_exists_is_not_made_again():
    assert _refined({2: 1e-4}, first=[Pass(1.0, History())]) == ([3], 1e-4)


def _search(trials=8):
    return StepSearch(duration=1.0, steps_per_turn=2.0 * math.pi, least_steps=4, trials=trials, retreat=2.0)


def test_a_step_is_cut_until_it_fits_the_pace_it_shows():
    tried = []

    def pace(step):
        tried.append(step)
        return 100.0 if step < 0.05 else 50.0

    assert _search().fit(0.1, pace) == pytest.approx(0.01)
    assert tried == pytest.approx([0.1, 0.02, 0.01])


def test_a_step_that_fails_is_cut_and_trials_run_out():
    def pace(step):
        raise DivergedError("no motion")

    search = _search(trials=3)
    with pytest.raises(DivergedError, match=r"no step down to 0.025 s .* no motion"):
        search.fit(0.2, pace)
    assert search.trials == 0


def test_steps_are_whole():
    assert whole_steps(0.3, 0.1, 2) == 3  # 0.3 / 0.1 is a rounding more than 3
    assert whole_steps(0.31, 0.1, 2) == 4
    assert whole_steps(0.3, 1.0, 8) == 8


@pytest.mark.parametrize(
    ("error", "outcome"), [(DivergedError("gone"), Outcome.DIVERGED), (UnsupportedError("gone"), Outcome.UNSUPPORTED)]
)
def test_a_run_that_stops_keeps_its_reason_and_what_it_cost(error, outcome):
    cost = Cost(details={"method": "any"})

    def history():
        with cost.stepping():
            cost.steps += 7
            raise error

    run = run_stepping(cost, history)
    assert (run.outcome, run.reason, run.steps, run.details) == (outcome, "gone", 7, {"method": "any"})
    assert run.seconds > 0.0
