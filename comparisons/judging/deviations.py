"""How far an engine's signal is from the truth, relative to the truth's peak."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from comparisons.judging.quantities import Quantity
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.case import Case
from engines.scene import Channel

Array = NDArray[np.float64]

# Steps on either side of an acceleration jump within which a sample says nothing: the truth has two values there.
JUMP_STEPS = 2.0


class NoSampleError(ValueError):
    """Not one sample of a run says anything of a quantity."""


@dataclass(frozen=True)
class Deviation:
    """One quantity of one run against the truth; errors are relative to the truth's peak over the run.

    ``angle`` is the true crank angle at every sample, rad. ``observed`` and ``reference`` of a vector are its
    magnitudes; its errors are those of the vector.
    """

    time: Array
    angle: Array
    observed: Array
    reference: Array
    peak: float
    error_max: float
    error_rms: float
    worst_time: float
    samples: int
    left_out: int


def deviation(case: Case, quantity: Quantity, motion: ObservedMotion) -> Deviation:
    """Compare one quantity over every sample the engine returned.

    Samples of accelerations and torques within two steps of an acceleration jump are left out and counted, as are
    those of Jeq near standstill. Raises NoSampleError where none is left.
    """
    signal = quantity.observed(case, motion)
    kept = np.ones(len(signal.time), dtype=bool)
    if quantity.holds_acceleration:
        kept &= ~near_jumps(signal.time, case.motion.jumps)
    if not kept.any():
        raise NoSampleError(
            f"every sample of {quantity.name} lies at an acceleration jump or near standstill: run it for longer"
        )
    reference = quantity.reference(case, signal.time)
    difference = _size(signal.values - reference)[kept]
    peak = float(np.max(_size(reference)[kept]))
    scale = peak or 1.0
    worst = int(np.argmax(difference))
    return Deviation(
        time=signal.time,
        angle=case.motion.angle(signal.time),
        observed=signal.values if signal.values.ndim == 1 else _size(signal.values),
        reference=reference if reference.ndim == 1 else _size(reference),
        peak=peak,
        error_max=float(difference[worst] / scale),
        error_rms=float(np.sqrt(np.mean(difference**2)) / scale),
        worst_time=float(signal.time[kept][worst]),
        samples=len(difference),
        left_out=len(_clock(quantity, motion)) - len(difference),
    )


def near_jumps(time: Array, jumps: tuple[float, ...]) -> NDArray[np.bool_]:
    """Samples within two steps of an acceleration jump, by the clock's own step on that side of it.

    A sample missing on the jump itself does not widen the step.
    """
    gaps = np.diff(time)
    step = np.minimum(np.append(gaps, gaps[-1]), np.insert(gaps, 0, gaps[0]))
    near = np.zeros(len(time), dtype=bool)
    for jump in jumps:
        near |= np.abs(time - jump) <= JUMP_STEPS * step * (1.0 + 1e-9)
    return near


def _size(values: Array) -> Array:
    """Magnitude of every sample: of a number, or of a vector along the last axis."""
    return np.abs(values) if values.ndim == 1 else np.asarray(np.hypot(*values.T))


def _clock(quantity: Quantity, motion: ObservedMotion) -> Array:
    """Times at which the engine has samples of a quantity, those left out included."""
    if quantity.clock is Channel.JOINT_FORCE:
        return next(iter(motion.history.joint_force.values())).time
    return motion.signal(quantity.clock).time
