"""States of all bodies at many instants, in a scene's own length, with the points fixed in them."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import GROUND, Vector

Array = NDArray[np.float64]
Pair = tuple[Array | float, Array | float]
NOTHING: Array = np.zeros((0, 0, 3))


@dataclass(frozen=True)
class States:
    """x, y and angle of every body and their time derivatives, each (instants, bodies, 3).

    Lengths are in ``size``, m; anchors are given in metres. A derivative that is not there must not be asked for.
    """

    numbers: dict[str, int]
    size: float
    position: Array
    velocity: Array = field(default_factory=lambda: NOTHING)
    acceleration: Array = field(default_factory=lambda: NOTHING)

    @cached_property
    def _turn(self) -> tuple[Array, Array]:
        angle = self.position[:, :, 2]
        return np.cos(angle), np.sin(angle)

    def turned(self, body: str, vector: Vector) -> Pair:
        """A vector of a body's frame in the ground frame."""
        if body == GROUND:
            return vector
        c, s = (part[:, self.numbers[body]] for part in self._turn)
        return c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]

    def arm(self, body: str, anchor: Vector) -> Pair:
        """Vector from a body's mass centre (the ground's origin) to a point fixed in it."""
        return self.turned(body, (anchor[0] / self.size, anchor[1] / self.size))

    def point(self, body: str, anchor: Vector, order: int = 0) -> Pair:
        """A point fixed in a body, its velocity (``order`` 1) or its acceleration (2)."""
        x, y = self.arm(body, anchor)
        if body == GROUND:
            return (x, y) if order == 0 else (0.0, 0.0)
        number = self.numbers[body]
        if order == 0:
            return self.position[:, number, 0] + x, self.position[:, number, 1] + y
        rate = self.velocity[:, number]
        if order == 1:
            return rate[:, 0] - rate[:, 2] * y, rate[:, 1] + rate[:, 2] * x
        second, square = self.acceleration[:, number], rate[:, 2] ** 2
        return second[:, 0] - second[:, 2] * y - square * x, second[:, 1] + second[:, 2] * x - square * y

    def gap(self, first: tuple[str, Vector], second: tuple[str, Vector], order: int = 0) -> Pair:
        """From a point of one body to one of another, or a time derivative of that."""
        one, other = self.point(*first, order), self.point(*second, order)
        return one[0] - other[0], one[1] - other[1]

    def angle(self, body: str, order: int = 0) -> Array:
        """Angle of a body, or a time derivative of it; 0 for the ground."""
        values = (self.position, self.velocity, self.acceleration)[order]
        return np.zeros(len(self.position)) if body == GROUND else values[:, self.numbers[body], 2]
