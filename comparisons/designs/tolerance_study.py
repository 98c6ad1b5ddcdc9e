"""Effect of tolerances on the results of a linkage: shares of each, the worst case, and many random designs.

Values are SI, arrays over (results, tolerances) or (results,). What is linear follows from derivatives at the nominal
design; corners and random designs are worked out as they are, extremes refined between the crank angles.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import SPEED, numbers
from analytic.designs.derivatives import is_exact
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designs.parameters import NamedFigure, SteadyMotion, mass_words, named_figures
from comparisons.designs.tolerances import ANGLE, LENGTH, Tolerance, Tolerances, tolerances

Array = NDArray[np.float64]

# The request of a tolerance study: results of a linkage whose numbers deviate from nominal, under a motion.


Announce = Callable[[str, int, int], None]  # name of the stage, count done, count of all

FEWEST, MOST = 2, 10**7
SEED: Final = 0  # of the random designs
SAMPLES: Final = 10_000
FEW_SAMPLES: Final = 200  # of a linkage whose groups are followed anew for every design, which takes a second or so
TOGETHER, ALONE = 1000, 5  # designs worked out between two announcements


@dataclass(frozen=True)
class ToleranceRequest:
    """Tolerances of a mechanism, the results they may move, its motion, the random designs, and conditions in words."""

    mechanism: Mechanism
    tolerances: tuple[Tolerance, ...]
    figures: tuple[NamedFigure, ...]
    motion: SteadyMotion
    samples: int
    conditions: str = ""

    @property
    def _nominal_numbers(self) -> dict[str, float]:
        """The nominal numbers, SI, the speed among them."""
        return numbers(self.mechanism.linkage) | {SPEED: abs(self.motion.speed)}

    @property
    def names(self) -> list[str]:
        """The numbers of the description in which the designs differ."""
        return list(self.designs(np.zeros((len(self.tolerances), 1))))

    def designs(self, offsets: Array) -> dict[str, Array]:
        """Numbers of the description (designs,) by name, at offsets (tolerances, designs) from the nominal; SI.

        Masses and inertias that a wide normal distribution makes negative are zero.
        """
        nominal, table = self._nominal_numbers, {}
        polar: dict[str, dict[str, Array]] = {}
        for tolerance, offset in zip(self.tolerances, offsets, strict=True):
            if tolerance.point:
                polar.setdefault(tolerance.point, {})[tolerance.name.removeprefix(tolerance.point)] = offset
            else:
                least = 0.0 if tolerance.parameter.kind in ("mass", "inertia") else -math.inf
                table[tolerance.name] = np.maximum(nominal[tolerance.name] + offset, least)
        for point, moved in polar.items():
            x, y = nominal[f"{point}.x"], nominal[f"{point}.y"]
            length, angle = math.hypot(x, y) + moved.get(LENGTH, 0.0), moved.get(ANGLE, np.zeros(offsets.shape[1]))
            c, s = (length / math.hypot(x, y) * part for part in (np.cos(angle), np.sin(angle)))
            table |= {f"{point}.x": c * x - s * y, f"{point}.y": s * x + c * y}
        return table

    def results(self, offsets: Array, announce: Announce = lambda *_: None) -> Array:
        """Results of designs, (results, designs), SI, at offsets (tolerances, designs) from the nominal; may be nan."""
        designs, count, parts = self.designs(offsets), offsets.shape[1], []
        size = TOGETHER if is_exact(self.mechanism) else ALONE
        for start in range(0, count, size):
            announce("designs", start, count)
            some = {name: values[start : start + size] for name, values in designs.items()}
            parts.append(self.motion.figures(self.mechanism, some, [figure.figure for figure in self.figures]))
        return np.concatenate(parts, axis=1)

    def derivatives(self) -> Array:
        """Derivatives of the results by what has a tolerance, (results, tolerances)."""
        nominal = self._nominal_numbers
        figures = [figure.figure for figure in self.figures]
        _, gradients = self.motion.gradients(self.mechanism, {name: nominal[name] for name in self.names}, figures)
        by = dict(zip(self.names, gradients.T, strict=True))
        columns = []
        for tolerance in self.tolerances:
            if not tolerance.point:
                columns.append(by[tolerance.name])
                continue
            (x, y), (over_x, over_y) = ([of[f"{tolerance.point}.{part}"] for part in "xy"] for of in (nominal, by))
            turns = tolerance.name.endswith(ANGLE)
            columns.append(x * over_y - y * over_x if turns else (x * over_x + y * over_y) / math.hypot(x, y))
        return np.stack(columns, axis=1)


def tolerance_request(
    mechanism: Mechanism,
    motion: SteadyMotion,
    requested: Tolerances,
    *,
    samples: int | None = None,
    conditions: str = "",
) -> ToleranceRequest:
    """The checked request of a tolerance study; ``conditions`` describes the motion in words.

    Without ``samples`` there are 10 000 random designs, or 200 of a linkage that is computed design by design. Raises
    LinkproofError for an unknown name, no results, or too few or too many samples.
    """
    result = tolerances(mechanism.linkage, requested.table, f"{requested.origin}tolerances.", motion.speed)
    if not requested.results:
        raise LinkproofError(f'{requested.origin}results: expected a figure, as "Mkr.peak", got none; name one')
    try:
        figures = named_figures(mechanism, requested.results)
    except LinkproofError as error:
        raise LinkproofError(f"{requested.origin}{error}") from error
    if samples is None:
        samples = SAMPLES if is_exact(mechanism) else FEW_SAMPLES
    if samples < FEWEST:
        raise LinkproofError(f"--samples: expected {FEWEST} or more random designs, got {samples}; draw more")
    if samples > MOST:
        raise LinkproofError(f"--samples: expected {MOST} random designs or fewer, got {samples}; draw fewer")
    request = ToleranceRequest(mechanism, result, figures, motion, samples)
    return replace(request, conditions=conditions + mass_words(mechanism.linkage, request.names))


EXACT, DIFFERENCE = "exact", "difference"
QUANTILES: Final = (0.00135, 0.99865)  # of the quantiles: three standard deviations of a normal distribution
ALL_CORNERS: Final = 12  # tolerances whose corners are all worked out: 4096 designs


@dataclass(frozen=True)
class ToleranceStudy:
    """Results of a tolerance study, SI; nan for designs that do not assemble.

    Transmission angles farthest from 90° are all on the side of the nominal one: an angle and π less it are as far.
    ``changes`` (results, tolerances, 2) are those at the lower and the upper limit of each tolerance alone, all else
    nominal. ``corners`` (results, 2) are the least and the largest result where every number is at a limit; of more
    than 12 tolerances those two to which the derivatives point; ``lost_corners`` are those worked out that do not
    assemble. ``random`` (results, samples) are random designs.
    """

    request: ToleranceRequest
    nominal: Array
    derivatives: Array
    changes: Array
    corners: Array
    random: Array
    lost_corners: int = 0

    @property
    def how(self) -> str:
        """Whether the derivatives are exact or differences."""
        return EXACT if is_exact(self.request.mechanism) else DIFFERENCE

    @property
    def has_all_corners(self) -> bool:
        """Whether every corner was worked out."""
        return len(self.request.tolerances) <= ALL_CORNERS

    @cached_property
    def contributions(self) -> Array:
        """By how much each tolerance moves each result, ± (results, tolerances).

        From its derivative; where two maxima tie no derivative exists, and it is the larger of the changes.
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
        return float(np.mean(self._is_assembled))

    @property
    def mean(self) -> Array:
        """Mean of the random designs (results,)."""
        return np.asarray(np.mean(self.random[:, self._is_assembled], axis=1))

    @property
    def deviation(self) -> Array:
        """Standard deviation of the random designs (results,)."""
        return np.asarray(np.std(self.random[:, self._is_assembled], axis=1, ddof=1))

    @property
    def quantiles(self) -> Array:
        """The 0.135 % and 99.865 % quantiles of the random designs (results, 2)."""
        return np.asarray(np.quantile(self.random[:, self._is_assembled], QUANTILES, axis=1).T)

    @property
    def _is_assembled(self) -> NDArray[np.bool_]:
        """Whether each random design assembles at every angle, (designs,)."""
        return np.asarray(np.isfinite(self.random).all(axis=0))

    @property
    def _sizes(self) -> Array:
        return np.array([tolerance.plus_minus for tolerance in self.request.tolerances])

    @property
    def _variances(self) -> Array:
        deviation = np.array([tolerance.distribution.deviation for tolerance in self.request.tolerances])
        return np.asarray(np.square(self.contributions * deviation))


