"""Samples as a history: one at each instant, the later part's between two parts."""

import numpy as np

from engines.contract import Origin
from engines.scene import Channel
from engines.stepping.intervals import Interval
from engines.stepping.recording import recorded

PARTS = [Interval(0.0, 1.0, 2), Interval(1.0, 4.0, 1)]


def test_samples_of_parts_become_one_history_in_which_the_later_part_counts():
    def states(part, time):
        for instant in time:
            mark = part.start + 10.0 * instant
            yield {Channel.TORQUE: mark, Channel.JOINT_FORCE: [(mark, 0.0), (0.0, -mark)]}

    history = recorded(PARTS, ["A", "B"], states)
    marks = [0.0, 5.0, 11.0, 41.0]  # at 1 s it is 10 by the first part
    np.testing.assert_array_equal(history.torque.time, [0.0, 0.5, 1.0, 4.0])
    np.testing.assert_array_equal(history.torque.values, marks)
    np.testing.assert_array_equal(history.joint_force["A"].values[:, 0], marks)
    np.testing.assert_array_equal(history.joint_force["B"].values[:, 1], np.negative(marks))
    assert history.joint_force["A"].origin is Origin.READ
    assert history.position is None


def test_a_channel_that_is_not_sampled_is_absent():
    history = recorded(PARTS, ["A"], lambda part, time: [{Channel.TORQUE: 0.0} for _ in time])
    assert history.joint_force == {}
