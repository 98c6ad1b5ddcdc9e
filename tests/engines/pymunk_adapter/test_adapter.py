"""What pymunk alone has: bodies cut into parts, magnitudes of forces, impulses as read-outs, grooves that are wrong."""

import dataclasses

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.law import Law
from analytic.description.units import Kind
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import scene
from engines.contract import Setting
from engines.mechanics.states import pose_of, with_ground
from engines.pymunk_adapter import adapter
from engines.pymunk_adapter.adapter import PymunkEngine, contraction
from engines.pymunk_adapter.layout import exact_layout, plain_layout
from engines.scene import Channel, Prescribed
from engines.stepping.own_units import own_units
from tests.analytic.linkages import file_text, from_text, mechanism
from tests.engines.closed_form import driven, errors_of, history_of, run_of

pytest.importorskip("pymunk")
loop = pytest.importorskip("engines.pymunk_adapter.loop")

ENGINE = PymunkEngine()
TUNED = 5e-5  # of the peak: torque, joint forces and accelerations
WRONG_GROOVE = 1e-4  # what a groove off the mass centre's line does to velocities at any step
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


def test_a_groove_that_is_not_cut_free_gives_a_wrong_velocity(monkeypatch):
    monkeypatch.setattr(adapter, "exact_layout", plain_layout)
    assert _errors(mechanism("ground-pin-in-slot"), _motion())["velocity"] > WRONG_GROOVE


def test_a_naive_run_has_pymunks_defaults_and_the_torques_size_alone():
    model = driven(mechanism("juki-mf7923d"), _motion(hold_time=0.01))
    run = ENGINE.run(model, Setting.NAIVE)
    assert (run.steps, run.details["iterations"]) == (700, 10)
    assert len(run.history.acceleration.time) == run.steps
    assert np.all(run.history.torque.values >= 0.0)


def test_no_buffer_is_made_for_a_run(monkeypatch):
    """For pymunk never frees one."""
    monkeypatch.delattr("pymunk.batch.Buffer")
    assert run_of(ENGINE, mechanism("juki-mf7923d"), _motion(ramp_time=0.01), Setting.BEST).torque is not None


def test_a_linkage_with_a_change_point_is_run_away_from_it():
    motion = _motion(speed=10.0)
    history = run_of(ENGINE, mechanism("parallelogram"), motion, Setting.TUNED)
    errors = errors_of(history, mechanism("parallelogram"), motion)
    assert max(errors[name] for name in ("torque", "position", "velocity", "acceleration")) < TUNED


FORESEEN = 0.05  # relative error of the foreseen convergence


def _scene(name, **changes):
    return scene(mechanism(name), Prescribed(crank_motion(start_angle=0.3, **changes)), frozenset(Channel))


@pytest.mark.parametrize("name", ["fork-takeup", "slotted-takeup", "rimoldi-164"])
def test_the_solver_converges_as_foreseen(name, monkeypatch):
    layout = exact_layout(_scene(name))
    left = []
    for iterations in (60, 80):
        world = PymunkEngine().build(_scene(name), dataclasses.replace(adapter.TUNED, effort=iterations))
        monkeypatch.setattr(loop, "COLD", 1)
        (seen,), *_ = loop.take_steps(world, 1e-3, np.full(2, 60.0), tuple(map(np.array, ([0, 1], [1], []))), [])
        seen = seen[:-1]
        equations = layout.equations
        state, rate = (with_ground(seen[None, :, order]) / equations.metres for order in (0, 1))
        rows = equations.jacobian(equations.arms(pose_of(state)))[0]
        residual = rows @ equations.gather(rate)[0]
        left.append(np.abs(residual[: equations.crank_row]).max())
    observed = (left[1] / left[0]) ** (1.0 / 20.0)
    assert observed == pytest.approx(contraction(layout, pose_of(state)), rel=FORESEEN)
