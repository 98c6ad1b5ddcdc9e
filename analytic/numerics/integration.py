"""Integration of φ̈ = ε(φ, φ̇) in windows as long as the motion allows.

All nodes of a window are solved at once by fixed-point iteration, so that NumPy evaluates the equation for all of them
together. A window is accepted when the last terms of its series are below the tolerance.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from analytic.description.crank_motion import degrees
from analytic.description.law import FULL_TURN
from analytic.errors import AssemblyError, LinkproofError
from analytic.numerics.arrays import Array

# Gauss collocation of φ̈ = ε(φ, φ̇) in windows of time: the scheme, and the motion that it makes.
#
# In a window the acceleration is a polynomial through its values at Gauss-Legendre nodes; speed and angle are its
# exact integrals, and the equation holds at the nodes (Hairer, Lubich, Wanner, *Geometric Numerical Integration*,
# II.1.3). With n nodes the window's end is of order 2n. The polynomials *are* the dense output: valid at every
# instant, not at the ends of steps only.


class GaussScheme(NamedTuple):
    """Gauss collocation on [0, 1] with n ``nodes``.

    ``series`` (n, n) turns values at the nodes into coefficients of Legendre polynomials, ``once`` and ``twice`` (n, n)
    into the first and second integral at the nodes, ``end_once`` and ``end_twice`` (n,) at 1; ``speed`` (n + 1, n) and
    ``angle`` (n + 2, n) into the Legendre coefficients of both integrals.
    """

    nodes: Array
    series: Array
    once: Array
    twice: Array
    end_once: Array
    end_twice: Array
    speed: Array
    angle: Array


@lru_cache
def gauss_scheme(count: int) -> GaussScheme:
    """The Gauss integration scheme with ``count`` nodes; it is made once and kept."""
    points, weights = legendre.leggauss(count)
    orders = np.arange(count)
    series: Array = (orders + 0.5)[:, None] * legendre.legvander(points, count - 1).T * weights
    speed = np.asarray(0.5 * legendre.legint(series, lbnd=-1), dtype=float)
    angle = np.asarray(0.5 * legendre.legint(speed, lbnd=-1), dtype=float)
    nodes = 0.5 * (points + 1.0)
    return GaussScheme(
        nodes=nodes,
        series=series,
        once=legendre.legvander(points, count) @ speed,
        twice=legendre.legvander(points, count + 1) @ angle,
        end_once=0.5 * weights,
        end_twice=0.5 * weights * (1.0 - nodes),
        speed=speed,
        angle=angle,
    )


@dataclass(frozen=True)
class Windows:
    """A motion, window after window: ``starts`` (w + 1,), s, the last one its end.

    ``angle`` (n + 2, w), rad, and ``speed`` (n + 1, w), rad/s, are coefficients of Legendre polynomials over [-1, 1]
    across a window, ``base`` (w,) the angle at its start, which the series of the angle leaves out to keep its digits.
    """

    starts: Array
    base: Array
    angle: Array
    speed: Array

    def _window_and_place(self, time: Array) -> tuple[NDArray[np.intp], Array]:
        """For instants, s, of any shape: the index of each one's window, and its place there, -1 to 1.

        An instant outside the motion has a place beyond these in the first or last window.
        """
        window = np.clip(np.searchsorted(self.starts, time, side="right") - 1, 0, len(self.base) - 1)
        left, right = self.starts[window], self.starts[window + 1]
        return window, ((time - left) - (right - time)) / (right - left)

    def angle_at(self, time: Array) -> Array:
        """φ, rad, at instants, s (any shape); outside the motion by the series of its first or last window."""
        window, place = self._window_and_place(time)
        return np.asarray(self.base[window] + legendre.legval(place, self.angle[:, window], tensor=False))

    def speed_at(self, time: Array) -> Array:
        """ω, rad/s, at instants, s (any shape); outside the motion by the series of its first or last window."""
        window, place = self._window_and_place(time)
        return np.asarray(legendre.legval(place, self.speed[:, window], tensor=False))


Acceleration = Callable[[Array, Array], Array]
Push = Callable[[Array, Array], Array]
Timed = Callable[[Array, Array, Array], Array]

EPS, TINY = float(np.finfo(float).eps), float(np.finfo(float).tiny)
LEAST_TOLERANCE: Final = 64.0 * EPS  # the last coefficients of a series never fall below a few roundings
MOST_WINDOWS: Final = 200_000  # some ten thousand turns
# After so many windows a motion is refused that at its pace would take SLOWER times as many as it may.
FIRST_WINDOWS, SLOWER = 1_000, 100.0
MOST_ITERATIONS: Final = 30
DIVERGING: Final = 30.0  # times the least change so far: the window is too long
SETTLED: Final = 0.001  # of the tolerance, relative to the acceleration: what an iteration may leave
FINE: Final = 1e-9  # a tolerance from which windows settle to rounding
SAFETY, MOST_GROWTH, LEAST_GROWTH, MOST_RETRY = 0.85, 1.5, 0.2, 0.7
NEARLY_ALL: Final = 0.999  # of the rest of the time: no sliver of a window is left over
FIRST_ANGLE: Final = 0.3  # rad, the first window's guess
LEAST_WINDOW: Final = 1e-12  # of the longest one
# Near a dead position the windows shrink without end. A kink in a load takes some 40 small ones to get over.
STUCK, STUCK_SHARE = 100, 0.05


class _Path:
    """The windows done so far and the state at their end: φ, ω and φ̈.

    ``angle`` is φ less its whole periods, whose digits would be lost to those that the equation depends on.
    """

    def __init__(self, scheme: GaussScheme, start: tuple[float, float], period: float) -> None:
        """Begin a motion at t = 0 from ``start``, (φ, ω), in rad and rad/s, integrated by a ``scheme``.

        The angle is kept within a ``period``, rad, which may be infinite.
        """
        self.scheme, self.period = scheme, period
        self.angle, self.speed = start
        self.acceleration = 0.0
        self._lost = [0.0, 0.0]  # the rounding of the latest sums of both
        self._periods = 0
        self.starts = [0.0]
        self._base: list[float] = []
        self._speeds: list[float] = []
        self._accelerations: list[Array] = []

    @property
    def time(self) -> float:
        """The end of the latest window, s."""
        return self.starts[-1]

    def add(self, accelerations: Array, end: float) -> None:
        """Append a window up to the time ``end``, s, from accelerations (n,), rad/s², at its nodes.

        The path's state, φ, ω and φ̈, moves to its end.
        """
        length = end - self.time
        self._base.append(self.angle + (self._periods * self.period if self._periods else 0.0))
        self._speeds.append(self.speed)
        self._accelerations.append(accelerations)
        self.starts.append(end)
        angle, self._lost[0] = _compensated_sum(
            self.angle, self._lost[0], length * self.speed + length**2 * float(self.scheme.end_twice @ accelerations)
        )
        self.speed, self._lost[1] = _compensated_sum(
            self.speed, self._lost[1], length * float(self.scheme.end_once @ accelerations)
        )
        self.acceleration = float(accelerations[-1])  # the last node's, a hair before the end
        self.angle = math.fmod(angle, self.period)
        self._periods += round((angle - self.angle) / self.period)

    def windows(self) -> Windows:
        """The motion so far as series of Legendre polynomials."""
        length, start = np.diff(self.starts), np.array(self._speeds)
        accelerations = np.stack(self._accelerations, axis=1)
        angle, speed = length**2 * (self.scheme.angle @ accelerations), length * (self.scheme.speed @ accelerations)
        angle[:2] += 0.5 * length * start  # the line from 0 to ω·length over [-1, 1]
        speed[0] += start
        return Windows(np.array(self.starts), np.array(self._base), angle, speed)

    def is_lost(self, length: float, longest: float) -> bool:
        """Whether the motion cannot go on, as its windows shrink without end.

        It cannot where the next one, of ``length``, s, is a rounding beside ``longest``, the longest so far, s, or
        beside the time, or where the latest 100 are tiny beside those before.
        """
        done = len(self.starts) - 1
        if length < LEAST_WINDOW * longest or self.time + length == self.time:
            return True
        if done == 0 or done % STUCK != 0:
            return False
        before = np.diff(self.starts[max(done - 2 * STUCK, 0) : done - STUCK + 1])
        return self.time - self.starts[done - STUCK] < STUCK_SHARE * float(before.max(initial=0.0))


def _compensated_sum(value: float, lost: float, change: float) -> tuple[float, float]:
    """The sum of all three, and its rounding error, which the next sum takes as ``lost`` (Kahan)."""
    change += lost
    total = value + change
    return total, change - (total - value)


def integrate(
    acceleration: Acceleration,
    start: tuple[float, float],
    duration: float,
    scheme: GaussScheme,
    *,
    tolerance: float,
    rounding: float,
    place: Callable[[float], str] = lambda angle: f"crank angle {degrees(angle)}",
    period: float = FULL_TURN,
    push: Push | None = None,
    knots: Sequence[float] = (),
) -> Windows:
    """Integrate φ̈ from ``start``, (φ, ω), rad and rad/s, for ``duration`` seconds.

    ``acceleration(angle, speed)`` gives φ̈, rad/s², for φ and ω of several instants (n,); where it raises AssemblyError
    a window is made smaller. ``tolerance`` is the relative error of the speed within a window. ``rounding`` is the
    noise of an acceleration, rad/s²: no window is made smaller to follow it. ``place`` writes a φ for a message,
    ``period`` is that of the acceleration in φ, rad, infinite without a period. ``push(time, angle)`` is a part of the
    acceleration, rad/s², that depends on time, s, and φ; at its ``knots``, s, where it has kinks, a window ends and the
    next one begins anew. Raises LinkproofError where the motion cannot be followed to its end or takes too many
    windows, AssemblyError where it cannot begin.
    """
    tolerance, count = max(tolerance, LEAST_TOLERANCE), len(scheme.nodes)
    unsettled = SETTLED * tolerance if tolerance > FINE else 0.0
    path = _Path(scheme, start, period)
    pushed = _with_push(acceleration, push)
    borders = [*sorted(knot for knot in knots if 0.0 < knot < duration), duration]
    path.acceleration = _end_acceleration(pushed, path)
    length = longest = _first_window(path, duration)
    while path.time < duration:
        last = length >= NEARLY_ALL * (borders[0] - path.time)
        end = borders[0] if last else path.time + length
        length = end - path.time
        accelerations = _node_accelerations(pushed, path, length, rounding, unsettled)
        error = np.inf if accelerations is None else _relative_speed_error(path, accelerations, length, rounding)
        factor = min(max(SAFETY * (tolerance / max(error, TINY)) ** (1.0 / count), LEAST_GROWTH), MOST_GROWTH)
        if accelerations is not None and error <= tolerance:
            path.add(accelerations, end)
            longest = max(longest, length)
            if last:
                del borders[0]
                path.acceleration = _end_acceleration(pushed, path)
        else:
            factor = min(factor, MOST_RETRY)
        length *= factor
        _check_progress(path, length, longest, duration, place)
    return path.windows()


def _with_push(acceleration: Acceleration, push: Push | None) -> Timed:
    """The whole acceleration, rad/s², as a function of time, φ and ω.

    ``push(time, angle)`` adds to ``acceleration(angle, speed)``, None adds nothing.
    """
    if push is None:
        return lambda _time, angle, speed: acceleration(angle, speed)
    return lambda time, angle, speed: acceleration(angle, speed) + push(time, angle)


def _end_acceleration(acceleration: Timed, path: _Path) -> float:
    """The acceleration at the path's end, rad/s², by a function of time, φ and ω, whose errors it raises."""
    return float(acceleration(np.array([path.time]), np.array([path.angle]), np.array([path.speed]))[0])


