"""A load over the driver's coordinate as loops have it: cubics in plain data, against SciPy's own splines."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from analytic.description.law import FULL_TURN, Law
from engines.stepping.stepped_engine import plain_law

KNOTS = np.radians([-40.0, 15.0, 80.0, 170.0, 250.0])
VALUES = np.array([[1.0, -3.0], [2.5, 0.0], [-1.0, 4.0], [0.5, 1.0], [2.0, -2.0]])
CLOSED = np.append(KNOTS, KNOTS[0] + FULL_TURN), np.vstack([VALUES, VALUES[:1]])
AROUND = CubicSpline(*CLOSED, bc_type="periodic")
ALONG = CubicSpline(KNOTS, VALUES)

LAWS = {
    "over a turn": (Law(VALUES, KNOTS), AROUND),
    "over a travel": (Law(VALUES, KNOTS, periodic=False), lambda x: ALONG(np.clip(x, KNOTS[0], KNOTS[-1]))),
    "lines over a turn": (
        Law(VALUES, KNOTS, linear=True),
        lambda x: [np.interp(x, KNOTS, column, period=FULL_TURN) for column in VALUES.T],
    ),
}


@pytest.mark.parametrize("loop", ["pymunk_adapter.loop", "exudyn_adapter.loop", "mujoco_loop", "simbody_loop"])
@pytest.mark.parametrize("name", LAWS)
def test_a_load_at_an_angle_is_the_splines(loop, name):
    at = pytest.importorskip(f"engines.{loop}").law_values
    law, true = LAWS[name]
    plain = plain_law(law)
    for angle in (*np.linspace(-9.0, 9.0, 37).tolist(), *KNOTS.tolist()):
        assert at(plain, angle) == pytest.approx(np.asarray(true(angle)), abs=1e-12)
