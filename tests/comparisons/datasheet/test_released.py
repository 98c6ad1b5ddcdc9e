"""The part of a data sheet about a released crank, against textbook motions and the motion itself."""

import numpy as np
import pytest

from analytic.description.loading import load
from comparisons.case import motion_of_file_regime
from comparisons.datasheet.building import describe_release, usual_sheet
from tests.analytic.linkages import from_text
from tests.analytic.textbook import PENDULUM, ROTOR

LAW = "\n[regimes.go]\ntorque = {torque}\nstart_angle = {angle}\nstart_speed = {speed}\nduration = 2\n"


def released_of(text, **law):
    mechanism = from_text(text + LAW.format(**law))
    own = mechanism.linkage.released["go"]
    motion = motion_of_file_regime(mechanism, own)
    return describe_release(mechanism, own, motion), motion


def test_a_pendulum_rests_where_it_hangs_and_where_it_stands():
    found, motion = released_of(PENDULUM, torque=0, angle=-1.2, speed=0)
    assert [(round(rest["angle"] % (2 * np.pi), 9), rest["stable"]) for rest in found.facts["rests"]] == [
        (round(np.pi / 2, 9), False),
        (round(3 * np.pi / 2, 9), True),
    ]
    assert [found.facts[name] for name in ("ending", "settled", "over")] == [None, None, ""]
    assert not found.last_turn
    assert found.motion["phi"].min() == pytest.approx(float(np.min(motion.angle(np.linspace(0, 2, 9999)))), abs=1e-5)


def test_a_damped_rotor_settles_at_torque_over_damping():
    found, _ = released_of(ROTOR, torque=5, angle=0, speed=99)
    assert found.facts["damping"] == pytest.approx(0.05)
    assert found.facts["settled"]["mean_speed_over_angle"] == pytest.approx(5 / 0.05)
    assert found.facts["ending"]["mean_speed"] == pytest.approx(100.0, rel=0.01)
    assert np.all(np.diff(found.last_turn["phi"]) >= 0.0)


def test_a_sheet_has_the_requested_regimes_alone():
    sheet = usual_sheet(load("slotted-takeup"), regimes=("free", "run-up"))
    assert list(sheet.released) == ["free"]
    assert not usual_sheet(load("slotted-takeup")).released
