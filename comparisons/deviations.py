"""How far an engine's signal is from the truth, relative to the truth's peak."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from comparisons.motion import ObservedMotion
from comparisons.quantities import Case, Quantity

Array = NDArray[np.float64]

# Steps on either side of an acceleration jump within which a sample says nothing: the truth has two values there.
JUMP_STEPS = 2.0


@dataclass(frozen=True)
class Deviation:
    """One quantity of one run against the truth; errors are relative to the truth's peak over the run."""

    time: Array
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
    those of Jeq near standstill.
    """
    signal = quantity.observed(case, motion)
    total = _clock_length(quantity, motion)
    reference = quantity.reference(case, signal.time)
    kept = np.ones(len(signal.time), dtype=bool)
    if quantity.holds_acceleration:
        kept &= ~near_jumps(signal.time, case.motion.jumps)
    difference = (signal.values - reference)[kept]
    peak = float(np.max(np.abs(reference[kept])))
    scale = peak or 1.0
    worst = int(np.argmax(np.abs(difference)))
    return Deviation(
        time=signal.time,
        observed=signal.values,
        reference=reference,
        peak=peak,
        error_max=float(np.abs(difference[worst]) / scale),
        error_rms=float(np.sqrt(np.mean(difference**2)) / scale),
        worst_time=float(signal.time[kept][worst]),
        samples=len(difference),
        left_out=total - len(difference),
    )


def near_jumps(time: Array, jumps: tuple[float, ...]) -> NDArray[np.bool_]:
    """Samples within two steps of an acceleration jump, by the clock's own step."""
    step = float(np.max(np.diff(time)))
    near = np.zeros(len(time), dtype=bool)
    for jump in jumps:
        near |= np.abs(time - jump) <= JUMP_STEPS * step * (1.0 + 1e-9)
    return near


def _clock_length(quantity: Quantity, motion: ObservedMotion) -> int:
    """Samples on the clock the quantity lives on."""
    order = ("torque", "acceleration", "velocity", "position")
    channel = next(c for c in order if any(c == wanted.value for wanted in quantity.channels))
    return len(getattr(motion.history, channel).time)
