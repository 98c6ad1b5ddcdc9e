"""Deviations of an engine's signals from the truth, relative to the truth's peak."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import CrankMotion, Segment, degrees
from comparisons.judging.quantities import Quantity
from comparisons.observed_motion import ObservedMotion
from comparisons.reference.case import Case
from comparisons.reference.motion import Motion
from engines.contract import Signal
from engines.scene import Channel

Array = NDArray[np.float64]

# Which samples lie at a jump of the driver's acceleration: one rule for all who judge or draw them.


WINDOW: Final = 1e-2  # of the shortest time between two jumps, the start and the end: half of the window at a jump
ROUNDING: Final = 1e-9  # of the half window


def near_jumps(time: Array, motion: Motion) -> NDArray[np.bool_]:
    """Which of the times (n,), s, lie in the window at any jump of a motion's acceleration; nowhere without a jump.

    There accelerations, torques and forces have two true values. The window belongs to the motion: it is as wide for
    long steps of an engine or a file as for short ones.
    """
    near = np.zeros(len(time), dtype=bool)
    for jump in motion.jumps:
        near |= near_jump(time, motion, jump)
    return near


def near_jump(time: Array, motion: Motion, jump: float) -> NDArray[np.bool_]:
    """Which of the times (n,), s, lie in the window at one of the motion's jumps, s."""
    pieces = np.diff(np.unique([0.0, *motion.jumps, motion.duration]))
    half = WINDOW * float(np.min(pieces, initial=motion.duration))
    return np.asarray(np.abs(time - jump) <= half * (1.0 + ROUNDING))


UNBOUNDED = "joint forces have no bound where the linkage passes its change point at {angle}"


class NoSampleError(ValueError):
    """No sample of a run allows a comparison of a quantity."""


@dataclass(frozen=True)
class Deviation:
    """One quantity of one run against the truth; errors are relative to the truth's peak over the run.

    ``angle`` is the true crank angle at every sample, rad. ``observed`` and ``reference`` of a vector are its
    magnitudes; its errors are those of the vector where the engine tells vectors. ``error_at_jumps`` is by how much the
    largest error of a sample at a jump is over the size of the jump.
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

    @property
    def curve(self) -> Array:
        """The samples as a run's record has them (``comparisons.judging.records.CURVE``), (4, samples)."""
        return np.array([self.time, self.angle, self.observed, self.reference])


def deviation(case: Case, quantity: Quantity, motion: ObservedMotion) -> Deviation:
    """Compare one quantity over every sample the engine returned.

    Samples of accelerations and torques at an acceleration jump (``near_jumps``) have a bound of their own:
    there an engine may be off by the jump besides. Samples of Jeq near standstill are left out and counted. A vector
    of which the engine tells the magnitude is compared as a magnitude. Raises NoSampleError where no sample is left.
    """
    if quantity.name.startswith("joint_force:") and case.unbounded_at is not None:
        raise NoSampleError(UNBOUNDED.format(angle=degrees(case.unbounded_at)))
    if quantity.needs_thread and (reason := quantity.undefined(case)):
        raise NoSampleError(reason)
    return signal_deviation(case, quantity, quantity.observed(case, motion), len(_sample_times(quantity, motion)))


def signal_deviation(case: Case, quantity: Quantity, signal: Signal, clock: int) -> Deviation:
    """Compare a signal that was read from an engine's motion; ``clock`` counts the engine's samples of it.

    Raises NoSampleError where no sample is left.
    """
    counted = np.ones(len(signal.time), dtype=bool)
    if quantity.holds_acceleration:
        counted &= ~near_jumps(signal.time, case.motion)
    if not counted.any():
        raise NoSampleError(
            f"every sample of {quantity.name} lies at an acceleration jump or near standstill: run it for longer"
        )
    reference = quantity.reference(case, signal.time)
    if signal.values.ndim < reference.ndim:
        reference = _magnitudes(reference)
    difference = _magnitudes(signal.values - reference)[counted]
    peak = float(np.max(_magnitudes(reference)[counted]))
    if peak == 0.0 and case.mechanism.linkage.is_massless:
        raise NoSampleError(f"{quantity.name} is zero throughout, as no link has a mass: its error has no scale")
    scale = peak or 1.0
    worst = int(np.argmax(difference))
    return Deviation(
        time=signal.time,
        angle=case.motion.angle(signal.time),
        observed=signal.values if signal.values.ndim == 1 else _magnitudes(signal.values),
        reference=reference if reference.ndim == 1 else _magnitudes(reference),
        peak=peak,
        error_max=float(difference[worst] / scale),
        error_rms=float(np.sqrt(np.mean(difference**2)) / scale),
        worst_time=float(signal.time[counted][worst]),
        samples=len(difference),
        left_out=clock - len(difference),
        error_at_jumps=_error_at_jumps(case, quantity, signal, reference) / scale,
    )


def _error_at_jumps(case: Case, quantity: Quantity, signal: Signal, reference: Array) -> float:
    """By how much the largest error of a sample at an acceleration jump is over the size of the jump."""
    worst = 0.0
    for jump in case.motion.jumps if quantity.holds_acceleration else ():
        near = near_jump(signal.time, case.motion, jump)
        if near.any():
            before, after = _truth_beside_jump(case, quantity, jump)
            error = _magnitudes(signal.values[near] - reference[near])
            worst = max(worst, float(np.max(error - _magnitudes(after - before))))
    return worst


def _truth_beside_jump(case: Case, quantity: Quantity, jump: float) -> tuple[Array, Array]:
    """The truth just before and just after a jump, (1, ...) each; before the start the crank is at rest."""
    driven = Case(case.mechanism, case.motion)  # a new case: a case stores the truth of few clocks only
    after = quantity.reference(driven, np.array([jump]))
    if jump > 0.0:
        return quantity.reference(driven, np.array([np.nextafter(jump, 0.0)])), after
    rest = Segment(0.0, case.motion.duration, (float(case.motion.angle(0.0)),))
    resting = Case(case.mechanism, CrankMotion(case.motion.regime, (rest,)))
    return quantity.reference(resting, np.array([jump])), after


def _magnitudes(values: Array) -> Array:
    """Magnitude of every sample: of a number, or of a vector along the last axis."""
    return np.abs(values) if values.ndim == 1 else np.asarray(np.hypot(*values.T))


def _sample_times(quantity: Quantity, motion: ObservedMotion) -> Array:
    """Times at which the engine has samples of a quantity, those left out included."""
    if quantity.clock is Channel.JOINT_FORCE:
        return next(iter(motion.history.joint_force.values())).time
    return motion.signal(quantity.clock).time
