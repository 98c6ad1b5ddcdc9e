"""DART: read-outs of their own instants, what one run leaves to the next, and a name that its package takes."""

import dataclasses

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from engines.contract import Setting
from engines.dart_adapter import DartEngine
from engines.scene import Prescribed
from tests.analytic.linkages import mechanism
from tests.engines.closed_form import errors_of, run_of

SHORT = crank_motion("run-up-quintic", ramp_time=0.06, hold_time=0.01, start_angle=0.3)


@pytest.fixture(autouse=True)
def dart():
    pytest.importorskip("dartpy")


def run(setting=Setting.TUNED, linkage="fork-takeup", **recipe):
    engine = DartEngine()
    changed = dataclasses.replace(engine.settings[Prescribed][setting], **recipe)
    engine.settings = {Prescribed: {setting: changed}}
    return run_of(engine, mechanism(linkage), SHORT, setting)


@pytest.mark.parametrize("linkage", ["fork-takeup", "slotted-takeup", "carried-slider"])
def test_every_read_out_belongs_to_its_instant(linkage):
    """The error falls with the square of the step; torque, forces or speeds of half a step away would make it half."""
    coarse, fine = (errors_of(run(linkage=linkage, ratios=(n,)), mechanism(linkage), SHORT) for n in (10, 20))
    assert {name: coarse[name] / fine[name] for name in coarse} == {
        name: pytest.approx(4.0, rel=0.1) for name in coarse
    }


def test_a_run_with_what_dart_ships_leaves_nothing_to_the_next():
    """A constraint's error reduction holds for all of the process."""
    first, _, again = run(ratios=(5,)), run(Setting.NAIVE), run(ratios=(5,))
    np.testing.assert_array_equal(first.torque.values, again.torque.values)
    naive, _, repeated = run(Setting.NAIVE), run(ratios=(5,)), run(Setting.NAIVE)
    np.testing.assert_array_equal(naive.torque.values, repeated.torque.values)
