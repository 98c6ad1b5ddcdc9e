"""MJX, many equal worlds at once on the device that JAX has: the errors of one world, and steps per second of all.

``python -m docs.making.mjx_batch mine.toml f32|f64 STEPS_PER_TURN WORLDS``; it needs the engine ``mjx``.
"""

from __future__ import annotations

import sys
import time
from dataclasses import replace

import jax
import numpy as np

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Truth, scene
from engines.mujoco_variants.adapter import MjxEngine
from engines.mujoco_variants.mjx_loop import build, stepped
from engines.scene import Channel, Prescribed
from engines.stepping.own_units import own_units, scaled
from engines.stepping.stepped_engine import plain

TURN, CHUNK, REPEATS = 0.06, 60, 3  # s at 1000 rpm; steps of one call; calls that are timed


def main(linkage: str, precision: str, steps: int, worlds: int) -> None:
    """Print the errors of one turn at constant speed, over the peak, then the throughput of ``worlds``."""
    mechanism, motion = Mechanism(load(linkage)), crank_motion("constant-speed", ramp_time=TURN, hold_time=0.0)
    given, engine = scene(mechanism, Prescribed(motion), frozenset(Channel)), MjxEngine()
    (method,) = (each for each in engine.methods(given) if each.name == precision)
    history = engine.run_method(given, method, TURN / steps).history
    assert history is not None, "the run has not finished"
    assert history.torque is not None
    true = Truth(mechanism, motion, history.torque.time)
    off = {"torque": _error(history.torque.values, true.torque)}
    off |= {name: _error(force.values, true.joint_forces[name].T) for name, force in history.joint_force.items()}
    print(f"{precision}, {steps} steps a turn: " + ", ".join(f"{name} {error:.1e}" for name, error in off.items()))

    recipe = replace(engine.studied_recipe(method, TURN / steps), ratios=(CHUNK,))
    world = build(plain(engine.model(scaled(given, own_units(given)), recipe)))
    with jax.enable_x64(precision == "f64"):
        batch = jax.tree.map(lambda value: jax.numpy.broadcast_to(value, (worlds, *value.shape)), world.state)
        many = jax.jit(jax.vmap(stepped, in_axes=(None, 0, None)))
        clock, seconds = np.zeros((CHUNK, 3)), []
        for _ in range(1 + REPEATS):  # the first compiles
            begun = time.perf_counter()
            jax.block_until_ready(many(world.other, batch, clock))
            seconds.append(time.perf_counter() - begun)
    rate = worlds * CHUNK / min(seconds[1:]) / 1e6
    print(f"{worlds} worlds: {rate:.2f} million steps a second on {world.device}, compiled in {seconds[0]:.0f} s")


def _error(values: np.ndarray, true: np.ndarray) -> float:
    size = np.linalg.norm(np.reshape(true, (len(true), -1)), axis=1).max()
    return float(np.linalg.norm(np.reshape(values - true, (len(true), -1)), axis=1).max() / size)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4]))
