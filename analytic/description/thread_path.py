"""The needle thread's way through a linkage: fixed guides and eyes of moving links, in the order it runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from analytic.description.schema import EyeReference

Feed = Literal["shortening", "lengthening"]


@dataclass(frozen=True)
class ThreadGuide:
    """A fixed guide at a point of space, m; z runs along the main shaft, out of the linkage's plane."""

    name: str
    position: tuple[float, float, float]


@dataclass(frozen=True)
class ThreadEye:
    """An eye: a named point of the linkage, at ``z`` (m) in front of its plane."""

    point: str
    z: float = 0.0


@dataclass(frozen=True)
class ThreadPath:
    """A thread and how its feed is counted: Pd(φ) = ±(L(φ) − L(φ_ref)) + ΔP.

    ``stretch`` is ΔP, m, by which the thread gives under its tension. ``feed`` says whether a ``shortening`` contour
    gives thread, as in article 004, or a ``lengthening`` one counts, as in article 002. ``reference`` is φ_ref: a crank
    angle, rad, or an eye's highest or lowest position.
    """

    stops: tuple[ThreadGuide | ThreadEye, ...]
    stretch: float
    feed: Feed
    reference: float | EyeReference

    @property
    def eyes(self) -> tuple[ThreadEye, ...]:
        """The stops on moving links."""
        return tuple(stop for stop in self.stops if isinstance(stop, ThreadEye))
