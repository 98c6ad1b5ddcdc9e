"""Tolerances of a linkage's numbers as a file states them, in the file's units: lengths, angles, mass centres, others.

``results = ["Mkr.peak", "stroke"]``  figures of a design, as ``analytic.designs.figures`` has them
``speed = 1000``                      of the crank, as ``--speed`` has it
``[tolerances]``                      ± about the number in the linkage's file, in its unit there or one of its own:
``"rod.B.x" = 0.05``, ``"rod.B.x" = "50um"``, ``"rod.B.x" = { plus_minus = 0.05, distribution = "uniform" }``

Beside the numbers of ``analytic.description.changes`` there are the length and the angle of a point, a mass centre or a
direction in its frame: ``rod.B.length``, ``rod.B.angle``. The ± of a normal distribution are three standard deviations.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from scipy.special import ndtri

from analytic.description.changes import SPEED
from analytic.description.file_units import FileUnit
from analytic.description.linkage import Linkage
from analytic.description.loading import read_document
from analytic.description.schema import Finite, TomlTable
from analytic.description.units import factor
from analytic.errors import LinkproofError, UnknownNameError
from comparisons.designs.parameters import LISTING, Parameter, parameter, parameters

Array = NDArray[np.float64]

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
        return np.asarray(ndtri(shares)) / 3.0 if self is Distribution.NORMAL else 2.0 * shares - 1.0


@dataclass(frozen=True)
class Tolerance:
    """A number with its ±, SI; ``point`` is the point or direction whose length or angle it is, else empty."""

    parameter: Parameter
    plus_minus: float
    distribution: Distribution = Distribution.NORMAL
    point: str = ""

    @property
    def name(self) -> str:
        """The parameter's name."""
        return self.parameter.name


@dataclass(frozen=True)
class Tolerances:
    """The request: results by name, the speed in its file's unit, if given, and the table of tolerances.

    ``origin`` begins the message of a fault: the file's name.
    """

    results: tuple[str, ...]
    speed: float | None
    table: Mapping[str, Any]
    origin: str = ""


class ToleranceDocument(TomlTable):
    """A file of tolerances as it is written."""

    results: Annotated[tuple[str, ...], Field(min_length=1, description='a list of figures, as ["Mkr.peak"]')]
    speed: Finite | None = None
    tolerances: Annotated[dict[str, Any], Field(min_length=1, description="a table [tolerances] with a number's ±")]


def read_tolerances(path: Path) -> Tolerances:
    """The tolerances that a file requests; raises LinkproofError if it cannot be read or has other contents."""
    document = read_document(path, "a file of tolerances", ToleranceDocument)
    if document.speed == 0.0:
        raise LinkproofError(f"{path}: speed: expected a finite number other than 0, got 0; correct it")
    return Tolerances(document.results, document.speed, document.tolerances, f"{path}: ")


def tolerances(
    linkage: Linkage, table: Mapping[str, Any], where: str = "", speed: float = math.nan
) -> tuple[Tolerance, ...]:
    """Tolerances of a linkage, and of its driver's ``speed``, SI, by name.

    A value is a number, a text with a unit, or a table of ± and distribution.

    Raises LinkproofError, beginning with ``where`` and the name, for unknown names (with the nearest), for values that
    are not a positive ±, and where a point has tolerances of x or y and of length or angle.
    """
    driven = {SPEED: parameter(linkage, SPEED, speed)}
    xy, known = parameters(linkage) | driven, _all_parameters(linkage) | driven
    result = tuple(_read_tolerance(xy, known, name, value, where) for name, value in _flatten_table(table))
    cartesian = {entry.name[:-2] for entry in result if not entry.point}
    for tolerance in result:
        if tolerance.point and tolerance.point in cartesian:
            raise LinkproofError(
                f"{where}{tolerance.name}: expected either x and y, or length and angle, of '{tolerance.point}', "
                "got of both; leave one out"
            )
    return result


def _flatten_table(table: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Values of a table by full names: rod.B.x without quotes is a table of tables."""
    for key, value in table.items():
        if isinstance(value, Mapping) and not {PLUS_MINUS, DISTRIBUTION} & {*value}:
            yield from _flatten_table(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value


def _all_parameters(linkage: Linkage) -> dict[str, Parameter]:
    """Every number by name, with the length and the angle of what has an x and a y of its own."""
    numbers = parameters(linkage)
    unit = linkage.units.get("angle", "rad")
    for name, number in list(numbers.items()):
        point = name.removesuffix(".x")
        if number.kind not in ("length", "direction") or point == name:
            continue
        x, y = number.value, numbers[f"{point}.y"].value
        angle = Parameter(point + ANGLE, "angle", math.atan2(y, x), FileUnit(unit, factor("angle", unit)))
        if x or y:
            numbers.setdefault(angle.name, angle)
            if number.kind == "length":
                length = replace(number, name=point + LENGTH, value=math.hypot(x, y))
                numbers.setdefault(length.name, length)
    return numbers


def _read_tolerance(
    xy: Collection[str], known: Mapping[str, Parameter], name: str, value: object, where: str
) -> Tolerance:
    """One tolerance from its value in the table; raises LinkproofError that begins with ``where``."""
    if name not in known:
        raise LinkproofError(
            f"{where.removesuffix('tolerances.')}{UnknownNameError('parameter', name, known, LISTING)}"
        )
    distribution = Distribution.NORMAL
    if isinstance(value, Mapping):
        for key in value:
            if key not in (PLUS_MINUS, DISTRIBUTION):
                raise LinkproofError(f"{where}{name}: {UnknownNameError('key', key, (PLUS_MINUS, DISTRIBUTION))}")
        words = value.get(DISTRIBUTION, distribution)
        if words not in tuple(Distribution):
            raise LinkproofError(f"{where}{name}: expected distribution normal or uniform, got {_quoted(words)}")
        distribution, value = Distribution(words), value.get(PLUS_MINUS)
    size = _read_plus_minus(known[name], value, f"{where}{name}")
    if known[name].kind in ("mass", "inertia") and size > known[name].value:
        raise LinkproofError(f"{where}{name}: expected a ± up to the number itself, got a larger one; lessen it")
    if name == SPEED and size > 0.5 * known[name].value:  # so that no random one is on the other side of zero
        raise LinkproofError(f"{where}speed: expected a ± up to half of the speed, got a larger one; lessen it")
    return Tolerance(known[name], size, distribution, "" if name in xy else name.rpartition(".")[0])


def _read_plus_minus(number: Parameter, value: object, where: str) -> float:
    """The ± of a number, SI, from a value of the file; raises LinkproofError for none."""
    if isinstance(value, str):
        try:
            size = number.si(value.replace("±", ""))
        except LinkproofError as error:
            raise LinkproofError(f"{where.removesuffix(number.name)}{error}") from error
    elif _is_number(value):
        size = float(value) * number.unit.size  # type: ignore[arg-type]  # it is a number
    else:
        raise LinkproofError(f"{where}: expected a number, or one with its unit, got {_quoted(value)}; correct it")
    if not size > 0.0:
        raise LinkproofError(f"{where}: expected a positive ±, got {_quoted(value)}; correct it")
    return size


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _quoted(value: object) -> str:
    return "nothing" if value is None else repr(value)
