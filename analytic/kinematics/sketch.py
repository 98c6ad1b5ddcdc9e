"""Which of several configurations a sketch means: the one whose named points lie nearest to it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Final

import numpy as np

from analytic.description.linkage import Linkage, Vector
from analytic.kinematics import frames
from analytic.kinematics.frames import Pose

# Two configurations closer to the sketch than this ratio of each other are not distinguished by it.
AMBIGUITY: Final = 0.9
TELLING: Final = 1e-6  # share of the drawing's size by which they must differ at a point for the sketch to show it
Points = Mapping[str, Mapping[str, Vector]]  # of links, by name, in their frames


def named_places(points: Points, poses: Iterable[Pose]) -> dict[str, Vector]:
    """Positions of the named points of links at these poses, one pose per link."""
    places = {}
    for locals_, pose in zip(points.values(), poses, strict=True):
        for point, local in locals_.items():
            x, y = (float(np.ravel(part)[0]) for part in frames.point(pose, local))
            places[point] = (x, y)
    return places


def nearest_to_sketch(linkage: Linkage, places: Sequence[Mapping[str, Vector]]) -> tuple[int, list[str] | None]:
    """The number of the configuration nearest to the sketch; if it is not clear, points that would tell them apart."""
    distances = [
        math.hypot(*(math.dist(place, linkage.sketch[p]) for p, place in configuration.items() if p in linkage.sketch))
        for configuration in places
    ]
    order = sorted(range(len(places)), key=lambda number: distances[number])
    if len(order) == 1 or distances[order[0]] < AMBIGUITY * distances[order[1]]:
        return order[0], None
    nearest, other = places[order[0]], places[order[1]]
    least = TELLING * linkage.extent()
    return order[0], sorted(point for point in nearest if math.dist(nearest[point], other[point]) > least)
