"""Richardson extrapolation of whole histories.

Runs at several steps are combined so that the leading errors cancel.

L. F. Richardson, "The deferred approach to the limit", Phil. Trans. R. Soc. A 226 (1927). An engine whose error is
c₁ hᵖ¹ + c₂ hᵖ² + … gives, from n steps, the one combination in which the first n - 1 of these terms are gone.

Where an engine's error also has a part that changes sign from step to step (the multipliers of the trapezoidal rule
do), the steps must stand to each other as odd numbers: a common sample is then an odd number of steps from the start in
every run or an even number in every run, the alternating part keeps its sign and goes too. Halving turns it into noise.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from engines.contract import History, Origin, Signal, weakest

Array = NDArray[np.float64]

Weigh = Callable[[Sequence[float], Sequence[int]], Array]

# Clocks of two runs may differ by rounding alone: this much of the whole duration.
CLOCK_ROUNDING = 1e-9


@dataclass(frozen=True)
class Pass:
    """One run of a scene at one step, s or any unit common to all, and the history at the samples common to all."""

    step: float
    history: History


def weights(steps: Sequence[float], orders: Sequence[int]) -> Array:
    """Weights w, shape (n,), with Σ w = 1 and Σ w hᵖ = 0 for the first n - 1 of ``orders``; h are the n steps.

    Raises ValueError for fewer orders, LinAlgError for steps of which two are equal.
    """
    if len(orders) < len(steps) - 1:
        raise ValueError(f"expected at least {len(steps) - 1} orders for {len(steps)} steps, got {len(orders)}")
    relative = np.asarray(steps, dtype=float) / max(steps)  # keeps the system well scaled whatever the unit of time
    rows = [np.ones_like(relative), *(relative**order for order in orders[: len(steps) - 1])]
    right = np.zeros(len(steps))
    right[0] = 1.0
    return np.asarray(np.linalg.solve(np.array(rows), right), dtype=np.float64)


def extrapolate(passes: Sequence[Pass], orders: Sequence[int] = (2, 4, 6, 8), weigh: Weigh = weights) -> History:
    """Combine passes of one scene so that the leading errors, of these orders, cancel; all share their sample times.

    Returns a new history with the signals and times of the first pass, which all passes have. ``weigh`` is called with
    the steps and the orders and returns a weight for each step. The origin is the weakest of the passes', and READ
    becomes EXTRAPOLATED unless there is one pass alone. Raises ValueError where the sample times differ, or by
    ``weights``.
    """
    share = weigh([each.step for each in passes], orders)

    def weighted(signals: Sequence[Signal]) -> Signal:
        """The weighted sum of signals, one a pass, at the first one's times; raises ValueError where times differ."""
        time = signals[0].time
        for signal in signals:
            if len(signal.time) != len(time) or np.abs(signal.time - time).max() > CLOCK_ROUNDING * np.ptp(time):
                raise ValueError("expected the same sample times from every step; sample all runs on the coarsest grid")
        values = share[0] * signals[0].values
        for weight, signal in zip(share[1:], signals[1:], strict=True):
            values += weight * signal.values
        origin = weakest(signal.origin for signal in signals)
        if len(signals) > 1 and origin is Origin.READ:
            origin = Origin.EXTRAPOLATED
        return Signal(time, values, origin)

    every = [each.history.signals for each in passes]
    return History.of({key: weighted([signals[key] for signals in every]) for key in every[0]})
