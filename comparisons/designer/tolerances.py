"""Tolerances of a linkage's numbers, as a file states them, and their effect on its results.

``results = ["Mkr.peak", "stroke"]``  figures of a design, as ``analytic.designs.figures`` has them
``speed = 1000``                      of the crank, as ``--speed`` has it
``[tolerances]``                      ± about the number in the linkage's file, in its unit there or one of its own:
``"rod.B.x" = 0.05``, ``"rod.B.x" = "50um"``, ``"rod.B.x" = { plus_minus = 0.05, distribution = "uniform" }``

Beside the numbers of ``analytic.description.changes`` there are the length and the angle of a point, a mass centre or a
direction in its frame: ``rod.B.length``, ``rod.B.angle``. The ± of a normal distribution are three standard deviations.

What is linear follows from derivatives at the nominal design; corners and random designs are worked out as they are,
extremes refined between the crank angles. Values are SI, arrays over (results, tolerances) or (results,).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Final

import numpy as np
from pydantic import Field

from analytic.description.changes import SPEED, numbers
from analytic.description.diagnosis import Source
from analytic.description.linkage import Linkage
from analytic.description.loading import parse_document, read_source
from analytic.description.schema import Finite, TomlTable
from analytic.description.units import FileUnit, Kind, factor
from analytic.designs.derivatives import is_exact
from analytic.errors import LinkproofError, UnknownNameError
from analytic.numerics.arrays import Array, Booleans
from comparisons.designer.parameters import (
    LISTING,
    NamedFigure,
    OpenEndFigures,
    Parameter,
    SteadyCase,
    mass_words,
    named_figures,
    parameter,
    parameters,
)

LENGTH, ANGLE = ".length", ".angle"
PLUS_MINUS, DISTRIBUTION = "plus_minus", "distribution"


class Distribution(StrEnum):
    """How a number scatters about its nominal value."""

    NORMAL = "normal"
    UNIFORM = "uniform"

    @property
    def deviation(self) -> float:
        """The standard deviation, as a share of the ±."""
        return 1.0 / 3.0 if self is Distribution.NORMAL else 1.0 / math.sqrt(3.0)

    def quantiles_at(self, shares: Array) -> Array:
        """Quantiles, as shares of the ±, at cumulative ``shares`` from 0 to 1."""
        from scipy.special import ndtri  # noqa: PLC0415 - a third of a second that other studies do not pay

        return np.asarray(ndtri(shares)) / 3.0 if self is Distribution.NORMAL else 2.0 * shares - 1.0


@dataclass(frozen=True)
class TolerancedNumber:
    """A number with its ±, SI; ``point`` is the point or direction whose length or angle it is, else empty."""

    parameter: Parameter
    plus_minus: float
    distribution: Distribution = Distribution.NORMAL
    point: str = ""

    @property
    def name(self) -> str:
        """The name of the number's parameter."""
        return self.parameter.name


