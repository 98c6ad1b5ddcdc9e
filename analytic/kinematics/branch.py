"""A configuration of a group over φ: nodes from which Newton's method finds the links anywhere between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class GroupBranch:
    """Nodes over φ, ``coordinate`` (m,), rad or m, increasing: ``state`` (m, 3, links, 3), x, y, θ and derivatives.

    ``turns`` (links,) is each link's angle per turn of a crank that returns to its start, rad; None for a branch with
    two ends. ``strays`` says that a turn of the crank ends in another configuration.
    """

    coordinate: Array
    state: Array
    unit: float
    turns: Array | None
    is_linear: bool
    strays: bool = False

    @property
    def ends(self) -> tuple[float, float]:
        """The lowest and the highest φ."""
        return float(self.coordinate[0]), float(self.coordinate[-1])

    def wrapped(self, coordinate: Array) -> Array:
        """φ shifted by whole turns of a crank into the range of the nodes; of a linear driver as it is."""
        if self.is_linear:
            return coordinate
        low, high = self.ends
        if self.turns is not None:
            return coordinate - FULL_TURN * np.floor((coordinate - low) / FULL_TURN)
        if high - low >= FULL_TURN:
            return coordinate
        return coordinate - FULL_TURN * np.round((coordinate - 0.5 * (low + high)) / FULL_TURN)

    def margin(self, coordinate: Array) -> Array:
        """Distance of φ, rad or m, from the nearer end, negative outside; infinite where there are no ends."""
        if self.turns is not None:
            return np.full(np.shape(coordinate), np.inf)
        at, (low, high) = self.wrapped(coordinate), self.ends
        return np.asarray(np.minimum(at - low, high - at))

    def guess(self, coordinate: Array) -> Array:
        """Coordinates of the links near the exact ones, (n, links, 3), by quintics between the nodes."""
        return quintic(self.coordinate, self.state, self.wrapped(coordinate))


def quintic(places: Array, state: Array, at: Array) -> Array:
    """Hermite's quintics through both neighbours' values and derivatives (``state``), at ``at`` (n,): (n, links, 3)."""
    if len(places) == 1:
        return np.repeat(state[:, 0], len(at), axis=0)
    left = np.clip(np.searchsorted(places, at, side="right") - 1, 0, len(places) - 2)
    width = places[left + 1] - places[left]
    x = np.clip((at - places[left]) / width, 0.0, 1.0)
    result = np.zeros((len(at), *state.shape[2:]))
    for node, s, sign in ((left, x, 1.0), (left + 1, 1.0 - x, -1.0)):
        u = 1.0 - s
        weights = (
            u**3 * (1.0 + 3.0 * s + 6.0 * s * s),
            sign * width * u**3 * s * (1.0 + 3.0 * s),
            0.5 * width**2 * u**3 * s * s,
        )
        for order, weight in enumerate(weights):
            result += weight[:, None, None] * state[node, order]
    return result
