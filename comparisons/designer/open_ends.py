"""Open ends: ends of a motion beside a dead position, towards which forces and speeds grow without bound.

An extreme there says where the motion was cut off, not what the linkage needs.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from analytic.kinematics.crank_range import CrankRange, Toggle
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.structure import AnyGroup, ClosedGroup
from analytic.kinematics.sweep import Sweep, transmission_angle
from analytic.numerics.arrays import Array
from analytic.numerics.roots import roots

MARGIN: Final = 0.02  # share of a range left out at either end, where forces grow beyond all bounds
NEAR: Final = 0.05  # share of a range within which an end lies beside its limit
BINDS: Final = math.radians(40.0)  # transmission angle below which four-bars and slider-cranks bind easily (Alt)
AT_END: Final = 1e-3  # share of a motion's way within which an extreme is at its end
RANGE_SAMPLES: Final = 721
INSET: Final = 1e-9  # of a range that ends in dead positions, so that its ends are assembled


@dataclass(frozen=True)
class OpenEnd:
    """An end of a motion, φ in rad or m, and the dead position beside it.

    Extremes within ``reach``, rad or m, are at this end.
    """

    place: float
    limit: Toggle
    reach: float

    def has(self, phi: float) -> bool:
        """Whether an extreme at φ, rad or m, lies at this end."""
        return abs(phi - self.place) <= self.reach


def inset_ends(reach: CrankRange, *, backwards: bool = False) -> tuple[float, float]:
    """Start and end of a motion over a range, rad or m: short of its limits, where forces grow beyond all bounds.

    A share MARGIN of the range is left out at either end, but none at the end of a cylinder's travel. ``backwards`` the
    upper end is the start.
    """
    low, high = reach.limits
    margin = MARGIN * (high - low)
    low += 0.0 if reach.low and reach.low.dyad is None else margin
    high -= 0.0 if reach.high and reach.high.dyad is None else margin
    return (high, low) if backwards else (low, high)


def open_ends(mechanism: Mechanism, first: float, last: float) -> tuple[OpenEnd, ...]:
    """The open ends of a motion between two values of φ, rad or m, the lower one first; () without any.

    An end is open where it is near a dead position that limits its range, and the group there binds. Raises
    AssemblyError where the linkage cannot be assembled at the lower end.
    """
    low, high = min(first, last), max(first, last)
    reach = _range_around(mechanism, low)
    if reach.is_full_turn:
        return ()
    width = reach.limits[1] - reach.limits[0]
    return tuple(
        OpenEnd(place, limit, AT_END * (high - low))
        for place, limit in ((low, reach.low), (high, reach.high))
        if limit is not None
        and limit.dyad is not None
        and abs(place - limit.angle) <= NEAR * width
        and _group_angle(mechanism.sweep(np.array([place])), limit.dyad)[0] < BINDS
    )


def _range_around(mechanism: Mechanism, phi: float) -> CrankRange:
    """The crank's range that contains φ, rad or m: the sketch's, or that of a motion that starts there.

    Raises AssemblyError where the linkage cannot be assembled there.
    """
    reach = mechanism.crank_range()
    low, high = reach.limits
    return reach if reach.is_full_turn or low <= phi <= high else mechanism.crank_range(phi)


def _group_angle(sweep: Sweep, group: AnyGroup) -> Array:
    """The transmission angle of a group over the sweep, rad: of a dyad; 0 for a group of a higher class."""
    return transmission_angle(sweep, group) if isinstance(group, ClosedGroup) else np.zeros(sweep.angle.shape)


def good_stretches(function: Callable[[Array], Array], grid: Array, angles: Array) -> list[list[float]]:
    """For each curve of transmission angles, the two ends, rad or m, of the stretch around its best place; [] without.

    Within a stretch the angle is BINDS or more. ``angles`` (rows, n), rad, are the values over ``grid`` (n,),
    ascending, of ``function``, which gives the curves at any φ (m,) as (rows, m).
    """
    brackets = np.zeros((2, 2, len(angles)))  # the last place where it is enough and the first where it is not
    for number, angle in enumerate(angles):
        enough, best = angle >= BINDS, int(np.argmax(angle))
        for side, direction in enumerate((-1, 1)):
            short = np.flatnonzero(~enough[best::direction])
            last = best + direction * (int(short[0]) - 1) if len(short) else (-1 if direction > 0 else 0)
            brackets[side, :, number] = grid[last], grid[last + direction] if len(short) else grid[last]
    ends = [
        roots(lambda phi: np.diagonal(function(phi)) - BINDS, inside, inside, outside) for inside, outside in brackets
    ]
    is_good = [bool(np.max(angle) >= BINDS) for angle in angles]
    return [[float(low), float(high)] if good else [] for low, high, good in zip(*ends, is_good, strict=True)]


def good_part(mechanism: Mechanism, reach: CrankRange) -> list[float]:
    """The two ends, rad or m, of the part of a range where no group binds; [] where there is none."""
    low, high = reach.limits
    inset = INSET * (high - low)
    grid = np.linspace(low + inset, high - inset, RANGE_SAMPLES)
    groups: list[AnyGroup] = [*mechanism.structure.dyads]
    groups += [limit.dyad for limit in (reach.low, reach.high) if limit and limit.dyad and limit.dyad not in groups]

    def least(phi: Array) -> Array:
        """The least transmission angle, rad, of all groups at φ (n,), as one curve (1, n)."""
        sweep = mechanism.sweep(np.clip(phi, grid[0], grid[-1]))
        return np.asarray(np.min([_group_angle(sweep, group) for group in groups], axis=0)[None])

    return good_stretches(least, grid, least(grid))[0]


def open_end_warning(mechanism: Mechanism, ends: Sequence[OpenEnd]) -> str:
    """A warning about open ends, one or more: the dead positions beside them, and a part of the range free of them.

    It has no full stop; ``ends`` are those of one motion. Raises IndexError for no ends.
    """
    reach = _range_around(mechanism, ends[0].place)
    places: dict[str, list[str]] = {}
    for end in ends:
        places.setdefault(end.limit.sentence, []).append(reach.phi.unwrapped(end.limit.angle))
    towards = " and towards ".join(f"{' and '.join(limits)} ({words})" for words, limits in places.items())
    return f"forces and speeds grow without bound towards {towards}; {_cure(mechanism, reach)}"


def _cure(mechanism: Mechanism, reach: CrankRange) -> str:
    """A clause with the options, in round numbers, that keep a motion to the part of the range where no group binds.

    Where there is no such part, it says so.
    """
    part = good_part(mechanism, reach)
    size = mechanism.linkage.phi.unit.size
    if part:
        low, high = part[0] / size, part[1] / size
        step = 10.0 ** math.floor(math.log10((high - low) / 20.0))
        first, last = math.ceil(low / step) * step, math.floor(high / step) * step
        return (
            f"--from {first:.6g} --to {last:.6g} keeps every transmission angle at {math.degrees(BINDS):.0f}° or more"
        )
    return f"no part of the range has a transmission angle of {math.degrees(BINDS):.0f}°: change the lengths"