def _first_window(path: _Path, duration: float) -> float:
    """A first window's length, s: the crank turns by about 0.3 rad in it, or the whole ``duration``, s, if it rests."""
    rate = max(abs(path.speed), math.sqrt(abs(path.acceleration) * FIRST_ANGLE))
    return min(duration, FIRST_ANGLE / rate) if rate > 0.0 else duration


def _node_accelerations(acceleration: Timed, path: _Path, length: float, rounding: float, share: float) -> Array | None:
    """Accelerations (n,), rad/s², at the nodes of a window of ``length``, s, after the path's end.

    They are settled where they are off by no more than ``rounding``, rad/s², or a ``share`` of their peak. None where
    the iteration does not settle or ``acceleration``, of time, φ and ω, raises AssemblyError.
    """
    scheme, speed = path.scheme, path.speed
    ahead = path.angle + speed * length * scheme.nodes
    once, twice = length * scheme.once, length**2 * scheme.twice
    time = path.time + length * scheme.nodes
    latest = np.full(len(time), path.acceleration)
    before, least, peak = 0.0, np.inf, 0.0
    for _ in range(MOST_ITERATIONS):
        try:
            following = acceleration(time, ahead + twice @ latest, speed + once @ latest)
        except AssemblyError:
            return None
        change = float(np.abs(following - latest).max())
        if not change <= DIVERGING * least:
            return None
        peak = peak or float(np.abs(following).max())
        latest, least = following, min(least, change)
        # As the changes shrink, what is left to change is less than change²/before.
        if change <= rounding + 4.0 * EPS * peak or change * change <= before * share * peak:
            return latest
        if change >= 0.5 * before and change <= 1e4 * EPS * peak:
            return latest
        before = change
    return None


