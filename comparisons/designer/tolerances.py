"""Tolerances of a linkage's numbers, as a file states them, and their effect on its results.

``results = ["Mkr.peak", "stroke"]``  figures of a design, as ``analytic.designs.figures`` has them
``speed = 1000``                      of the crank, as ``--speed`` has it
``[tolerances]``                      ± about the number in the linkage's file, in its unit there or one of its own:
``"rod.B.x" = 0.05``, ``"rod.B.x" = "50um"``, ``"rod.B.x" = { plus_minus = 0.05, distribution = "uniform" }``

Numbers have the names of ``analytic.description.changes``. The ± of a normal distribution are three standard
deviations.

What is linear follows from derivatives at the nominal design; corners and random designs are worked out as they are,
extremes refined between the crank angles. Values are SI, arrays over (results, tolerances) or (results,).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Final, NamedTuple

import numpy as np
from pydantic import Field

from analytic.description.diagnosis import Source
from analytic.description.linkage import Linkage
from analytic.description.loading import parse_document, read_source
from analytic.description.schema import Finite, TomlTable
from analytic.description.units import Kind
from analytic.designs.derivatives import is_exact
from analytic.errors import LinkproofError, UnknownNameError
from analytic.numerics.arrays import Array, Booleans
from comparisons.designer.parameters import (
    NamedFigure,
    OpenEndFigures,
    Parameter,
    SteadyCase,
    mass_words,
    named_figures,
    parameter,
)

PLUS_MINUS, DISTRIBUTION = "plus_minus", "distribution"
# The largest ± as a share of the number: no mass is negative, and no random speed is on the other side of zero.
LARGEST: Final = {Kind.MASS: 1.0, Kind.INERTIA: 1.0, Kind.SPEED: 0.5}


class Distribution(StrEnum):
    """How a number scatters about its nominal value."""

    NORMAL = "normal"
    UNIFORM = "uniform"

    @property
    def deviation(self) -> float:
        """The standard deviation, as a share of the ±."""
        return 1.0 / 3.0 if self is Distribution.NORMAL else 1.0 / math.sqrt(3.0)

    def quantiles_at(self, shares: Array) -> Array:
        """Quantiles, as shares of the ±, at cumulative ``shares`` from 0 to 1, in their shape."""
        from scipy.special import ndtri  # noqa: PLC0415 - a third of a second that other studies do not pay

        return np.asarray(ndtri(shares)) / 3.0 if self is Distribution.NORMAL else 2.0 * shares - 1.0


class TolerancedNumber(NamedTuple):
    """A number with its ±, SI."""

    parameter: Parameter
    plus_minus: float
    distribution: Distribution

    @property
    def name(self) -> str:
        """The name of the number's parameter."""
        return self.parameter.name


@dataclass(frozen=True)
class Tolerances:
    """The request: results by name, the speed in its file's unit, if given, and the table of tolerances by name.

    The table is as the module's docstring shows it, not read yet. ``source`` is their file, if they have one: faults
    are told with its line.
    """

    results: tuple[str, ...]
    speed: float | None
    table: Mapping[str, Any]
    source: Source | None = None


class ToleranceDocument(TomlTable):
    """A file of tolerances as it is written."""

    results: Annotated[tuple[str, ...], Field(min_length=1, description='a list of figures, as ["Mkr.peak"]')]
    speed: Finite | None = None
    tolerances: Annotated[dict[str, Any], Field(min_length=1, description="a table [tolerances] with a number's ±")]


def read_tolerances(path: Path) -> Tolerances:
    """The tolerances that a file requests; raises LinkproofError if it cannot be read or has other contents.

    A number's ± is not read yet.
    """
    source = read_source(path, "a file of tolerances")
    document = parse_document(source, ToleranceDocument)
    if document.speed == 0.0:
        raise source.fault("speed: expected a finite number other than 0, got 0; correct it")
    return Tolerances(document.results, document.speed, document.tolerances, source)


