"""DART: what one run leaves to the next, beside what tests/engines/test_adapters.py holds of every engine."""

import dataclasses

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from engines.contract import Setting
from engines.dart_adapter import DartEngine
from engines.scene import Prescribed
from tests.analytic.linkages import mechanism
from tests.engines.closed_form import run_of

SHORT = crank_motion("run-up-quintic", ramp_time=0.06, hold_time=0.01, start_angle=0.3)


@pytest.fixture(autouse=True)
def dart():
    pytest.importorskip("dartpy")


def torque(setting=Setting.TUNED, **recipe):
    engine = DartEngine()
    engine.settings = {Prescribed: {setting: dataclasses.replace(engine.settings[Prescribed][setting], **recipe)}}
    return run_of(engine, mechanism("fork-takeup"), SHORT, setting).torque.values


def test_a_run_with_what_dart_ships_leaves_nothing_to_the_next():
    """A constraint's error reduction holds for all of the process."""
    first, naive, again, repeated = (torque(**given) for given in 2 * [{"ratios": (5,)}, {"setting": Setting.NAIVE}])
    np.testing.assert_array_equal(first, again)
    np.testing.assert_array_equal(naive, repeated)