def _relative_speed_error(path: _Path, accelerations: Array, length: float, rounding: float) -> float:
    """Relative error of the speed over a window of ``length``, s, from the last terms of its series; 0 at rest.

    ``accelerations`` (n,), rad/s², are those at its nodes; ``rounding``, rad/s², of the terms is no error.
    """
    tail = max(float(np.abs(path.scheme.series[-2:] @ accelerations).max()) - rounding, 0.0)
    gained, peak = float(path.scheme.end_once @ accelerations), float(np.abs(accelerations).max())
    scale = max(abs(path.speed), abs(path.speed + length * gained), length * peak)
    return tail * length / scale if scale > 0.0 else 0.0


def _check_progress(path: _Path, length: float, longest: float, duration: float, place: Callable[[float], str]) -> None:
    """Raise LinkproofError where the motion cannot be followed, or takes too many windows; ``place`` writes a φ.

    ``length`` is that of the next window, ``longest`` that of the longest so far, ``duration`` that of the motion, s.
    """
    time, done = path.time, len(path.starts) - 1
    if path.is_lost(length, longest):
        raise LinkproofError(
            f"motion: expected a smooth one, got one that cannot be followed beyond t = {time:.6g} s at "
            f"{place(path.angle)}, where it meets a dead position or its speed grows without bound; shorten the "
            "duration or change the loads"
        )
    if done > MOST_WINDOWS or (done == FIRST_WINDOWS and done * duration > SLOWER * MOST_WINDOWS * time):
        raise LinkproofError(
            f"motion: expected at most {MOST_WINDOWS} windows of integration, got a motion over {duration:g} s "
            f"that needs more, as it goes at t = {time:.4g} s; shorten the duration"
        )
