"""How long a window of integration may be, when it is good, and what is carried on to the next one.

All functions are of plain numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

FULL_TURN: Final = 2.0 * np.pi
# φ less its whole turns, whose digits would be lost to those that the equation depends on, the rounding that its last
# sum lost, ω and its lost rounding, the whole turns.
State = tuple[float, float, float, float, float]

MOST_ITERATIONS: Final = 30
DIVERGING: Final = 30.0  # times the least change so far: the window is too long
LEAST_WINDOW: Final = 1e-12  # of the longest one
# Near a dead position the windows shrink without end. A kink in a load takes some 40 small ones to get over.
STUCK: Final = 100
STUCK_SHARE: Final = 0.05
SAFETY, MOST_GROWTH, LEAST_GROWTH, MOST_RETRY = 0.85, 2.0, 0.2, 0.7
ALL_BUT: Final = 0.999  # of the rest of the time: no sliver of a window is left over
TINY: Final = float(np.finfo(float).tiny)
FIRST_ANGLE: Final = 0.3  # rad, the first window's guess
EPS: Final = float(np.finfo(float).eps)


def first_window(speed: float, acceleration: float, duration: float) -> float:
    """Time in which the crank turns a little, s."""
    rate = max(abs(speed), np.sqrt(abs(acceleration) * FIRST_ANGLE))
    return min(duration, FIRST_ANGLE / rate) if rate > 0.0 else duration


def has_settled(change: float, before: float, peak: float, rounding: float) -> bool:
    """Whether the iteration in a window is down to rounding, or no longer shrinking close to it."""
    return change <= 4.0 * EPS * peak + rounding or (change >= 0.5 * before and change <= 1e4 * EPS * peak)


def relative_error(tail: float, speed: float, gained: float, peak: float, length: float) -> float:
    """Error of the speed over the speed in a window, from the last terms of the acceleration's series."""
    scale = max(abs(speed), abs(speed + length * gained), length * peak)
    return tail * length / scale if scale > 0.0 else 0.0


def growth(error: float, tolerance: float, nodes: int) -> float:
    """By how much the next window may be longer."""
    ideal: float = SAFETY * (tolerance / max(error, TINY)) ** (1.0 / nodes)
    return min(max(ideal, LEAST_GROWTH), MOST_GROWTH)


def carried(value: float, lost: float, change: float) -> tuple[float, float]:
    """A sum with the rounding of each addition kept (Kahan)."""
    change += lost
    total = value + change
    return total, change - (total - value)


def at_end(state: State, length: float, once: float, twice: float) -> State:
    """The state at a window's end, from the integrals of the acceleration over [0, 1]."""
    angle, angle_lost, speed, speed_lost, turns = state
    angle, angle_lost = carried(angle, angle_lost, length * speed + length * length * twice)
    speed, speed_lost = carried(speed, speed_lost, length * once)
    whole = np.trunc(angle / FULL_TURN)
    return angle - whole * FULL_TURN, angle_lost, speed, speed_lost, turns + whole


def is_lost(starts: Sequence[float] | NDArray[np.float64], done: int, length: float, longest: float) -> bool:
    """Whether the windows get too short, or the latest together are beside one before: the motion runs into a wall."""
    time = starts[done]
    if length < LEAST_WINDOW * longest or time + length == time:
        return True
    if done == 0 or done % STUCK != 0:
        return False
    recent, widest = starts[done] - starts[done - STUCK], 0.0
    for window in range(max(done - 2 * STUCK, 0), done - STUCK):
        widest = max(widest, starts[window + 1] - starts[window])
    return bool(recent < STUCK_SHARE * widest)
