"""Richardson extrapolation of whole histories: one run at several steps, combined so that the leading errors cancel.

L. F. Richardson, "The deferred approach to the limit", Phil. Trans. R. Soc. A 226 (1927). An engine whose error is
c₁ hᵖ¹ + c₂ hᵖ² + … gives, from n steps, the one combination in which the first n - 1 of these terms are gone.

Where an engine's error also has a part that changes sign from step to step (the multipliers of the trapezoidal rule
do), the steps must stand to each other as odd numbers: a common sample is then an odd number of steps from the start in
every run or an even number in every run, the alternating part keeps its sign and goes too. Halving turns it into noise.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from engines.contract import History, Signal

Array = NDArray[np.float64]

# Clocks of two runs may differ by rounding alone: this much of the whole duration.
CLOCK_ROUNDING = 1e-9
# A component this much smaller than its neighbours is rounding and has no relative error.
NOTHING = 1e-9


def weights(steps: Sequence[float], orders: Sequence[int]) -> Array:
    """Weights w, shape (n,), with Σ w = 1 and Σ w hᵖ = 0 for the first n - 1 of ``orders``."""
    if len(orders) < len(steps) - 1:
        raise ValueError(f"expected at least {len(steps) - 1} orders for {len(steps)} steps, got {len(orders)}")
    relative = np.asarray(steps, dtype=float) / max(steps)  # keeps the system well scaled whatever the unit of time
    rows = [np.ones_like(relative), *(relative**order for order in orders[: len(steps) - 1])]
    right = np.zeros(len(steps))
    right[0] = 1.0
    return np.asarray(np.linalg.solve(np.array(rows), right), dtype=np.float64)


def extrapolate(levels: Sequence[tuple[float, History]], orders: Sequence[int] = (2, 4, 6, 8)) -> History:
    """Combine runs of one scene, each a step (s) and its history; all must share their sample times.

    Channels that no run recorded stay None. Raises ValueError where the clocks differ.
    """
    share = weights([step for step, _ in levels], orders)
    histories = [history for _, history in levels]
    return History(
        position=_combined(share, [history.position for history in histories]),
        velocity=_combined(share, [history.velocity for history in histories]),
        acceleration=_combined(share, [history.acceleration for history in histories]),
        torque=_combined(share, [history.torque for history in histories]),
        joint_force=_combined_forces(share, [history.joint_force for history in histories]),
    )


def change(one: History, other: History) -> float:
    """Largest relative difference of two histories of one scene, over the peak of its own component in ``other``.

    Taken in accelerations and torque, which integrators find hardest, or in what else was recorded; 0 if nothing was.
    """
    hard = [(one.acceleration, other.acceleration), (one.torque, other.torque)]
    easy: list[tuple[Signal | None, Signal | None]] = [
        (one.joint_force[name], other.joint_force[name]) for name in one.joint_force
    ]
    easy += [(one.velocity, other.velocity), (one.position, other.position)]
    for pairs in (hard, easy):
        present = [(a, b) for a, b in pairs if a is not None and b is not None]
        if present:
            return max(_relative(a, b) for a, b in present)
    return 0.0


def _relative(one: Signal, other: Signal) -> float:
    shape = (-1, other.values.shape[-1] if other.values.ndim > 1 else 1)
    peak = np.abs(other.values).reshape(shape).max(axis=0)
    difference = np.abs(one.values - other.values).reshape(shape).max(axis=0)
    moves = peak > NOTHING * peak.max()
    return float(np.max(difference[moves] / peak[moves], initial=0.0))


def _combined_forces(share: Array, forces: Sequence[Mapping[str, Signal]]) -> dict[str, Signal]:
    combined = {name: _combined(share, [force[name] for force in forces]) for name in forces[0]}
    return {name: signal for name, signal in combined.items() if signal is not None}


def _combined(share: Array, signals: Sequence[Signal | None]) -> Signal | None:
    present = [signal for signal in signals if signal is not None]
    if not present:
        return None
    time = present[0].time
    for signal in present:
        if len(signal.time) != len(time) or np.abs(signal.time - time).max() > CLOCK_ROUNDING * np.ptp(time):
            raise ValueError("expected the same sample times from every step; sample all runs on the coarsest grid")
    values = share[0] * present[0].values
    for weight, signal in zip(share[1:], present[1:], strict=True):
        values += weight * signal.values
    return Signal(time, values)
