"""Figures over a space of designs, the grid of several ranges or a list, and which designs have the extremes.

The designs of a grid are numbered in C order, its last axis fastest. Values are in the units of the linkage's file.
"""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from analytic.designs.figures import STROKE
from analytic.designs.results import usual_path
from analytic.errors import AssemblyError, LinkproofError, StructureError, shortened
from analytic.files import read_file
from analytic.numerics.arrays import Array, Booleans
from comparisons.designer.parameters import (
    NamedFigure,
    OpenEndFigures,
    Parameter,
    SteadyCase,
)

if TYPE_CHECKING:
    import xarray


MOST: Final = 2 * 10**7  # values of an axis, and figures of all designs together: they are in memory
ONE_BY_ONE: Final = "design"  # the dimension of a list
RANGE_FORM: Final = "NAME=FIRST:LAST:COUNT, such as rod.B.x=170:180:1000"


@dataclass(frozen=True)
class DesignSpace:
    """The grid of every combination of the ``columns``, the values of each parameter; or their rows, a list.

    Values are in the units of the linkage's file.
    """

    parameters: tuple[Parameter, ...]
    columns: tuple[Array, ...]
    is_list: bool = False

    def __post_init__(self) -> None:
        """Raise LinkproofError for a parameter that comes twice, and for a list whose columns differ in length."""
        names, lengths = [number.name for number in self.parameters], [*map(len, self.columns)]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise LinkproofError(f"expected every parameter once, got {twice} twice: leave one of the two out")
        if self.is_list and len({*lengths}) > 1:
            raise LinkproofError(f"table: expected columns of one length, got {lengths}; correct it")

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of designs along each dimension."""
        return (len(self.columns[0]),) if self.is_list else tuple(map(len, self.columns))

    @property
    def dimensions(self) -> tuple[str, ...]:
        """Names of the dimensions: the parameters of a grid, "design" of a list."""
        return (ONE_BY_ONE,) if self.is_list else tuple(number.name for number in self.parameters)

    @property
    def ends(self) -> Array:
        """Least and largest value of every parameter, (parameters, 2), in the file's units."""
        return np.array([[np.min(values), np.max(values)] for values in self.columns])

    @property
    def count(self) -> int:
        """Number of designs."""
        return math.prod(self.shape)

    def file_values(self, first: int, last: int) -> Array:
        """Values of the designs numbered from ``first`` to below ``last``, in the file's units.

        They are (parameters, designs).
        """
        if self.is_list:
            return np.stack([values[first:last] for values in self.columns])
        places = np.unravel_index(np.arange(first, last), self.shape)
        return np.stack([axis[place] for axis, place in zip(self.columns, places, strict=True)])

    def block(self, first: int, last: int) -> dict[str, Array]:
        """SI values (designs,) of the designs numbered from ``first`` to below ``last``, by the parameter's name."""
        values = self.file_values(first, last)
        return {number.name: row * number.unit.size for number, row in zip(self.parameters, values, strict=True)}


def parameter_range(case: SteadyCase, text: str) -> tuple[Parameter, Array]:
    """The parameter and its values, in equal steps, that a text ``rod.B.x=170:180:1000`` means.

    The values are in the file's unit. Raises UnknownNameError for an unknown parameter, LinkproofError for an unknown
    unit or a malformed range.
    """
    name, equals, ends = text.rpartition("=")
    words = ends.split(":")
    if not equals or len(words) != 3:
        raise LinkproofError(f"--vary: expected {RANGE_FORM}, got '{text}'; correct it")
    number = case.parameter(name.strip())
    first, last = (number.in_file(word) for word in words[:2])
    count = int(words[2]) if re.fullmatch(r"\s*\d{1,18}\s*", words[2], re.ASCII) else 0
    if not 1 <= count <= MOST:
        raise LinkproofError(
            f"--vary {name}: expected a number of values from 1 to {MOST:.0e}, got '{words[2]}'; write {RANGE_FORM}"
        )
    if (count == 1) != (first == last) or not math.isfinite(last - first):
        raise LinkproofError(
            f"--vary {name}: expected {'two values that differ' if count > 1 else 'a single value, twice'} for "
            f"{count} value{'s' if count > 1 else ''}, got {words[0]} and {words[1]}; correct the range or the count"
        )
    return number, np.linspace(first, last, count)