def tolerances(
    linkage: Linkage, table: Mapping[str, Any], source: Source | None = None, speed: float = math.nan
) -> tuple[TolerancedNumber, ...]:
    """Tolerances of a linkage's numbers, and of its driver's ``speed``, SI, in the order of the table.

    A value is a number, a text with a unit, or a table of ± and distribution. Raises LinkproofError with the name, and
    its line in the ``source``, for unknown names (with the nearest) and for values that are not a positive ±.
    """
    result: dict[str, TolerancedNumber] = {}
    for name, value in _flatten_table(table):
        try:
            result[name] = _read_tolerance(parameter(linkage, name, speed), value)
        except LinkproofError as error:
            raise _fault(source, f"tolerances.{name}: {str(error).removeprefix(f'{name}: ')}") from error
    return tuple(result.values())


def _fault(source: Source | None, message: str) -> LinkproofError:
    """The error about a key, with the file and line if there is a ``source``; the message begins with the key."""
    return LinkproofError(message) if source is None else source.fault(message)


def _flatten_table(table: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield names and values of a table, by full names: rod.B.x without quotes is a table of tables.

    Names begin with ``prefix``.
    """
    for key, value in table.items():
        if isinstance(value, Mapping) and not {PLUS_MINUS, DISTRIBUTION} & {*value}:
            yield from _flatten_table(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def _read_tolerance(number: Parameter, value: object) -> TolerancedNumber:
    """The tolerance of a number from its value in the table; raises LinkproofError for another value.

    That is a ± in the file's unit, a text with a unit, or a table of it under ``plus_minus`` and a ``distribution``,
    normal by default. The ± of a mass, an inertia or a speed is at most its share LARGEST of the number.
    """
    entry: Mapping[str, Any] = value if isinstance(value, Mapping) else {PLUS_MINUS: value}
    for key in entry:
        if key not in (PLUS_MINUS, DISTRIBUTION):
            raise UnknownNameError("key", key, (PLUS_MINUS, DISTRIBUTION))
    how, text = entry.get(DISTRIBUTION, Distribution.NORMAL), str(entry.get(PLUS_MINUS, "nothing"))
    if how not in tuple(Distribution):
        raise LinkproofError(f"expected distribution normal or uniform, got {how!r}; choose one")
    size, most = number.si(text.replace("±", "")), math.inf
    if number.kind in LARGEST:
        most = LARGEST[number.kind] * number.value
    if not 0.0 < size <= most:
        limit = f" up to {most / number.unit.size:.6g} {number.unit.name}" if math.isfinite(most) else ""
        raise LinkproofError(f"expected a positive ±{limit}, got {text}; correct it")
    return TolerancedNumber(number, size, Distribution(how))


Announce = Callable[[str, int, int], None]  # name of the stage, count done, count of all

FEWEST, MOST = 2, 10**7
SEED: Final = 0  # of the random designs
SAMPLES: Final = 10_000
FEW_SAMPLES: Final = 200  # of a linkage whose groups are followed anew for every design, which takes a second or so
TOGETHER, ALONE = 1000, 5  # designs worked out between two announcements
EXACT, DIFFERENCE = "exact", "difference"
QUANTILES: Final = (0.00135, 0.99865)  # of the quantiles: three standard deviations of a normal distribution
ALL_CORNERS: Final = 12  # tolerances whose corners are all worked out: 4096 designs


@dataclass(frozen=True)
class ToleranceStudy:
    """The ``figures`` of a linkage in a case whose numbers have ``tolerances``, SI; nan where designs do not assemble.

    Transmission angles farthest from 90° are all on the side of the nominal one: an angle and π less it are as far.
    ``nominal`` (results,) are those of the file's numbers, ``derivatives`` (results, tolerances) theirs by the numbers.
    ``changes`` (results, tolerances, 2) are those at the lower and the upper limit of each tolerance alone, all else
    nominal. ``corners`` (results, 2) are the least and the largest result where every number is at a limit; of more
    than 12 tolerances those two to which the derivatives point; ``lost_corners`` are those worked out that do not
    assemble. ``random`` (results, samples) are random designs.
    """

    case: SteadyCase
    tolerances: tuple[TolerancedNumber, ...]
    figures: tuple[NamedFigure, ...]
    nominal: Array
    derivatives: Array
    changes: Array
    corners: Array
    random: Array
    lost_corners: int

    @cached_property
    def at_open_end(self) -> OpenEndFigures:
        """The results whose extremes lie at an open end of the nominal motion, with a sentence on them."""
        return self.case.open_ends(self.figures)

    @property
    def how(self) -> str:
        """The word for how derivatives are found: "exact" or "difference"."""
        return EXACT if is_exact(self.case.mechanism) else DIFFERENCE

    @property
    def has_all_corners(self) -> bool:
        """Whether every corner was worked out."""
        return len(self.tolerances) <= ALL_CORNERS

    @cached_property
    def contributions(self) -> Array:
        """The change, ±, of each result by each tolerance alone, (results, tolerances), SI.

        It is from the derivative; where two maxima tie no derivative exists, and it is the larger of the changes.
        """
        linear = np.abs(self.derivatives) * self._sizes
        return np.where(np.isnan(linear), np.max(np.abs(self.changes), axis=2), linear)

    @property
    def deviations(self) -> Array:
        """Standard deviation of each result by the derivatives, (results,), SI."""
        return np.asarray(np.sqrt(np.sum(self._variances, axis=1)))

    @property
    def shares(self) -> Array:
        """Share of each tolerance in the variance of each result, (results, tolerances); 0 where nothing moves it."""
        total = np.sum(self._variances, axis=1, keepdims=True)
        return np.asarray(self._variances / np.where(total > 0.0, total, 1.0))

    @property
    def worst(self) -> Array:
        """The largest change, ±, of each result by all tolerances together, by the derivatives, (results,), SI."""
        return np.asarray(np.sum(self.contributions, axis=1))

    @property
    def assembled(self) -> float:
        """Share of the random designs that assemble at every angle."""
        return float(np.mean(self._is_assembled))

    @property
    def mean(self) -> Array:
        """Mean of the results of random designs that assemble, (results,), SI."""
        return np.asarray(np.mean(self.random[:, self._is_assembled], axis=1))

    @property
    def deviation(self) -> Array:
        """Standard deviation of the results of random designs that assemble, (results,), SI."""
        return np.asarray(np.std(self.random[:, self._is_assembled], axis=1, ddof=1))

    @property
    def quantiles(self) -> Array:
        """The 0.135 % and 99.865 % quantiles of random designs that assemble, (results, 2), SI."""
        return np.asarray(np.quantile(self.random[:, self._is_assembled], QUANTILES, axis=1).T)

    @property
    def _is_assembled(self) -> Booleans:
        """Whether each random design assembles at every angle, (designs,)."""
        return np.asarray(np.isfinite(self.random).all(axis=0))

    @property
    def _sizes(self) -> Array:
        """The ± of every tolerance, SI, (tolerances,)."""
        return np.array([tolerance.plus_minus for tolerance in self.tolerances])

    @property
    def _variances(self) -> Array:
        """The part of each result's variance that each tolerance causes, (results, tolerances), SI squared."""
        deviation = np.array([tolerance.distribution.deviation for tolerance in self.tolerances])
        return np.asarray(np.square(self.contributions * deviation))


def tolerance_study(
    case: SteadyCase, requested: Tolerances, samples: int | None = None, announce: Announce = lambda *_: None
) -> ToleranceStudy:
    """Compute a tolerance study of a linkage in a case.

    ``announce`` is called before each block of designs with "designs", the number begun and the count of all. Without
    ``samples`` there are 10 000 random designs, or 200 of a linkage that is computed design by design. Raises
    LinkproofError for an unknown name, no results, too few or too many samples, and where the nominal or nearly all
    random designs fail.
    """
    numbers = tolerances(case.linkage, requested.table, requested.source, case.speed)
    figures, samples = _checked_results(case, requested), _checked_samples(case, samples)
    case = replace(case, conditions=case.conditions + mass_words(case.linkage, (number.name for number in numbers)))
    _, derivatives = case.gradients({number.name: number.parameter.value for number in numbers}, figures)
    count, sizes = len(numbers), np.array([number.plus_minus for number in numbers])
    parts = [
        np.zeros((count, 1)), np.diag(-sizes), np.diag(sizes),
        sizes[:, None] * _corners(derivatives), _random_offsets(numbers, samples),
    ]  # fmt: skip
    values = _results(case, numbers, figures, np.concatenate(parts, axis=1), announce)
    borders = np.cumsum([part.shape[1] for part in parts[:-1]])
    nominal, low, high, corners, random = np.split(values, borders, axis=1)
    whole = np.count_nonzero(np.isfinite(random).all(axis=0))
    if not np.all(np.isfinite(nominal)) or whole < FEWEST:
        raise LinkproofError(
            f"'{case.linkage.name}': expected designs that assemble at every angle, got {whole} of {samples}; lessen "
            "the tolerances"
        )
    changes, lost = np.stack([low - nominal, high - nominal], axis=2), np.isnan(corners).any(axis=0)
    return ToleranceStudy(
        case, numbers, figures, nominal[:, 0], derivatives, changes, _corner_ranges(corners), random,
        int(np.count_nonzero(lost)),
    )  # fmt: skip


def _checked_results(case: SteadyCase, requested: Tolerances) -> tuple[NamedFigure, ...]:
    """The requested figures; raises LinkproofError, with the line in their file, for none or an unknown one."""
    if not requested.results:
        raise _fault(requested.source, 'results: expected a figure, as "Mkr.peak", got none; name one')
    try:
        return named_figures(case.mechanism, requested.results)
    except LinkproofError as error:
        raise _fault(requested.source, f"results: {error}") from error


def _checked_samples(case: SteadyCase, samples: int | None) -> int:
    """The number of random designs, the usual one for None.

    Raises LinkproofError for fewer than FEWEST or more than MOST.
    """
    if samples is None:
        return SAMPLES if is_exact(case.mechanism) else FEW_SAMPLES
    if samples < FEWEST:
        raise LinkproofError(f"--samples: expected {FEWEST} or more random designs, got {samples}; draw more")
    if samples > MOST:
        raise LinkproofError(f"--samples: expected {MOST} random designs or fewer, got {samples}; draw fewer")
    return samples


def _random_offsets(numbers: Sequence[TolerancedNumber], samples: int) -> Array:
    """Random distances (tolerances, samples), SI, of the numbers from their nominal values, the same every time.

    They are a Latin hypercube's, spread as each number's distribution says.
    """
    from scipy.stats.qmc import LatinHypercube  # noqa: PLC0415 - a second that help does not pay

    drawn = LatinHypercube(len(numbers), rng=SEED).random(samples).T
    rows = zip(numbers, drawn, strict=True)
    return np.stack([number.plus_minus * number.distribution.quantiles_at(row) for number, row in rows])


def _results(
    case: SteadyCase,
    numbers: Sequence[TolerancedNumber],
    figures: Sequence[NamedFigure],
    offsets: Array,
    announce: Announce,
) -> Array:
    """Results of designs at ``offsets`` (tolerances, designs) from the nominal numbers, SI, (results, designs).

    Nan where a design does not assemble. Masses and inertias that a wide normal distribution makes negative are zero.
    ``announce`` is called before every block with "designs", the number begun and the count of all.
    """
    least = [0.0 if number.parameter.kind in (Kind.MASS, Kind.INERTIA) else -math.inf for number in numbers]
    nominal = np.array([number.parameter.value for number in numbers])
    designs, count = np.maximum(nominal[:, None] + offsets, np.array(least)[:, None]), offsets.shape[1]
    size, parts = TOGETHER if is_exact(case.mechanism) else ALONE, []
    for start in range(0, count, size):
        announce("designs", start, count)
        some = designs[:, start : start + size]
        parts.append(case.figures({number.name: row for number, row in zip(numbers, some, strict=True)}, figures))
    return np.concatenate(parts, axis=1)


def _corners(derivatives: Array) -> Array:
    """Corners (tolerances, corners) of -1 and 1: all, or of many tolerances two for each result.

    To those two the ``derivatives`` (results, tolerances) point.
    """
    count = derivatives.shape[1]
    if count <= ALL_CORNERS:
        return np.array([*itertools.product((-1.0, 1.0), repeat=count)]).T
    signs = np.where(derivatives < 0.0, -1.0, 1.0)
    return np.concatenate([-signs, signs]).T


def _corner_ranges(values: Array) -> Array:
    """The least and the largest result (results, 2) of ``values`` (results, corners) that are no nan.

    Nan without any.
    """
    least = np.min(np.where(np.isnan(values), np.inf, values), axis=1)
    largest = np.max(np.where(np.isnan(values), -np.inf, values), axis=1)
    ends = np.stack([least, largest], axis=1)
    return np.where(np.isfinite(ends), ends, np.nan)
