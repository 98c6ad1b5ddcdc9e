"""A run and its facts: the contract of its samples, gaps between them, clocks, the machine."""

import re
from dataclasses import replace

import numpy as np
import pytest

from analytic.description.crank_motion import CrankMotion, Segment, crank_motion
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.trials.runs.run_engine import AdapterError, checked, gap
from engines.contract import Outcome, Run, Signal
from engines.scene import Free, Prescribed
from tests.comparisons.true_motions import perfect_motion

END = 1.0
PARTS = Prescribed(CrankMotion("parts", (Segment(0.0, 0.6, (0.0, 1.0)), Segment(0.6, END, (0.6, 1.0)))))
STEADY = np.linspace(0.0, END, 1001)
GRADED = np.concatenate([np.linspace(0.0, 0.6, 601), np.linspace(0.6, END, 9)[1:]])  # 50 times as long at once
# A dwell in three samples, as slow parts have few.
DWELL = Prescribed(
    CrankMotion(
        "dwell", tuple(Segment(t, t + d, (0.0, w)) for t, d, w in ((0.0, 0.3, 1.0), (0.3, 0.4, 0.0), (0.7, 0.3, -1.0)))
    )
)
FEW = np.concatenate([np.linspace(0.0, 0.3, 301), [0.4, 0.5, 0.6], np.linspace(0.7, END, 301)])


def without(time, *places):
    return np.delete(time, [np.argmin(np.abs(time - place)) for place in places])


@pytest.mark.parametrize(
    ("time", "drive", "hole"),
    [
        (STEADY, PARTS, ""),
        (GRADED, PARTS, ""),
        (FEW, DWELL, ""),
        (without(STEADY, 0.0, 0.001, 0.002, 0.003, END), PARTS, ""),
        (without(STEADY, 0.601, 0.602, 0.603), PARTS, ""),
        (without(STEADY, 0.3, 0.7, 0.702), PARTS, ""),
        (without(STEADY, 0.3, 0.301), PARTS, "from 0.299 to 0.302 s, where its own step is 0.001 s"),
        (without(STEADY, 0.601, 0.602, 0.603), Free(0.0, END), "from 0.6 to 0.604 s, where its own step is 0.001 s"),
        (FEW[:303], DWELL, "from 0.5 to 1 s, where its own step is 0.001 s"),
        (without(STEADY, *STEADY[:6]), PARTS, "from 0 to 0.006 s, where its own step is 0.001 s"),
        (without(GRADED, *GRADED[-5:]), PARTS, "from 0.75 to 1 s, where its own step is 0.05 s"),
    ],
)  # fmt: skip
def test_a_gap_is_longer_than_a_few_of_the_steps_around_it(time, drive, hole):
    assert gap(time, drive) == hole


MOTION = perfect_motion(Mechanism(load("juki-mf7923d")), crank_motion("run-up-quintic"), 29)
RUN = Run(Outcome.FINISHED, history=MOTION.history, seconds=0.5, steps=28)


def moved(change):
    """The run with other times and values of its positions."""
    position = MOTION.history.position
    return replace(RUN, history=replace(MOTION.history, position=Signal(*change(position.time, position.values))))


@pytest.mark.parametrize(
    ("run", "words"),
    [
        (None, "a Run, got a NoneType"),
        (replace(RUN, outcome="weird"), "an Outcome, got a str"),
        (replace(RUN, reason=3), "a reason as text, got 3"),
        (replace(RUN, seconds=-5.0), "seconds that are finite and not negative, got -5.0"),
        (replace(RUN, setup_seconds=float("inf")), "setup_seconds that are finite and not negative, got inf"),
        (replace(RUN, steps=10**30), "steps as a number from 0 on"),
        (replace(RUN, passes=[1e-3]), "passes as steps in s, got a list"),
        (replace(RUN, details={"o": object()}), "texts and finite numbers, got a object"),
        (replace(RUN, history=None), "a History of a run that finished, got a NoneType"),
        (moved(lambda time, values: (time, values[:, :2])), r"got \(29, 2, 3\) in position"),
        (moved(lambda time, values: (time, values + 1j)), "arrays of real numbers"),
        (moved(lambda time, values: (-time, values)), "finite and never decrease"),
        (moved(lambda time, values: (np.where(time > 0.1, np.nan, time), values)), "finite and never decrease"),
    ],
)
def test_a_run_that_violates_the_contract_is_an_error_of_its_adapter(run, words):
    with pytest.raises(AdapterError, match=rf"^the adapter of e returned a run .* expected .*{words}"):
        checked(run, MOTION.scene, "e")


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda time, values: (time, 1e300 * values), r"position is beyond 1e\+100 from 0 s on"),
        (
            lambda time, values: (time, np.where(np.arange(29) < 14, 0.0, np.nan)[:, None, None] + values),
            "position is not",
        ),
        (lambda time, values: (time[:4], values[:4]), "position has 4 samples, too few to read between"),
    ],
)
def test_a_finished_run_that_cannot_be_read_has_diverged(change, reason):
    run = checked(moved(change), MOTION.scene, "e")
    assert run.outcome is Outcome.DIVERGED
    assert re.match(reason, run.reason)