# Designs as a table in a CSV file: a column per parameter, a row per design.

LARGEST_TABLE: Final = 1 << 27  # bytes


def read_table(path: Path, case: SteadyCase) -> DesignSpace:
    """The list of designs of a CSV file, whose first line names parameters: ``rod.B.x`` or ``rod.B.x [cm]``.

    Raises LinkproofError for a file that cannot be read or has no design, an unknown column or unit, a parameter named
    twice, and rows that are no designs.
    """
    start = f"--table '{path}': expected"
    content = read_file(path, "a table of designs", LARGEST_TABLE)
    try:
        lines = enumerate(csv.reader(content.decode("utf-8-sig").splitlines()), start=1)
        rows = [(line, row) for line, row in lines if any(map(str.strip, row))]  # a line without a design is none
    except (UnicodeDecodeError, csv.Error) as error:
        raise LinkproofError(f"{start} comma-separated text in UTF-8, got other bytes; save it as CSV") from error
    if len(rows) < 2:
        raise LinkproofError(f"{start} a head that names parameters and a row per design below, got none; add some")
    (_, names), *rows = rows
    try:
        columns = [_read_column(name, case) for name in names]
    except LinkproofError as error:
        raise LinkproofError(f"{start} a head that names parameters, with commas between them, got: {error}") from error
    values = [_read_row(start, line, row, names) for line, row in rows]
    sizes = np.array([size for _, size in columns])
    return DesignSpace(tuple(number for number, _ in columns), tuple(np.array(values).T * sizes[:, None]), is_list=True)


def _read_column(name: str, case: SteadyCase) -> tuple[Parameter, float]:
    """The parameter that a cell of the first line names, and the size of the column's unit in the file's unit.

    Raises UnknownNameError for an unknown parameter, LinkproofError for a unit that does not measure it.
    """
    name, bracket, unit = name.strip().partition("[")
    entry = case.parameter(name.strip())
    size = entry.si(f"1 {unit.strip().removesuffix(']').strip()}") / entry.unit.size if bracket else 1.0
    return entry, size


def _read_row(start: str, line: int, row: Sequence[str], names: Sequence[str]) -> list[float]:
    """The numbers of a design from the cells of its line; raises LinkproofError for other cells, too few or too many.

    The message begins with ``start``.
    """
    if len(row) != len(names):
        raise LinkproofError(f"{start} {len(names)} cells in every line, got {len(row)} in line {line}; correct it")
    try:
        values = [*map(float, row)]
    except ValueError:
        values = [math.nan]
    if not all(map(math.isfinite, values)):
        raise LinkproofError(f"{start} finite numbers in line {line}, got '{shortened(','.join(row))}'; correct it")
    return values


def given_designs(case: SteadyCase, vary: Any, table: Any) -> tuple[DesignSpace, dict[str, Any] | None]:  # noqa: ANN401
    """The designs of ``vary``, a grid, or ``table``, a list, and None; for Dask arrays one design and the arrays.

    ``vary`` is texts ``NAME=FIRST:LAST:COUNT`` or arrays (n,) by name, ``table`` a path or arrays (n,) by name, and
    exactly one of them has to be given. Arrays are in the units of the file; any one of Dask's stands for all, and they
    are returned by name. Raises LinkproofError for bad input, and ValueError or TypeError for entries of arrays that
    are no numbers.
    """
    if bool(vary) == (table is not None):
        got = "both" if vary else "neither"
        raise LinkproofError(
            f"expected designs by --vary NAME=FIRST:LAST:COUNT or by --table FILE, got {got}: give one of the two"
        )
    if isinstance(table, str | Path):
        return read_table(Path(table), case), None
    if not isinstance(vary, Mapping) and table is None:
        numbers, columns = zip(*(parameter_range(case, text) for text in vary), strict=True)
        return DesignSpace(numbers, columns), None
    given = vary if table is None else table
    values = {str(name): _check_values(str(name), given[name]) for name in given}
    parts = tuple(map(case.parameter, values))
    lazy = any(map(_is_dask_array, values.values()))
    columns = tuple(np.zeros(1) if lazy else column for column in values.values())
    return DesignSpace(parts, columns, is_list=table is not None), values if lazy else None


def _is_dask_array(values: object) -> bool:
    """Whether values are an array of Dask's, which is computed on request."""
    return hasattr(values, "__dask_graph__")


