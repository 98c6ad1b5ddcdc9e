"""Gauss collocation of φ̈ = ε(φ, φ̇) in windows of time: the scheme, and the motion that it makes.

In a window the acceleration is a polynomial through its values at Gauss-Legendre nodes; speed and angle are its exact
integrals, and the equation holds at the nodes (Hairer, Lubich, Wanner, *Geometric Numerical Integration*, II.1.3). With
n nodes the window's end is of order 2n. The polynomials *are* the dense output: valid at every instant, not at the ends
of steps only.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

Array = NDArray[np.float64]


class GaussScheme(NamedTuple):
    """Gauss collocation on [0, 1] with n nodes.

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
    """The scheme with ``count`` nodes."""
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

    def _place(self, time: Array) -> tuple[NDArray[np.intp], Array]:
        window = np.clip(np.searchsorted(self.starts, time, side="right") - 1, 0, len(self.base) - 1)
        left, right = self.starts[window], self.starts[window + 1]
        return window, ((time - left) - (right - time)) / (right - left)

    def angle_at(self, time: Array) -> Array:
        """φ, rad, at instants (any shape)."""
        window, place = self._place(time)
        return np.asarray(self.base[window] + legendre.legval(place, self.angle[:, window], tensor=False))

    def speed_at(self, time: Array) -> Array:
        """ω, rad/s, at instants (any shape)."""
        window, place = self._place(time)
        return np.asarray(legendre.legval(place, self.speed[:, window], tensor=False))
