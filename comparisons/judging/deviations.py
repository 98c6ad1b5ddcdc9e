"""How far an engine's signal is from the truth, relative to the truth's peak."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import CrankMotion, Segment
from comparisons.judging.quantities import Quantity
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.case import Case
from engines.contract import Signal
from engines.scene import Channel

Array = NDArray[np.float64]

# Steps on either side of an acceleration jump within which a sample may lie between the two values of the truth there.
JUMP_STEPS = 2.0


class NoSampleError(ValueError):
    """Not one sample of a run says anything of a quantity."""


@dataclass(frozen=True)
class Deviation:
    """One quantity of one run against the truth; errors are relative to the truth's peak over the run.

    ``angle`` is the true crank angle at every sample, rad. ``observed`` and ``reference`` of a vector are its
    magnitudes; its errors are those of the vector. ``error_at_jumps`` is the largest distance of a sample at a jump
    from the range of the truth around it.
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
    error_at_jumps: float = 0.0


def deviation(case: Case, quantity: Quantity, motion: ObservedMotion) -> Deviation:
    """Compare one quantity over every sample the engine returned.

    Samples of accelerations and torques within two steps of an acceleration jump are left out and counted, as are
    those of Jeq near standstill: at a jump an engine may give any value between the two, and none beyond. Raises
    NoSampleError where none is left.
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
    # What is interpolated from another clock across a jump is the suite's own error.
    is_judged_at_jumps = quantity.holds_acceleration and all(
        np.array_equal(motion.signal(channel).time, signal.time) for channel in quantity.also
    )
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
        error_at_jumps=_beyond_jumps(case, quantity, signal, reference) / scale if is_judged_at_jumps else 0.0,
    )


def _beyond_jumps(case: Case, quantity: Quantity, signal: Signal, reference: Array) -> float:
    """Largest distance of a sample at an acceleration jump from the range of the truth in the samples around it."""
    worst = 0.0
    for jump in case.motion.jumps:
        near = near_jumps(signal.time, (jump,))
        if near.any():
            truth = np.concatenate([reference[near], *_sides(case, quantity, jump)])
            below, above = np.min(truth, axis=0) - signal.values[near], signal.values[near] - np.max(truth, axis=0)
            worst = max(worst, float(np.max(_size(np.maximum(np.maximum(below, above), 0.0)))))
    return worst


def _sides(case: Case, quantity: Quantity, jump: float) -> tuple[Array, Array]:
    """The truth just before and just after a jump, (1, ...) each; before the start the crank is at rest."""
    driven = Case(case.mechanism, case.motion)  # whose few instants push none of the case's own clocks out
    after = quantity.reference(driven, np.array([jump]))
    if jump > 0.0:
        return quantity.reference(driven, np.array([np.nextafter(jump, 0.0)])), after
    rest = Segment(0.0, case.motion.duration, (float(case.motion.angle(0.0)),))
    resting = Case(case.mechanism, CrankMotion(case.motion.regime, (rest,)))
    return quantity.reference(resting, np.array([jump])), after


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
