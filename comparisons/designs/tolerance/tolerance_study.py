"""What tolerances do to the results of a linkage: shares of each, the worst case, and many random designs.

Values are SI, arrays over (results, tolerances) or (results,). What is linear follows from derivatives at the nominal
design; corners and random designs are worked out as they are, extremes refined between the crank angles.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import numbers
from analytic.description.crank_motion import RPM
from analytic.description.linkage import Linkage
from analytic.designs.derivatives import figure_gradients, is_exact
from analytic.designs.figures import Figure, Reduction, middle
from analytic.designs.results import design_figures
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.datasheet.units import FileUnit, file_unit
from comparisons.designs.named_figures import NamedFigure, named_figures
from comparisons.designs.steady_motion import SAMPLES as PLACES
from comparisons.designs.steady_motion import SteadyMotion, steady_motion
from comparisons.designs.tolerance.tolerances import ANGLE, LENGTH, Tolerance, Tolerances, Tornado, tolerances

Array = NDArray[np.float64]
Announce = Callable[[str, int, int], None]  # what is worked out, how many are, of how many

EXACT, DIFFERENCE = "exact", "difference"
FEWEST: Final = 2
USUAL: Final = 1000.0  # rpm
SAMPLES: Final = 10_000
FEW_SAMPLES: Final = 200  # of a linkage whose groups are followed anew for every design, which takes a second or so
TOGETHER, ALONE = 1000, 5  # designs worked out between two announcements
SHARES: Final = (0.00135, 0.99865)  # of the quantiles: three standard deviations of a normal distribution
ALL_CORNERS: Final = 12  # tolerances whose corners are all worked out: 4096 designs


@dataclass(frozen=True)
class ToleranceRequest:
    """Tolerances of a mechanism, the results they may move, its motion, and the random designs."""

    mechanism: Mechanism
    tolerances: tuple[Tolerance, ...]
    figures: tuple[NamedFigure, ...]
    motion: SteadyMotion
    samples: int
    seed: int = 0

    @property
    def conditions(self) -> str:
        """Linkage and motion in words."""
        linkage, unit = self.mechanism.linkage, speed_unit(self.mechanism.linkage)
        variant = f" ({linkage.variant})" if linkage.variant else ""
        places = "places" if linkage.is_linear else "crank angles"
        gravity = "" if any(linkage.gravity) else ", no gravity"
        return (
            f"{linkage.name}{variant}: constant speed, {self.motion.speed / unit.size:g} {unit.name}{gravity}, "
            f"refined between {len(self.motion.places)} {places}"
        )

    def designs(self, offsets: Array) -> dict[str, Array]:
        """Numbers of the description (designs,) by name, at offsets (tolerances, designs) from the nominal; SI.

        Masses and inertias that a wide normal distribution makes negative are zero.
        """
        own, found = numbers(self.mechanism.linkage), {}
        polar: dict[str, dict[str, Array]] = {}
        for one, offset in zip(self.tolerances, offsets, strict=True):
            if one.point:
                polar.setdefault(one.point, {})[one.name.removeprefix(one.point)] = offset
            else:
                least = 0.0 if one.parameter.kind in ("mass", "inertia") else -math.inf
                found[one.name] = np.maximum(own[one.name] + offset, least)
        for point, moved in polar.items():
            x, y = own[f"{point}.x"], own[f"{point}.y"]
            length, angle = math.hypot(x, y) + moved.get(LENGTH, 0.0), moved.get(ANGLE, np.zeros(offsets.shape[1]))
            c, s = (length / math.hypot(x, y) * part for part in (np.cos(angle), np.sin(angle)))
            found |= {f"{point}.x": c * x - s * y, f"{point}.y": s * x + c * y}
        return found

    def results(self, offsets: Array, announce: Announce = lambda *_: None) -> Array:
        """The results of designs, (results, designs)."""
        designs, count, parts = self.designs(offsets), offsets.shape[1], []
        size = TOGETHER if is_exact(self.mechanism) else ALONE
        for start in range(0, count, size):
            announce("designs", start, count)
            parts.append(self._some({name: values[start : start + size] for name, values in designs.items()}))
        return np.concatenate(parts, axis=1)

    def _some(self, designs: Mapping[str, Array]) -> Array:
        return design_figures(
            self.mechanism,
            designs,
            [one.figure for one in self.figures],
            self.motion.places,
            speed=self.motion.speed,
            weights=self.motion.weights,
            refine=True,
        )

    def derivatives(self) -> Array:
        """Derivatives of the results by what has a tolerance, (results, tolerances)."""
        own = numbers(self.mechanism.linkage)
        names = list(self.designs(np.zeros((len(self.tolerances), 1))))
        _, gradients = figure_gradients(
            self.mechanism,
            {name: own[name] for name in names},
            [one.figure for one in self.figures],
            self.motion.places,
            speed=self.motion.speed,
            weights=self.motion.weights,
        )
        by = dict(zip(names, gradients.T, strict=True))
        columns = []
        for one in self.tolerances:
            if not one.point:
                columns.append(by[one.name])
                continue
            (x, y), (over_x, over_y) = ([of[f"{one.point}.{part}"] for part in "xy"] for of in (own, by))
            turns = one.name.endswith(ANGLE)
            columns.append(x * over_y - y * over_x if turns else (x * over_x + y * over_y) / math.hypot(x, y))
        return np.stack(columns, axis=1)


@dataclass(frozen=True)
class ToleranceStudy:
    """What came of it, SI; nan is what designs that do not assemble have. Peaks have the sign of the nominal one.

    ``changes`` (results, tolerances, 2) are those at the lower and the upper limit of each tolerance alone, all else
    nominal. ``corners`` (results, 2) are the least and the largest result where every number is at a limit; of more
    than 12 tolerances those two to which the derivatives point. ``random`` (results, samples) are random designs.
    """

    request: ToleranceRequest
    nominal: Array
    derivatives: Array
    changes: Array
    corners: Array
    random: Array

    @property
    def how(self) -> str:
        """What the derivatives are."""
        return EXACT if is_exact(self.request.mechanism) else DIFFERENCE

    @property
    def has_all_corners(self) -> bool:
        """Whether every corner was worked out."""
        return len(self.request.tolerances) <= ALL_CORNERS

    @cached_property
    def contributions(self) -> Array:
        """By how much each tolerance moves each result, ± (results, tolerances).

        By its derivative; where two tops tie there is none, and it is the larger of the changes.
        """
        linear = np.abs(self.derivatives) * self._sizes
        return np.where(np.isnan(linear), np.max(np.abs(self.changes), axis=2), linear)

    @property
    def deviations(self) -> Array:
        """Standard deviation of each result, by the derivatives (results,)."""
        return np.asarray(np.sqrt(np.sum(self._variances, axis=1)))

    @property
    def shares(self) -> Array:
        """Share of each tolerance in the variance of each result; zero where nothing moves it."""
        total = np.sum(self._variances, axis=1, keepdims=True)
        return np.asarray(self._variances / np.where(total > 0.0, total, 1.0))

    @property
    def worst(self) -> Array:
        """By how much all tolerances together move each result at most, by the derivatives: ± (results,)."""
        return np.asarray(np.sum(self.contributions, axis=1))

    @property
    def assembled(self) -> float:
        """Share of the random designs that assemble at every angle."""
        return float(np.mean(self._assemble))

    @property
    def mean(self) -> Array:
        """Mean of the random designs (results,)."""
        return np.asarray(np.mean(self.random[:, self._assemble], axis=1))

    @property
    def deviation(self) -> Array:
        """Standard deviation of the random designs (results,)."""
        return np.asarray(np.std(self.random[:, self._assemble], axis=1, ddof=1))

    @property
    def quantiles(self) -> Array:
        """The 0.135 % and 99.865 % quantiles of the random designs (results, 2)."""
        return np.asarray(np.quantile(self.random[:, self._assemble], SHARES, axis=1).T)

    @property
    def _assemble(self) -> NDArray[np.bool_]:
        return np.asarray(np.isfinite(self.random).all(axis=0))

    @property
    def _sizes(self) -> Array:
        return np.array([one.plus_minus for one in self.request.tolerances])

    @property
    def _variances(self) -> Array:
        deviation = np.array([one.distribution.deviation for one in self.request.tolerances])
        return np.asarray(np.square(self.contributions * deviation))

    def tornado(self, row: int) -> Tornado:
        """One result for a picture, in the units of the file."""
        one = self.request.figures[row]
        bars = [
            (tolerance.name, float(low), float(high))
            for tolerance, (low, high) in zip(self.request.tolerances, self.changes[row] / one.unit.size, strict=True)
        ]
        return Tornado(one.name, one.unit.name, float(self.nominal[row] / one.unit.size), tuple(bars))


def speed_unit(linkage: Linkage) -> FileUnit:
    """The unit in which the driver's speed is said: rpm, or the file's unit of length per second."""
    if not linkage.is_linear:
        return FileUnit("rpm", RPM)
    return file_unit("m/s", linkage)


def tolerance_request(
    linkage: Linkage, asked: Tolerances, *, angles: int = PLACES, samples: int | None = None, seed: int = 0
) -> ToleranceRequest:
    """What is asked for; of random designs there are 10 000, or 200 of a linkage that goes design by design.

    Raises LinkproofError for names that are not there and for a motion that cannot be.
    """
    mechanism = Mechanism(linkage)
    if asked.speed is None and linkage.is_linear:
        raise LinkproofError(
            f"{asked.origin}speed: expected the driver's speed in {speed_unit(linkage).name}, got nothing; add it"
        )
    speed = (USUAL if asked.speed is None else asked.speed) * speed_unit(linkage).size
    found = tolerances(linkage, asked.table, f"{asked.origin}tolerances.")
    if not asked.results:
        raise LinkproofError(f'{asked.origin}results: expected a figure, as "Mkr.peak", got none; name one')
    try:
        figures = named_figures(mechanism, asked.results)
    except LinkproofError as error:
        raise LinkproofError(f"{asked.origin}{error}") from error
    if samples is None:
        samples = SAMPLES if is_exact(mechanism) else FEW_SAMPLES
    if samples < FEWEST:
        raise LinkproofError(f"--samples: expected {FEWEST} or more random designs, got {samples}; draw more")
    if seed < 0:
        raise LinkproofError(f"--seed: expected a number from 0 on, got {seed}; give another")
    motion = steady_motion(mechanism, speed, samples=angles)
    return ToleranceRequest(mechanism, found, figures, motion, samples, seed)


def tolerance_study(request: ToleranceRequest, announce: Announce = lambda *_: None) -> ToleranceStudy:
    """Work tolerances through; raises LinkproofError where the nominal design or hardly any random one assembles."""
    count, sizes = len(request.tolerances), np.array([one.plus_minus for one in request.tolerances])
    derivatives = request.derivatives()
    alone = np.concatenate([np.zeros((count, 1)), np.diag(-sizes), np.diag(sizes)], axis=1)
    corners = sizes[:, None] * _corners(derivatives)
    draw = np.random.default_rng(request.seed)
    random = np.stack([one.plus_minus * one.distribution.drawn(draw, request.samples) for one in request.tolerances])
    found = request.results(np.concatenate([alone, corners, random], axis=1), announce)
    found = np.stack([_on_one_side(one.figure, row) for one, row in zip(request.figures, found, strict=True)])
    first, last = alone.shape[1], alone.shape[1] + corners.shape[1]
    nominal, changes = found[:, 0], found[:, 1:first] - found[:, :1]
    scattered = found[:, last:]
    whole = np.isfinite(scattered).all(axis=0)
    if not np.all(np.isfinite(nominal)) or np.count_nonzero(whole) < 2:
        raise LinkproofError(
            f"'{request.mechanism.linkage.name}': expected designs that assemble at every angle, got "
            f"{np.count_nonzero(whole)} of {request.samples}; lessen the tolerances"
        )
    return ToleranceStudy(
        request,
        nominal,
        derivatives,
        np.stack([changes[:, :count], changes[:, count:]], axis=2),
        _ends(found[:, first:last]),
        scattered,
    )


def _on_one_side(figure: Figure, values: Array) -> Array:
    """Transmission angles farthest from 90°, all on the side of the first, the nominal: the distance counts."""
    level = middle(figure.signal)
    if figure.reduction is not Reduction.PEAK or not level:
        return values
    return np.asarray(level + np.copysign(values - level, values[0] - level))


def _corners(derivatives: Array) -> Array:
    """Corners, (tolerances, corners), -1 and 1: all of them, or those to which the derivatives of each result point."""
    count = derivatives.shape[1]
    if count <= ALL_CORNERS:
        return np.array([*itertools.product((-1.0, 1.0), repeat=count)]).T
    signs = np.where(derivatives < 0.0, -1.0, 1.0)
    return np.concatenate([-signs, signs]).T


def _ends(values: Array) -> Array:
    """The least and the largest of the corners that assemble; nan where none does."""
    least = np.min(np.where(np.isnan(values), np.inf, values), axis=1)
    largest = np.max(np.where(np.isnan(values), -np.inf, values), axis=1)
    ends = np.stack([least, largest], axis=1)
    return np.where(np.isfinite(ends), ends, np.nan)