@dataclass(frozen=True)
class Tolerances:
    """The request: results by name, the speed in its file's unit, if given, and the table of tolerances.

    ``source`` is their file, if they have one: faults are told with its line.
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
    """The tolerances that a file requests; raises LinkproofError if it cannot be read or has other contents."""
    source = read_source(path, "a file of tolerances")
    document = parse_document(source, ToleranceDocument)
    if document.speed == 0.0:
        raise source.fault("speed: expected a finite number other than 0, got 0; correct it")
    return Tolerances(document.results, document.speed, document.tolerances, source)


def _fault(source: Source | None, message: str) -> LinkproofError:
    """The error about a key, with the file and line if there is a ``source``; the message begins with the key."""
    return LinkproofError(message) if source is None else source.fault(message)


def tolerances(
    linkage: Linkage, table: Mapping[str, Any], source: Source | None = None, speed: float = math.nan
) -> tuple[TolerancedNumber, ...]:
    """Tolerances of a linkage, and of its driver's ``speed``, SI, by name.

    A value is a number, a text with a unit, or a table of ± and distribution.

    Raises LinkproofError with the name, and its line in the ``source``, for unknown names (with the nearest), for
    values that are not a positive ±, and where a point has tolerances of x or y and of length or angle.
    """
    driven = {SPEED: parameter(linkage, SPEED, speed)}
    xy, known = parameters(linkage) | driven, _all_parameters(linkage) | driven
    result: list[TolerancedNumber] = []
    for name, value in _flatten_table(table):
        try:
            result.append(_read_tolerance(xy, known, name, value))
        except LinkproofError as error:
            words = str(error).removeprefix(f"{name}: ")
            raise _fault(source, f"tolerances.{name}: {words}") from error
    cartesian = {entry.name[:-2] for entry in result if not entry.point}
    for tolerance in result:
        if tolerance.point and tolerance.point in cartesian:
            message = (
                f"expected either x and y, or length and angle, of '{tolerance.point}', got of both; leave one out"
            )
            raise _fault(source, f"tolerances.{tolerance.name}: {message}")
    return tuple(result)


def _flatten_table(table: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Values of a table by full names: rod.B.x without quotes is a table of tables."""
    for key, value in table.items():
        if isinstance(value, Mapping) and not {PLUS_MINUS, DISTRIBUTION} & {*value}:
            yield from _flatten_table(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def _all_parameters(linkage: Linkage) -> dict[str, Parameter]:
    """Every number by name, and for points given by x and y also their length and angle."""
    numbers = parameters(linkage)
    unit = linkage.units.get("angle", "rad")
    for name, number in list(numbers.items()):
        point = name.removesuffix(".x")
        if number.kind not in ("length", "direction") or point == name:
            continue
        x, y = number.value, numbers[f"{point}.y"].value
        angle = Parameter(point + ANGLE, FileUnit(unit, factor("angle", unit)), Kind.ANGLE, math.atan2(y, x))
        if x or y:
            numbers.setdefault(angle.name, angle)
            if number.kind == "length":
                length = replace(number, name=point + LENGTH, value=math.hypot(x, y))
                numbers.setdefault(length.name, length)
    return numbers


def _read_tolerance(xy: Collection[str], known: Mapping[str, Parameter], name: str, value: object) -> TolerancedNumber:
    """One tolerance from its value in the table; raises LinkproofError."""
    if name not in known:
        raise UnknownNameError("parameter", name, known, LISTING)
    distribution = Distribution.NORMAL
    if isinstance(value, Mapping):
        for key in value:
            if key not in (PLUS_MINUS, DISTRIBUTION):
                raise UnknownNameError("key", key, (PLUS_MINUS, DISTRIBUTION))
        words = value.get(DISTRIBUTION, distribution)
        if words not in tuple(Distribution):
            raise LinkproofError(f"expected distribution normal or uniform, got {_quoted(words)}; choose one")
        distribution, value = Distribution(words), value.get(PLUS_MINUS)
    size = _read_plus_minus(known[name], value)
    if known[name].kind in ("mass", "inertia") and size > known[name].value:
        raise LinkproofError("expected a ± up to the number itself, got a larger one; lessen it")
    if name == SPEED and size > 0.5 * known[name].value:  # so that no random one is on the other side of zero
        raise LinkproofError("expected a ± up to half of the speed, got a larger one; lessen it")
    return TolerancedNumber(known[name], size, distribution, "" if name in xy else name.rpartition(".")[0])


def _read_plus_minus(number: Parameter, value: object) -> float:
    """The ± of a number, SI, from a value of the file; raises LinkproofError unless it is positive."""
    if isinstance(value, str):
        size = number.si(value.replace("±", ""))
    elif _is_number(value):
        size = float(value) * number.unit.size  # type: ignore[arg-type]  # it is a number
    else:
        raise LinkproofError(f"expected a number, or one with its unit, got {_quoted(value)}; correct it")
    if not size > 0.0:
        raise LinkproofError(f"expected a positive ±, got {_quoted(value)}; correct it")
    return size


def _is_number(value: object) -> bool:
    """Whether a value is a finite number, and not a truth value."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _quoted(value: object) -> str:
    """A value for an error message: its ``repr``, or "nothing" for None."""
    return "nothing" if value is None else repr(value)


# The request of a tolerance study: results of a linkage whose numbers deviate from nominal, under a motion.


Announce = Callable[[str, int, int], None]  # name of the stage, count done, count of all

FEWEST, MOST = 2, 10**7
SEED: Final = 0  # of the random designs
SAMPLES: Final = 10_000
FEW_SAMPLES: Final = 200  # of a linkage whose groups are followed anew for every design, which takes a second or so
TOGETHER, ALONE = 1000, 5  # designs worked out between two announcements


@dataclass(frozen=True)
class ToleranceRequest:
    """A linkage in a case, tolerances of its numbers, the results they may move, and the number of random designs."""

    case: SteadyCase
    tolerances: tuple[TolerancedNumber, ...]
    figures: tuple[NamedFigure, ...]
    samples: int

    @cached_property
    def at_open_end(self) -> OpenEndFigures:
        """The results whose extremes lie at an open end of the motion."""
        return self.case.open_ends(self.figures)

    @property
    def _nominal_numbers(self) -> dict[str, float]:
        """The nominal numbers, SI, the speed among them."""
        return numbers(self.case.linkage) | {SPEED: abs(self.case.speed)}

    @property
    def names(self) -> list[str]:
        """Names of the numbers of the description in which the designs differ."""
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
        """Results of designs at ``offsets`` (tolerances, designs), SI, (results, designs); nan if not assembled."""
        designs, count, parts = self.designs(offsets), offsets.shape[1], []
        size = TOGETHER if is_exact(self.case.mechanism) else ALONE
        for start in range(0, count, size):
            announce("designs", start, count)
            some = {name: values[start : start + size] for name, values in designs.items()}
            parts.append(self.case.figures(some, self.figures))
        return np.concatenate(parts, axis=1)

    def derivatives(self) -> Array:
        """Derivatives of the results by the toleranced numbers, (results, tolerances), SI."""
        nominal = self._nominal_numbers
        _, gradients = self.case.gradients({name: nominal[name] for name in self.names}, self.figures)
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


def tolerance_request(case: SteadyCase, requested: Tolerances, samples: int | None = None) -> ToleranceRequest:
    """The checked request of a tolerance study.

    Without ``samples`` there are 10 000 random designs, or 200 of a linkage that is computed design by design. Raises
    LinkproofError for an unknown name, no results, or too few or too many samples.
    """
    result = tolerances(case.linkage, requested.table, requested.source, case.speed)
    if not requested.results:
        raise _fault(requested.source, 'results: expected a figure, as "Mkr.peak", got none; name one')
    try:
        figures = named_figures(case.mechanism, requested.results)
    except LinkproofError as error:
        raise _fault(requested.source, f"results: {error}") from error
    if samples is None:
        samples = SAMPLES if is_exact(case.mechanism) else FEW_SAMPLES
    if samples < FEWEST:
        raise LinkproofError(f"--samples: expected {FEWEST} or more random designs, got {samples}; draw more")
    if samples > MOST:
        raise LinkproofError(f"--samples: expected {MOST} random designs or fewer, got {samples}; draw fewer")
    request = ToleranceRequest(case, result, figures, samples)
    words = case.conditions + mass_words(case.linkage, request.names)
    return replace(request, case=replace(case, conditions=words))


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
        """The word for the derivatives: exact or differences."""
        return EXACT if is_exact(self.request.case.mechanism) else DIFFERENCE

    @property
    def has_all_corners(self) -> bool:
        """Whether every corner was worked out."""
        return len(self.request.tolerances) <= ALL_CORNERS

    @cached_property
    def contributions(self) -> Array:
        """The change, ±, of each result by each tolerance alone, (results, tolerances), SI.

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
        return np.array([tolerance.plus_minus for tolerance in self.request.tolerances])

    @property
    def _variances(self) -> Array:
        """The part of each result's variance that each tolerance causes, (results, tolerances)."""
        deviation = np.array([tolerance.distribution.deviation for tolerance in self.request.tolerances])
        return np.asarray(np.square(self.contributions * deviation))


def tolerance_study(request: ToleranceRequest, announce: Announce = lambda *_: None) -> ToleranceStudy:
    """Compute a tolerance study; raises LinkproofError where the nominal or nearly all random designs fail."""
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
            f"'{request.case.linkage.name}': expected designs that assemble at every angle, got "
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
    """Corners (tolerances, corners) of -1 and 1: all, or the two that each result's derivatives point to."""
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
