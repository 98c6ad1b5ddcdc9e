"""An engine's run of a linkage beside the closed form: what the tests of every adapter share."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from analytic.description.crank_motion import CrankMotion
from analytic.dynamics.released import free_motion
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Truth, scene
from comparisons.trials.judging.quantities import near_jumps
from engines.contract import Engine, History, Outcome, Setting
from engines.registry import engine
from engines.scene import Channel, Free, Prescribed, Scene

EVERYTHING = frozenset(Channel)
STATES = ("position", "velocity", "acceleration")


def installed(name: str) -> Engine:
    """The adapter of that name; the test is skipped where its engine is not installed."""
    adapter = engine(name)
    if adapter.version() is None:
        pytest.skip(f"{name} is not installed: make nightly-engines ENGINES={name} runs its tests")
    return adapter


def driven(linkage: Mechanism, motion: CrankMotion, channels: frozenset[Channel] = EVERYTHING, **changes) -> Scene:
    """The scene of a prescribed motion; ``changes`` are fields of the scene given otherwise."""
    return dataclasses.replace(scene(linkage, Prescribed(motion), channels), **changes)


def history_of(engine: Engine, model: Scene, setting: Setting = Setting.TUNED) -> History:
    """The history of a run that finishes."""
    run = engine.run(model, setting)
    assert run.outcome is Outcome.FINISHED, run.reason
    assert run.history is not None
    return run.history


def run_of(engine: Engine, linkage: Mechanism, motion: CrankMotion, setting: Setting, **changes: object) -> History:
    """The history of all channels under a prescribed motion; ``changes`` as in ``driven``."""
    return history_of(engine, driven(linkage, motion, **changes), setting)


def with_body(model: Scene, name: str, **changes: object) -> Scene:
    """The scene with one body changed."""
    bodies = (dataclasses.replace(body, **changes) if body.name == name else body for body in model.bodies)
    return dataclasses.replace(model, bodies=tuple(bodies))


def crank_number(model: Scene) -> int:
    """Place of the crank among the bodies."""
    return [body.name for body in model.bodies].index(model.crank)


def true_motion(linkage: Mechanism, motion: CrankMotion, time: np.ndarray) -> tuple[np.ndarray, ...]:
    """Position, velocity and acceleration (n, bodies, 3) at instants (n,), bodies in a scene's order."""
    sweep, speed, second = linkage.sweep(motion.angle(time)), motion.speed(time), motion.acceleration(time)
    orders = []
    for order in range(3):
        angles = [sweep.angles, lambda n: sweep.rates(n)[2], lambda n: sweep.accelerations(n)[2]][order]
        rows = [(*sweep.centre(name, order), angles(name)) for name in linkage.linkage.links]
        full = [[np.broadcast_to(part, time.shape) for part in row] for row in rows]
        orders.append(np.moveaxis(np.array(full, dtype=float), -1, 0))
    omega, epsilon = speed[:, None, None], second[:, None, None]
    return orders[0], orders[1] * omega, orders[2] * omega**2 + orders[1] * epsilon


def released(linkage: Mechanism, torque: float, start: float, duration: float, speed: float = 0.0):
    """The scene of a crank that is let go, and its true motion."""
    motion = free_motion(linkage, torque=torque, start_angle=start, start_speed=speed, duration=duration)
    pace = float(np.abs(motion.speed(np.linspace(0.0, duration, 101))).max())
    return scene(linkage, Free(torque, duration, pace), EVERYTHING, start_angle=start, speed=speed), motion


def error_of(values: np.ndarray, truth: np.ndarray, chosen: np.ndarray | slice = slice(None)) -> float:
    """Largest error of the chosen samples over the truth's peak among them."""
    return float(np.abs(values - truth)[chosen].max() / (np.abs(truth)[chosen].max() or 1.0))


def torque_error(history: History, linkage: Mechanism, motion: CrankMotion, after: float = -1.0) -> float:
    """Error of the drive's torque after an instant, s, away from jumps of the acceleration."""
    assert history.torque is not None
    time = history.torque.time
    smooth = ~near_jumps(time, motion) & (time > after)
    return error_of(history.torque.values, Truth(linkage, motion, time).torque, smooth)


def errors_of(history: History, linkage: Mechanism, motion: CrankMotion) -> dict[str, float]:
    """Errors over the peak, away from jumps: of places and angles in every order, the torque, every joint's force.

    A joint that the history or the closed form lacks fails. Bodies that cannot turn have no angle of their own.
    """
    turning = [body.inertia is not None for body in driven(linkage, motion).bodies]
    errors = {"torque": torque_error(history, linkage, motion)}
    for order, name in enumerate(STATES):
        signal = getattr(history, name)
        smooth, true = ~near_jumps(signal.time, motion), true_motion(linkage, motion, signal.time)[order]
        errors[name] = error_of(signal.values[..., :2], true[..., :2], smooth)
        errors[f"angular {name}"] = error_of(signal.values[:, turning, 2], true[:, turning, 2], smooth)
    forces = Truth(linkage, motion, history.torque.time).joint_forces
    assert set(history.joint_force) == set(forces)
    faint = 1e-6 * max(float(np.abs(force).max()) for force in forces.values())
    for joint, signal in history.joint_force.items():
        true = Truth(linkage, motion, signal.time).joint_forces[joint].T
        true = np.hypot(*true.T) if signal.values.ndim == 1 else true  # an engine may give magnitudes alone
        smooth = ~near_jumps(signal.time, motion)
        errors[joint] = float(np.abs(signal.values - true)[smooth].max() / max(faint, float(np.abs(true).max())))
    return errors
