"""Gaps between samples are told from steps that change with the parts of a motion, and from samples lacking there."""

import numpy as np
import pytest

from analytic.description.crank_motion import CrankMotion, Segment
from comparisons.runs.gaps import gap
from engines.scene import Free, Prescribed

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
