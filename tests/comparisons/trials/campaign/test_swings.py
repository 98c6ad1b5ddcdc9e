"""Swings, torques over time or angle, and cylinders: engines within their limits, and refusals with the reach."""

from pathlib import Path

import pytest

from analytic.errors import AssemblyError
from comparisons.trials.campaign.campaign import compare
from comparisons.trials.judging.records import Verdict
from comparisons.trials.runs.workers import LocalPool
from engines.contract import Outcome
from engines.registry import engine, own_names, why_unavailable
from reports.api.campaign import request
from reports.api.options import CompareOptions
from tests.analytic.swinging import double_rocker_text

REGIMES = """
[regimes.rocking]
from = 65
to = -10
time = 0.3
law = "cycloidal"
back = true
dwell = 0.1

[regimes.servo]
time  = [0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3]
angle = [40, 41, 45, 52, 59, 63, 64]
"""
LINKAGES = Path(__file__).parents[3] / "linkages"
OTHERS = [name for name in own_names() if name != "direct" and why_unavailable(engine(name)) is None]
ENGINES = ["direct", *(pytest.param(name, marks=pytest.mark.nightly) for name in OTHERS)]


@pytest.fixture
def rocker(tmp_path):
    path = tmp_path / "rocker.toml"
    path.write_text(double_rocker_text(regimes=REGIMES))
    return str(path)


@pytest.mark.parametrize("name", ENGINES)
def test_a_rocker_that_cannot_turn_swings_within_the_limits(rocker, name):
    choice = CompareOptions(mechanisms=(rocker,), engine=(name,), regime=("rocking", "servo"))
    results = list(compare(request(choice), pool=LocalPool(0)))
    assert [result.regime for result in results] == ["rocking", "servo"]
    for result in results:
        verdicts = {record.quantity: record.outcome for record in (*result.errors, *result.invariants)}
        assert {verdicts[quantity] for quantity in ("S", "v", "a", "Mkr", "Jeq")} == {Verdict.PASSED}
        assert not set(verdicts.values()) & {Outcome.DIVERGED, Verdict.OVER_LIMIT}
        shared = {record.quantity: record.shared for record in result.errors}
        assert shared["S"] == ""


RELEASED = """
[regimes.timed]
torque = [0.0, 1.0, -1.0]
time = [0.004, 0.008, 0.016]
start_angle = 30
duration = 0.02

[regimes.angled]
torque = [1.5, 2.5, 1.0]
angle = [-60, 0, 60]
start_angle = 30
duration = 0.02
"""


@pytest.mark.parametrize("name", ENGINES)
def test_a_torque_over_time_or_angle_moves_every_engine_that_takes_it(tmp_path, name):
    path = tmp_path / "rocker.toml"
    path.write_text(double_rocker_text(regimes=RELEASED))
    choice = CompareOptions(
        mechanisms=(str(path),), engine=(name,), regime=("own",), quantity=("phi", "omega", "S", "a")
    )
    for result in compare(request(choice), pool=LocalPool(0)):
        outcomes = {record.outcome for record in result.errors}
        if outcomes == {Verdict.UNSUPPORTED}:
            assert result.regime == "angled" or not engine(name).abilities.timed_torque
        else:
            assert outcomes == {Verdict.PASSED}


LINEAR = """
[regimes.lift]
from = 260
to = 500
speed = 800
law = "modified-sine"
back = true

[regimes.too-far]
from = 260
to = 600
time = 1
"""


def test_a_cylinder_follows_a_law_in_millimetres(tmp_path):
    path = tmp_path / "boom.toml"
    path.write_text((LINKAGES / "drives" / "boom.toml").read_text() + LINEAR)
    choice = CompareOptions(mechanisms=(str(path),), engine=("direct",), regime=("lift",))
    (lift,) = compare(request(choice), pool=LocalPool(0))
    assert lift.conditions.startswith("modified-sine from 260 mm to 500 mm and back, at most 800 mm/s, gravity on")
    assert {record.outcome for record in (*lift.errors, *lift.invariants)} == {Verdict.PASSED}
    too_far = CompareOptions(mechanisms=(str(path),), engine=("direct",), regime=("too-far",))
    with pytest.raises(AssemblyError, match="its drive reaches 232 mm to 572 mm"):
        list(compare(request(too_far), pool=LocalPool(0)))
