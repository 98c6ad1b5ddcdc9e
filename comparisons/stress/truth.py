"""Faults of a motion, by comparison with the closed form.

A motion is *wrong* where the position or velocity of any body, the crank's angle among them, the torque of a driven
crank or the force in a joint is off by more than ``WRONG`` of its scale, or where no samples cover as much of the
motion.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from comparisons.invariants.corrections import LEVELS
from comparisons.invariants.inspection import FAINT_FORCE
from comparisons.invariants.invariants import HALF_TURN
from comparisons.judging.jumps import near_jumps
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.case import Case
from comparisons.reference.channels import truth
from engines.contract import Signal
from engines.mechanics.joints import scene_size
from engines.scene import Channel, Scene

Array = NDArray[np.float64]

# Of the linkage's size (or rad), of the peak velocity, of the peak torque, of the duration.
WRONG = 1e-2


def wrongs(case: Case, motion: ObservedMotion) -> list[str]:
    """The faults of a motion, in words; empty for a right one."""
    return [words for size, words in _errors(case, motion) if not size <= WRONG]


def _errors(case: Case, motion: ObservedMotion) -> Iterator[tuple[float, str]]:
    for order, name in enumerate(("position", "velocity")):
        body, share, time = _state_error(case, motion, order)
        yield (
            share,
            f"{name} of {body} off by {share:.2g} of {('the size (or rad)', 'the peak')[order]} at {time:.3g} s",
        )
    if case.is_prescribed and motion.has(Channel.TORQUE):
        torque = motion.signal(Channel.TORQUE)
        yield from _off("torque", case, torque, case.at(torque.time).torque)
    forces = motion.history.joint_force if case.unbounded_at is None else {}
    truths = {joint: case.at(signal.time).joint_forces[joint].T for joint, signal in forces.items()}
    sizes = {joint: np.hypot(*true.T) for joint, true in truths.items()}
    truths = {joint: true if forces[joint].values.ndim > 1 else sizes[joint] for joint, true in truths.items()}
    faint = FAINT_FORCE * max((float(np.max(size)) for size in sizes.values()), default=0.0)
    for joint, true in truths.items():
        yield from _off(f"force in {joint}", case, forces[joint], true, faint)
    missing = _missing(case, motion)
    yield missing, f"{missing:.2g} of the duration has no samples"


def _off(name: str, case: Case, signal: Signal, true: Array, least: float = 0.0) -> Iterator[tuple[float, str]]:
    """Largest error of a torque or a force over its peak, ``least`` at least, away from jumps of the acceleration."""
    smooth = ~near_jumps(signal.time, case.motion)
    if smooth.any():
        away, size = (np.linalg.norm(v.reshape(len(v), -1)[smooth], axis=1) for v in (signal.values - true, true))
        error = away / (max(float(np.max(size)), least) or 1.0)
        worst = int(np.argmax(error))
        yield float(error[worst]), f"{name} off by {error[worst]:.2g} of its peak at {signal.time[smooth][worst]:.3g} s"


def _missing(case: Case, motion: ObservedMotion) -> float:
    """Share of the duration between samples that lie half a turn and more apart."""
    time = motion.signal(Channel.POSITION).time
    blind = np.abs(np.diff(case.motion.angle(time))) > HALF_TURN
    return float(np.sum(np.diff(time)[blind])) / case.motion.duration


def _state_error(case: Case, motion: ObservedMotion, order: int) -> tuple[str, float, float]:
    """The body that is furthest off in position (0) or velocity (1), by what share of the scale, and when."""
    signal = motion.signal(LEVELS[order])
    true = true_states(case, motion.scene, signal.time, order)
    unit = np.array([scene_size(motion.scene)] * 2 + [1.0])
    difference = (signal.values - true) / unit
    if order == 0:  # whole turns apart is the same place
        difference[:, :, 2] = np.angle(np.exp(1j * difference[:, :, 2]))
    difference[:, _without_angle(motion.scene), 2] = 0.0
    sizes = np.maximum(np.hypot(difference[..., 0], difference[..., 1]), np.abs(difference[..., 2]))
    scale = 1.0
    if order:
        peak = true / unit
        scale = float(np.max(np.maximum(np.hypot(peak[..., 0], peak[..., 1]), np.abs(peak[..., 2])))) or 1.0
    worst = np.unravel_index(int(np.argmax(sizes)), sizes.shape)
    return motion.scene.bodies[worst[1]].name, float(sizes[worst]) / scale, float(signal.time[worst[0]])


def _without_angle(scene: Scene) -> list[int]:
    """Bodies that are points: masses at a pin, whose angle means nothing."""
    guided = {slider.body for slider in scene.sliders}
    return [n for n, body in enumerate(scene.bodies) if body.inertia is None and body.name not in guided]


def true_states(case: Case, scene: Scene, time: Array, order: int) -> Array:
    """Positions or velocities of a scene's bodies by the closed form, (instants, bodies, 3)."""
    return np.stack([truth(case, LEVELS[order], body.name, time) for body in scene.bodies], axis=1)
