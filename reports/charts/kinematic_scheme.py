"""A linkage in its saved positions: where its points are, one position of them drawn out."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import GROUND, Guide, Linkage, Vector
from comparisons.datasheet.sheet import Positions
from comparisons.datasheet.units import file_unit

Array = NDArray[np.float64]

POSITIONS = 12


def placed(pose: Array, locals_: Iterable[Vector]) -> Array:
    """Points of a body, (points, 2, …), whose frame has its origin at x, y and is turned by an angle, (3, …)."""
    x, y, angle = pose
    c, s = np.cos(angle), np.sin(angle)
    return np.array([(x + c * u - s * v, y + s * u + c * v) for u, v in locals_]).reshape(-1, 2, *x.shape)


@dataclass(frozen=True)
class KinematicScheme:
    """A linkage in its positions; ``where`` is the instant, on their axis, that is drawn out, the clearest if None.

    All places are in the unit of length of the linkage's file.
    """

    linkage: Linkage
    positions: Positions
    where: float | None = None

    @cached_property
    def scale(self) -> float:
        """What a metre measures in the drawing."""
        return 1.0 / file_unit("m", self.linkage).size

    @property
    def few(self) -> NDArray[np.intp]:
        """Indices of the positions that are shown, evenly spread."""
        last = len(self.positions.axis) - 1
        return np.rint(np.linspace(0, last, POSITIONS, endpoint=not self.positions.closed)).astype(np.intp)

    @cached_property
    def axis_shown(self) -> float:
        """The instant that is drawn out."""
        return float(self.positions.axis[self.few[self.clearest]]) if self.where is None else self.where

    def pose(self, body: str) -> Array:
        """Pose of a body over all positions, (3, n)."""
        return self.positions.bodies.get(body, np.zeros((3, len(self.positions.axis))))

    def pose_shown(self, body: str) -> Array:
        """Pose of a body in the position drawn out, (3,)."""
        return np.array([np.interp(self.axis_shown, self.positions.axis, row) for row in self.pose(body)])

    def path(self, body: str, locals_: Iterable[Vector]) -> Array:
        """Points of a body over all positions, (points, 2, n)."""
        return self.scale * placed(self.pose(body), locals_)

    def shown(self, body: str, locals_: Iterable[Vector]) -> Array:
        """Points of a body in the position drawn out, (points, 2)."""
        return self.scale * placed(self.pose_shown(body), locals_)

    @cached_property
    def carriers(self) -> dict[str, str]:
        """Of every named point a body that carries it: a moving link before the ground."""
        moving = {point: name for name, link in self.linkage.links.items() for point in link.points}
        return dict.fromkeys(self.linkage.ground, GROUND) | moving

    @cached_property
    def paths(self) -> dict[str, Array]:
        """Every named point over all positions, (2, n)."""
        return {p: self.path(b, [self.linkage.local(p, b)])[0] for p, b in sorted(self.carriers.items())}

    @cached_property
    def spots(self) -> dict[str, Array]:
        """Every named point in the position drawn out."""
        return {p: self.shown(b, [self.linkage.local(p, b)])[0] for p, b in sorted(self.carriers.items())}

    @cached_property
    def clearest(self) -> int:
        """The one of the few positions whose moving points lie farthest apart."""
        places = np.array([path[:, self.few] for point, path in self.paths.items() if self.carriers[point] != GROUND])
        apart = np.hypot(*np.moveaxis(places[:, None] - places[None, :], 2, 0))
        apart[np.arange(len(places)), np.arange(len(places))] = np.inf
        return int(np.argmax(np.min(apart, axis=(0, 1))))

    def direction(self, guide: Guide) -> Array:
        """Unit vector of a guide in the position drawn out."""
        start, end = self.shown(guide.host, [(0.0, 0.0), guide.along])
        return np.asarray((end - start) / np.hypot(*(end - start)))

    def travel(self, guide: Guide, body: str, point: str) -> tuple[Vector, Vector]:
        """The two ends, in the host's frame, m, between which a point moves along a guide over all positions."""
        (x, y), (u, v) = guide.through, guide.along
        start, end = placed(self.pose(guide.host), [(x, y), (x + u, y + v)])
        pin = placed(self.pose(body), [self.linkage.local(point, body)])[0]
        along = np.sum((pin - start) * (end - start), axis=0)
        low, high = float(np.min(along)), float(np.max(along))
        return (x + low * u, y + low * v), (x + high * u, y + high * v)

    def stretched(self, points: tuple[str, str], bodies: tuple[str, str]) -> Array:
        """The ends of a spring or a cylinder over all positions, (2, 2, n)."""
        both = zip(points, bodies, strict=True)
        return np.concatenate([self.path(body, [self.linkage.local(point, body)]) for point, body in both])

    @cached_property
    def stretches(self) -> dict[str, Array]:
        """What is drawn between two points, by a name of its own: their places over all positions, (2, 2, n)."""
        found = {f"spring:{n}": self.stretched(s.points, s.links) for n, s in enumerate(self.linkage.springs)}
        cylinder = self.linkage.cylinder
        return found | ({"cylinder": self.stretched(cylinder.points, cylinder.links)} if cylinder else {})

    def ends_shown(self, name: str) -> Array:
        """The ends of one of them in the position drawn out, (2, 2)."""
        rows = self.stretches[name].reshape(4, -1)
        return np.array([np.interp(self.axis_shown, self.positions.axis, row) for row in rows]).reshape(2, 2)

    @cached_property
    def extent(self) -> tuple[Array, Array]:
        """Lowest and highest x and y ever reached."""
        spots = np.concatenate([path.T for path in self.paths.values()])
        return spots.min(axis=0), spots.max(axis=0)
