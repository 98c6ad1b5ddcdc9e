"""An engine's run of a linkage beside the closed form: what the tests of every adapter look at."""

from __future__ import annotations

import dataclasses

import numpy as np

from analytic.description.crank_motion import CrankMotion
from analytic.kinematics.mechanism import Mechanism
from comparisons.judging.jumps import near_jumps
from comparisons.reference.case import Truth
from comparisons.reference.start_state import scene
from engines.contract import Engine, History, Outcome, Setting
from engines.scene import Channel, Prescribed


def run_of(engine: Engine, linkage: Mechanism, motion: CrankMotion, setting: Setting, **changes: object) -> History:
    """The history of all channels; ``changes`` are fields of the scene given otherwise."""
    given = dataclasses.replace(scene(linkage, Prescribed(motion), frozenset(Channel)), **changes)  # type: ignore[arg-type]
    run = engine.run(given, setting)
    assert run.outcome is Outcome.FINISHED, run.reason
    assert run.history is not None
    return run.history


def error_of(values: np.ndarray, truth: np.ndarray, kept: np.ndarray | slice = slice(None)) -> float:
    """Largest error of the samples kept over the truth's peak among them."""
    return float(np.abs(values - truth)[kept].max() / np.abs(truth)[kept].max())


def errors_of(history: History, linkage: Mechanism, motion: CrankMotion) -> dict[str, float]:
    """Of torque and every joint's force, away from jumps, and of every body's place and velocity.

    A joint that the history or the closed form lacks fails.
    """
    assert history.position is not None
    assert history.velocity is not None
    assert history.torque is not None
    truth = Truth(linkage, motion, history.torque.time)
    kept = ~near_jumps(truth.time, motion)
    errors = {"torque": error_of(history.torque.values, truth.torque, kept)}
    for joint, signal in history.joint_force.items():
        errors[joint] = error_of(signal.values, truth.joint_forces[joint].T, kept)
    for number, body in enumerate(linkage.linkage.links):
        place, velocity = (np.stack(np.broadcast_arrays(*truth.sweep.centre(body, order)), axis=-1) for order in (0, 1))
        errors[f"place of {body}"] = error_of(history.position.values[:, number, :2], place)
        errors[f"velocity of {body}"] = error_of(
            history.velocity.values[:, number, :2], velocity * truth.speed[:, None]
        )
    assert set(history.joint_force) == set(truth.joint_forces)
    return errors
