"""A linkage in its saved positions: where its points are, one position of them drawn out."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.linkage import GROUND, CylinderDrive, Guide, Linkage, Spring
from analytic.description.written import file_unit
from comparisons.datasheet.sheet import Positions
from reports.charts import symbols
from reports.document.chart import Array

POSITIONS = 12


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
        """Length of a metre in the drawing's unit."""
        return 1.0 / file_unit("m", self.linkage).size

    @property
    def shown_indices(self) -> NDArray[np.intp]:
        """Indices of the positions that are shown, evenly spread."""
        last = len(self.positions.axis) - 1
        return np.rint(np.linspace(0, last, POSITIONS, endpoint=not self.positions.closed)).astype(np.intp)

    def path(self, body: str, locals_: Iterable[ArrayLike]) -> Array:
        """Points of a body, given in its frame, m, over all positions, (points, 2, n)."""
        x, y, angle = self.positions.bodies.get(body, np.zeros((3, len(self.positions.axis))))
        u, v = np.array(list(locals_), dtype=float).reshape(-1, 2, 1).swapaxes(0, 1)
        c, s = np.cos(angle), np.sin(angle)
        return self.scale * np.stack([x + c * u - s * v, y + s * u + c * v], axis=1)

    def at(self, course: Array) -> Array:
        """Values over all positions, (..., n), at the position drawn out."""
        where = self.positions.axis[self.shown_indices[self.clearest]] if self.where is None else self.where
        rows = course.reshape(-1, course.shape[-1])
        return np.array([np.interp(where, self.positions.axis, row) for row in rows]).reshape(course.shape[:-1])

    def shown(self, body: str, locals_: Iterable[ArrayLike]) -> Array:
        """Points of a body in the position drawn out, (points, 2)."""
        return self.at(self.path(body, locals_))

    @cached_property
    def carriers(self) -> dict[str, str]:
        """Of every named point a body that carries it: a moving link before the ground."""
        moving = {point: name for name, link in self.linkage.links.items() for point in link.points}
        return dict.fromkeys(self.linkage.ground, GROUND) | moving

    @property
    def joined(self) -> set[str]:
        """The points where links are joined."""
        of = self.linkage
        return {p.point for p in of.pins} | {s.point for s in of.sliders} | {s.point for s in of.slots}

    @cached_property
    def paths(self) -> dict[str, Array]:
        """Every named point over all positions, (2, n)."""
        return {p: self.path(b, [self.linkage.local(p, b)])[0] for p, b in sorted(self.carriers.items())}

    @cached_property
    def spots(self) -> dict[str, Array]:
        """Every named point in the position drawn out."""
        return {point: self.at(path) for point, path in self.paths.items()}

    @cached_property
    def clearest(self) -> int:
        """The one of the few positions whose moving points lie farthest apart."""
        places = np.array(
            [path[:, self.shown_indices] for point, path in self.paths.items() if self.carriers[point] != GROUND]
        )
        apart = np.hypot(*np.moveaxis(places[:, None] - places[None, :], 2, 0))
        apart[np.arange(len(places)), np.arange(len(places))] = np.inf
        return int(np.argmax(np.min(apart, axis=(0, 1))))

    def direction(self, guide: Guide) -> Array:
        """Unit vector of a guide in the position drawn out."""
        start, end = self.shown(guide.host, [(0.0, 0.0), guide.along])
        return symbols.unit(end - start)

    @property
    def runs(self) -> list[tuple[Guide, str, str]]:
        """The guides of sliders and slots, each with the body and its point that move along it."""
        sliders = [(s.guide, s.link, s.point) for s in self.linkage.sliders]
        return sliders + [(s.guide, self.positions.carriers[s.point], s.point) for s in self.linkage.slots]

    def reach(self, guide: Guide, body: str, point: str) -> Array:
        """The two ends, in the frame of a guide's host, m, between which a point moves over all positions, (2, 2)."""
        start, end = self.path(guide.host, [guide.through, np.add(guide.through, guide.along)])
        pin = self.path(body, [self.linkage.local(point, body)])[0]
        course = np.sum((pin - start) * (end - start), axis=0) / self.scale**2
        return np.array([guide.through + reach * np.array(guide.along) for reach in (course.min(), course.max())])

    def travel(self, guide: Guide, body: str, point: str) -> Array:
        """The two ends of a point's travel along a guide, as the guide lies in the position drawn out, (2, 2)."""
        return self.shown(guide.host, self.reach(guide, body, point))

    @cached_property
    def stretches(self) -> dict[str, Array]:
        """Springs, dampers and cylinders by name: the places of their two ends over all positions, (2, 2, n)."""
        between: dict[str, Spring | CylinderDrive] = {f"spring:{n}": s for n, s in enumerate(self.linkage.springs)}
        both = between | ({"cylinder": self.linkage.cylinder} if self.linkage.cylinder else {})
        return {name: np.concatenate([self.path(body, [self.linkage.local(point, body)])
                                      for point, body in zip(entry.points, entry.links, strict=True)])
                for name, entry in both.items()}  # fmt: skip

    @cached_property
    def extent(self) -> tuple[Array, Array]:
        """Lowest and highest x and y ever reached."""
        spots = np.concatenate([path.T for path in self.paths.values()])
        return spots.min(axis=0), spots.max(axis=0)