def _check_values(name: str, given: Any) -> Any:  # noqa: ANN401 - arrays of two kinds
    """Values of a parameter as an array (n,), of floats or Dask's own, from a list, an array or a DataArray.

    Raises LinkproofError unless they are a flat list of finite numbers, at least one, and ValueError or TypeError for
    entries that NumPy cannot read as numbers; those of a Dask array are not looked at.
    """
    data = getattr(given, "data", given) if hasattr(given, "dims") else given  # of a DataArray
    values = data if _is_dask_array(data) else np.asarray(data, dtype=float)
    if len(values.shape) != 1 or values.shape == (0,) or not (_is_dask_array(values) or np.all(np.isfinite(values))):
        raise LinkproofError(f"{name}: expected a flat list of finite numbers, got {values!r:.60}; pass such a list")
    return values


USUAL: Final = ("Mkr.peak", "joint_force.peak", "transmission_angle.min", STROKE)  # figures where none are named
PLACES: Final = 8_000_000  # designs times crank angles of a block: half a second of a core, or so
LARGEST: Final = 200_000  # designs of a block, of which a few arrays are in memory
REFINED: Final = 10  # cost of a refined figure over that of a sampled figure


@dataclass(frozen=True)
class SweepRequest:
    """Which figures of which designs in a case, with extremes sampled, or refined between the samples."""

    case: SteadyCase
    space: DesignSpace
    figures: tuple[NamedFigure, ...]
    refine: bool = False

    @property
    def at_open_end(self) -> OpenEndFigures:
        """The figures of the file's own design whose extremes lie at an open end of the motion."""
        return self.case.open_ends(self.figures)

    @property
    def warnings(self) -> list[str]:
        """Sentences on open ends, and on loads over φ while the first or last design moves the dead centres.

        [] without.
        """
        ends = (self.space.block(0, 1), self.space.block(self.space.count - 1, self.space.count))
        designs = [{name: float(values[0]) for name, values in end.items()} for end in ends]
        return [*filter(None, (self.at_open_end.sentence, self.case.loads_that_stay(designs)))]

    def values(self, numbers: Mapping[str, Array], path: str = "auto") -> Array:
        """Figures (figures, designs), in the units of the file, of designs with these numbers (designs,), SI, by name.

        Nan where a design does not assemble. ``path`` is "numpy", "compiled" or "auto". Raises LinkproofError for
        numbers that no design can have.
        """
        values = self.case.figures(numbers, self.figures, refine=self.refine, path=path)
        return np.asarray(values / np.array([figure.unit.size for figure in self.figures])[:, None])

    def own(self) -> Array:
        """Figures (figures,) of the linkage as its file has it, in its units; nan where it cannot make the motion.

        Raises LinkproofError for figures that no design has.
        """
        return self.values({number.name: np.array([number.value]) for number in self.space.parameters})[:, 0]


@dataclass(frozen=True)
class SweepStudy:
    """The figures of all designs, ``values`` (figures, designs), and the ``own`` (figures,) of the linkage's file.

    They are in the units of the file, and nan where a design does not assemble.
    """

    request: SweepRequest
    own: Array
    values: Array

    @cached_property
    def assembles(self) -> Booleans:
        """Which designs assemble at every angle, (designs,): those with a figure that is not nan."""
        return np.asarray(~np.all(np.isnan(self.values), axis=0))

    @property
    def reach(self) -> Array:
        """Least and largest value of each parameter among the designs that assemble, (parameters, 2), in file units.

        Raises ValueError if none assembles.
        """
        shown = self.request.space.file_values(0, len(self.assembles))[:, self.assembles]
        return np.stack([np.min(shown, axis=1), np.max(shown, axis=1)], axis=1)

    def extreme(self, figure: int, way: float) -> int | None:
        """Number of the first design with the largest value of a figure, or with ``way`` -1 the least; None without.

        ``figure`` is its number; ``way`` is 1 for the largest.
        """
        heights = np.where(np.isfinite(self.values[figure]), way * self.values[figure], -np.inf)
        place = int(np.argmax(heights))
        return place if np.isfinite(heights[place]) else None

    @cached_property
    def dataset(self) -> xarray.Dataset:
        """The study as a labelled dataset with names and units, in the units of the file."""
        space = self.request.space
        columns = dict(zip((parameter.name for parameter in space.parameters), space.columns, strict=True))
        return labelled_dataset(self.request, columns, self.values.reshape(-1, *space.shape))


