"""Passages through change points as they are read: angles at which W changes, and series about each of them.

``analytic.kinematics.change_points`` computes them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

Array = NDArray[np.float64]

NODES: Final = 24
NEAREST_NODE: Final = float(np.sin(0.5 * np.pi / NODES))  # of half a patch from its centre
EXTENDED: Final = bool(np.finfo(np.longdouble).eps < np.finfo(float).eps)  # whether this machine has more digits
INNER: Final = 0.05  # of half a patch: nearer than any node


class Touch(NamedTuple):
    """A crank angle, rad, at which a dyad's margin is a rounding, m, of the lengths; and the outer pins' gap there."""

    angle: Any
    margin: Any
    lengths: Any
    gap: Any


@dataclass(frozen=True, eq=False)
class Patch:
    """The surroundings of a change point, up to ``half`` on either side, rad.

    ``series``: by order of derivative the coefficients (NODES, 8 or 6) of both links' poses, rates, accelerations.
    """

    touch: Touch
    half: float
    series: tuple[Array, Array, Array]
    extended: tuple[NDArray[np.longdouble], ...]

    def values(self, order: int, place: Any) -> Any:  # noqa: ANN401 - of either precision
        """The numbers of both links, or their derivatives of an order, at places of [-1, 1]: (8 or 6, n)."""
        series = self.extended if np.asarray(place).dtype == np.longdouble else self.series
        return (chebyshev.chebvander(place, NODES - 1) @ series[order]).T  # faster than chebval


@dataclass(frozen=True, eq=False)
class ChangePoints:
    """Change points of a dyad: crank angles, rad, rising within ``period``, the sign W before the first, patches."""

    angles: tuple[float, ...]
    period: float
    first_sign: float
    patches: tuple[Patch, ...] = ()

    def signs(self, angle: Any) -> Array:  # noqa: ANN401 - of either precision
        """W at crank angles, rad."""
        passed = np.searchsorted(self.angles, np.mod(angle, self.period), "right")
        return np.where(passed % 2 == 0, self.first_sign, -self.first_sign)

    def patches_at(self, angle: Any) -> Iterator[tuple[Patch, NDArray[np.intp], Any]]:  # noqa: ANN401
        """Each patch with the flat indices of the crank angles within it and their places there, in [-1, 1].

        Of angles in extended precision only those nearer to a change point than any node.
        """
        flat = np.ravel(angle)
        for patch in self.patches:
            away = np.mod(flat - float(patch.touch.angle) + 0.5 * self.period, self.period) - 0.5 * self.period
            reach = patch.half * (INNER if flat.dtype == np.longdouble else 1.0)
            within = np.flatnonzero(np.abs(away) < reach)
            if len(within):
                yield patch, within, away[within] / patch.half

    def moves(self, angle: Any, away: Any) -> Any:  # noqa: ANN401
        """Where the dyad can move: where ``away`` from its dead positions, and everywhere within patches."""
        result = np.array(np.broadcast_to(away, np.shape(angle)))
        for _, within, _ in self.patches_at(angle):
            result.reshape(-1)[within] = True
        return result

    def with_series(self, angle: Any, order: int, pair: tuple[Any, Any]) -> tuple[Any, Any]:  # noqa: ANN401
        """Poses of the dyad's two links, or their derivatives, with those within patches read from the series."""
        result, size = None, len(pair[0])
        for patch, within, place in self.patches_at(angle):
            if result is None:
                result = [np.array(np.broadcast_to(np.asarray(part), np.shape(angle))) for part in (*pair[0], *pair[1])]
            for part, values in zip(result, patch.values(order, place), strict=True):
                part.reshape(-1)[within] = values
        return pair if result is None else (tuple(result[:size]), tuple(result[size:]))

    def move_out_of_patches(self, angle: Array) -> None:
        """Move crank angles within patches to the nodes that determine the series there.

        The series are no worse than the closed form at the edges of the patch or, where the machine has no extended
        precision, at the nodes nearest to the change point.
        """
        for patch, within, place in self.patches_at(angle):
            from_centre = np.copysign(1.0 if EXTENDED else NEAREST_NODE, place)
            angle.reshape(-1)[within] += (from_centre - place) * patch.half
