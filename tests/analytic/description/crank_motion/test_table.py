"""A table as a motion: met at its points, smooth between them, and near the motion that it was read from."""

import numpy as np
import pytest

from analytic.description.crank_motion import swing
from analytic.description.crank_motion.table import table_motion
from analytic.errors import LinkproofError

LAW = swing("cycloidal", 0.2, 1.7, time=0.5)


@pytest.mark.parametrize(("points", "error"), [(21, 2e-4), (41, 1e-5), (161, 5e-8)])
def test_a_table_of_a_law_is_that_law_to_the_fourth_order(points, error):
    """A cubic spline errs by h⁴, at its ends, where nothing is said of its slopes, by a little more."""
    time = np.linspace(0.0, 0.5, points)
    motion = table_motion("read", time.tolist(), LAW.angle(time).tolist())
    assert motion.angle(time) == pytest.approx(LAW.angle(time), abs=1e-15)
    dense = np.linspace(0.0, 0.5, 2003)
    assert motion.angle(dense) == pytest.approx(LAW.angle(dense), abs=error)
    assert motion.peak_speed == pytest.approx(LAW.peak_speed, rel=20 * error)


def test_its_acceleration_has_no_jump_but_the_start():
    time = np.array([0.0, 0.1, 0.15, 0.3, 0.5])
    motion = table_motion("uneven", time.tolist(), LAW.angle(time).tolist())
    assert set(motion.jumps) <= {0.0}
    for before, after in zip(motion.segments, motion.segments[1:], strict=False):
        for order in range(3):
            assert before.value(before.end, order) == pytest.approx(after.value(after.start, order), abs=1e-11)


def test_a_fast_part_that_several_points_show_is_no_jump():
    table_motion("fast", [0.0, 1.0, 2.0, 2.1, 2.2, 2.3, 3.0, 4.0], [0.0, 0.0, 0.0, 0.3, 0.8, 1.0, 1.0, 1.0])


@pytest.mark.parametrize("bad", [float("nan"), float("inf")])
def test_what_is_not_finite_is_refused(bad):
    with pytest.raises(LinkproofError, match="finite times and angles"):
        table_motion("bad", [0.0, 1.0, 2.0, 3.0], [0.0, bad, 2.0, 3.0])


def test_times_that_all_but_coincide_are_refused():
    with pytest.raises(LinkproofError, match="times a motion can have, got some 1e-300 s apart"):
        table_motion("bad", [0.0, 1e-300, 2e-300, 3e-300], [0.0, 1.0, 2.0, 3.0])