def sweep(request: SweepRequest, announce: Callable[[str, int, int], object] = lambda *_: None) -> SweepStudy:
    """Compute the figures of all designs, block by block.

    ``announce`` is called after each block with "designs", the number finished and the count of all. Raises
    LinkproofError where the space has values that no design can.
    """
    own, count = request.own(), request.space.count
    cost = len(request.case.places) * (REFINED if request.refine else 1)
    size = min(max(1, PLACES // cost), LARGEST)
    # The paths differ by rounding, so that one computes all blocks.
    path = usual_path([figure.figure for figure in request.figures], count * len(request.case.places))
    values = np.empty((len(request.figures), count))
    for first in range(0, count, size):
        last = min(first + size, count)
        values[:, first:last] = request.values(request.space.block(first, last), path)
        announce("designs", last, count)
    return SweepStudy(request, own, values)


def reason_not_assembled(request: SweepRequest) -> str:
    """The sentence why the first design cannot make its motion; "" where it can.

    It cannot be assembled somewhere, leaves an assembly mode open, or stands in a dead position at or between the
    crank angles.
    """
    case, first = request.case, request.space.block(0, 1)
    try:
        moved = case.redesigned({name: float(values[0]) for name, values in first.items()}).mechanism.sweep(case.places)
        for body in case.mechanism.structure.bodies:
            moved.rates(body)
    except (AssemblyError, StructureError) as error:
        return str(error)
    stands = np.all(np.isnan(request.values(first)))
    return f"'{case.linkage.name}' stands in a dead position between two of the crank angles" if stands else ""


def labelled_dataset(request: SweepRequest, values: Mapping[str, Any], figures: Any) -> xarray.Dataset:  # noqa: ANN401
    """A dataset of ``figures`` (figures, *shape) over ``values`` of the parameters, by name, with names and units.

    Both are in the file's units, and may be lazy. Its attributes tell mechanism, variant, conditions, number of angles,
    whether extremes are refined, and the sentence on open ends, if any.
    """
    import xarray  # noqa: PLC0415 - half a second that a sweep without files does not pay

    over = request.space.dimensions
    units = {parameter.name: {"units": parameter.unit.name} for parameter in request.space.parameters}
    return xarray.Dataset(
        {
            figure.name: (over, row, {"units": figure.unit.name})
            for figure, row in zip(request.figures, figures, strict=True)
        },
        coords={name: (name if name in over else ONE_BY_ONE, entry, units[name]) for name, entry in values.items()},
        attrs={
            **({"open_ends": request.at_open_end.sentence} if request.at_open_end.names else {}),
            "mechanism": request.case.linkage.name,
            "variant": request.case.linkage.variant,
            "conditions": request.case.conditions,
            "angles": len(request.case.places),
            "refined": int(request.refine),
        },
    )


def lazy_dataset(request: SweepRequest, values: Mapping[str, Any]) -> xarray.Dataset:
    """Figures of all designs as Dask arrays, a chunk for every combination of the values' chunks, in a dataset.

    ``values`` are arrays of NumPy or Dask by parameter, in the file's units. Raises LinkproofError for figures that no
    design has.
    """
    import dask.array as da  # noqa: PLC0415 - only Dask arrays need it

    request.own()  # raises LinkproofError for figures that no design has
    shape = request.space.shape
    over = [0] * len(values) if request.space.is_list else range(len(shape))
    arrays = [value if _is_dask_array(value) else da.from_array(value, chunks=-1) for value in values.values()]
    pairs = [part for array, axis in zip(arrays, over, strict=True) for part in (array, (axis,))]
    figures = da.blockwise(
        partial(_compute_chunk, request), (len(shape), *range(len(shape))), *pairs,
        new_axes={len(shape): len(request.figures)}, dtype=float, meta=np.empty((0,) * (len(shape) + 1)),
    )  # fmt: skip
    return labelled_dataset(request, values, figures)


def _compute_chunk(request: SweepRequest, *values: Array) -> Array:
    """The figures of the designs that ``values``, one array (n,) of each parameter, span: (figures, *shape).

    All are in the file's units.
    """
    space = replace(request.space, columns=values)
    return request.values(space.block(0, space.count)).reshape(-1, *space.shape)