def tolerance_study(request: ToleranceRequest, announce: Announce = lambda *_: None) -> ToleranceStudy:
    """Work tolerances through; raises LinkproofError where the nominal design or hardly any random one assembles."""
    count, sizes = len(request.tolerances), np.array([tolerance.plus_minus for tolerance in request.tolerances])
    derivatives = request.derivatives()
    alone = np.concatenate([np.zeros((count, 1)), np.diag(-sizes), np.diag(sizes)], axis=1)
    corners = sizes[:, None] * _corners(derivatives)
    from scipy.stats.qmc import LatinHypercube  # noqa: PLC0415 - a second that help does not pay

    drawn = LatinHypercube(count, rng=SEED).random(request.samples).T
    random = np.stack(
        [
            tolerance.plus_minus * tolerance.distribution.quantiles_at(row)
            for tolerance, row in zip(request.tolerances, drawn, strict=True)
        ]
    )
    values = request.results(np.concatenate([alone, corners, random], axis=1), announce)
    first, last = alone.shape[1], alone.shape[1] + corners.shape[1]
    nominal, changes = values[:, 0], values[:, 1:first] - values[:, :1]
    scattered = values[:, last:]
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
        _corner_ranges(values[:, first:last]),
        scattered,
        int(np.count_nonzero(np.isnan(values[:, first:last]).any(axis=0))),
    )


def _corners(derivatives: Array) -> Array:
    """Corners, (tolerances, corners), -1 and 1: all of them, or those to which the derivatives of each result point."""
    count = derivatives.shape[1]
    if count <= ALL_CORNERS:
        return np.array([*itertools.product((-1.0, 1.0), repeat=count)]).T
    signs = np.where(derivatives < 0.0, -1.0, 1.0)
    return np.concatenate([-signs, signs]).T


def _corner_ranges(values: Array) -> Array:
    """The least and the largest result (results, 2) of the corners that assemble; nan where none does."""
    least = np.min(np.where(np.isnan(values), np.inf, values), axis=1)
    largest = np.max(np.where(np.isnan(values), -np.inf, values), axis=1)
    ends = np.stack([least, largest], axis=1)
    return np.where(np.isfinite(ends), ends, np.nan)
