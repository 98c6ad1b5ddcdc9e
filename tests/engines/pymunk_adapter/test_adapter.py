"""What pymunk alone has: bodies cut into parts, magnitudes of forces, impulses as read-outs, grooves that are wrong."""

import dataclasses

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.law import Law
from analytic.description.units import Kind
from analytic.kinematics.mechanism import Mechanism
from engines.contract import Setting
from engines.pymunk_adapter.adapter import PymunkEngine
from engines.scene import Channel
from engines.stepping.own_units import own_units
from tests.analytic.linkages import file_text, from_text, mechanism
from tests.engines.closed_form import driven, errors_of, history_of, run_of

pytest.importorskip("pymunk")
loop = pytest.importorskip("engines.pymunk_adapter.loop")

ENGINE = PymunkEngine()
TUNED = 5e-5  # of the peak: torque, joint forces and accelerations
SEEN = 1e-2  # of a joint force: what a world of another crank or without a load is off by

LIGHT = file_text("four-bar-without-inertia")


def _motion(regime="run-up-quintic", **changes):
    return crank_motion(regime, **{"ramp_time": 0.06, "hold_time": 0.02, "start_angle": 0.3, **changes})


def _errors(linkage, motion, setting=Setting.TUNED, engine=ENGINE):
    return errors_of(run_of(engine, linkage, motion, setting), linkage, motion)


def test_masses_with_small_inertias_are_no_trouble():
    assert max(_errors(from_text(LIGHT), _motion()).values()) < 10.0 * TUNED


def test_the_torque_is_the_motors_impulse_less_what_keeps_its_sign_and_nothing_else(monkeypatch):
    """A term of the adapter's own that grows with the motion would not be the engine's word."""
    seen, stepped = [], loop.take_steps
    monkeypatch.setattr(loop, "take_steps", lambda *given: seen.append((given, stepped(*given))) or seen[-1][1])
    model = driven(mechanism("juki-mf7923d"), _motion(), channels=frozenset({Channel.TORQUE}))
    torque = history_of(ENGINE, model).torque
    (((world, step, *_), (_, impulses, _)),) = seen
    expected = (world.given["offset"] - impulses[:, 0] / step) * own_units(model).unit(Kind.TORQUE)
    assert torque.values == pytest.approx(expected, rel=1e-12, abs=1e-15)


class _Another(PymunkEngine):
    """pymunk in a world of which the adapter knows nothing."""

    def altered(self, scene):
        bodies = tuple(dataclasses.replace(b, mass=2.0 * b.mass) if b.name == "crank" else b for b in scene.bodies)
        return dataclasses.replace(scene, bodies=bodies if not scene.forces else scene.bodies, forces=())


def test_a_crank_of_twice_its_mass_and_a_side_load_that_is_missing_are_seen_in_the_joint_forces():
    """Neither moves anything, nor takes a torque."""
    drawn, motion = mechanism("juki-mf7923d").linkage, _motion()
    balanced = dataclasses.replace(drawn.links["crank"], centre=(0.0, 0.0))
    plain = dataclasses.replace(drawn, links={**drawn.links, "crank": balanced})
    loaded = mechanism("force-over-angle").linkage.forces[0]
    load = dataclasses.replace(loaded, link="needle_bar", point="D", force=Law(np.array([20.0, 0.0])))
    for linkage, joint in ((plain, "O1"), (dataclasses.replace(plain, forces=(load,)), "needle_bar on ground")):
        closed = Mechanism(linkage)
        right, wrong = (_errors(closed, motion, engine=engine) for engine in (ENGINE, _Another()))
        assert max(right.values()) < TUNED
        assert wrong["torque"] < TUNED
        assert wrong[joint] > SEEN


def test_a_linkage_with_a_change_point_is_run_away_from_it():
    motion = _motion(speed=10.0)
    history = run_of(ENGINE, mechanism("parallelogram"), motion, Setting.TUNED)
    errors = errors_of(history, mechanism("parallelogram"), motion)
    assert max(errors[name] for name in ("torque", "position", "velocity", "acceleration")) < TUNED
