"""The runs of a benchmark, one to a point, as a table, and the questions to it; saved and read back.

Questions are orders, least errors and the point to choose. Times are those of set-up and stepping, each the shortest of
the repeats: a method that steps fast because it builds for long is not cheap.
``points`` are rows of one engine in one quantity of a mechanism and regime, a sweep one method's.
"""

from __future__ import annotations

import math
import statistics
from collections import namedtuple
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np
from pydantic import TypeAdapter
from typing_extensions import TypedDict

from analytic.numerics.arrays import Array
from comparisons.trials.judging.records import RunRecord, Verdict
from comparisons.trials.runs.store import load_study, save_study
from engines.contract import Outcome

if TYPE_CHECKING:
    from pandas import DataFrame

KIND: Final = "bench"
SETTING, METHOD = "setting", "method"


@dataclass(frozen=True, kw_only=True)
class BenchRun(RunRecord):
    """The run of a point; ``errors`` are empty where it did not finish.

    ``kind`` tells a setting, whose steps its adapter fixes (``step`` is None), from a method, which takes the ``step``,
    s, it is requested. ``is_control``: the engine is the reference's control, never ranked. ``repeats`` are all wall
    times of the stepping alone, s. ``detail`` says why, where it did not finish, ``ended`` why its sweep goes no
    further.

    Set-up and stepping are the shortest of the repeats, s, 0 where it did not finish; 0 ``runs`` gave no motion. So is
    ``engine_seconds``, the part of a setting's stepping inside the engine's own calls, clocked in runs of their own;
    None where the adapter does not name these. A quantity that the engine does not tell has no error, and says why.
    """

    is_control: bool
    kind: str
    effort: float | None
    effort_unit: str
    step: float | None
    steps_per_turn: float | None
    repeats: tuple[float, ...] = ()
    engine_seconds: float | None = None
    outcome: str
    detail: str = ""
    ended: str = ""

    @property
    def seconds_median(self) -> float:
        """The median of the repeats, s; 0 without any."""
        return statistics.median(self.repeats) if self.repeats else 0.0

    @property
    def overhead(self) -> float | None:
        """Share of the stepping, of 1, outside the engine's own calls; None where that is not known."""
        if self.engine_seconds is None or not self.seconds:
            return None
        return max(0.0, 1.0 - self.engine_seconds / self.seconds)

    @property
    def is_extrapolated(self) -> bool:
        """Whether several runs were extrapolated."""
        return self.runs > 1

    @property
    def key(self) -> str:
        """The key of the point, unique in the benchmark, as one text: the run's and, of a method, its step."""
        return super().key + ("" if self.step is None else f", step {self.step!r}")

    def columns(self, quantities: Sequence[str]) -> Iterator[dict[str, Any]]:
        """Yield a row for each of its quantities; of one that did not finish, for each of those requested.

        A row has the fields of the run, values derived from it, and those of the quantity's error, by name. A quantity
        that the engine does not tell at all is not provided there. ``finished`` has both an error and a time,
        ``left_out`` says what of a quantity the engine does not tell, ``label`` is the engine's name for a reader.
        """
        derived = ("key", "total_seconds", "seconds_median", "overhead", "is_extrapolated")
        own = vars(self) | {name: getattr(self, name) for name in derived}
        for error in self.errors or [self.blank._replace(quantity=name) for name in quantities]:
            is_lacking = bool(self.errors) and error.error_max is None
            yield {
                **own,
                "label": f"{self.engine} (control)" if self.is_control else self.engine,
                "quantity": error.quantity,
                "unit": error.unit,
                "error_max": error.error_max,
                "error_rms": error.error_rms,
                "peak": error.peak,
                "left_out": error.detail,
                "outcome": Verdict.NOT_PROVIDED.value if is_lacking else self.outcome,
                "detail": error.detail if is_lacking else self.detail,
                "finished": self.outcome == Outcome.FINISHED and error.error_max is not None and bool(self.repeats),
            }


class SavedBench(TypedDict):
    """The document of a benchmark, all but its records."""

    command: str
    conditions: str
    environment: Mapping[str, str]
    extent: Mapping[str, Any]
    mechanisms: list[Mapping[str, str]]
    methods: list[Mapping[str, Any]]  # as the engines describe them
    quantities: list[str]


FORM: Final[TypeAdapter[Any]] = TypeAdapter(SavedBench)


@dataclass(frozen=True)
class Bench:
    """A finished benchmark: its document as saved, and a run per point."""

    document: Mapping[str, Any]
    points: Sequence[BenchRun]

    @property
    def as_dict(self) -> dict[str, Any]:
        """The document and all points with the orders of their sweeps by quantity, JSON-ready, as a new dictionary.

        Points are under "records", each with its "orders".
        """
        orders: dict[str, dict[str, float]] = {point.key: {} for point in self.points}
        for (key, quantity), order in sweep_orders(self.table).items():
            orders[key][quantity] = order
        return {**self.document, "records": [{**point.data, "orders": orders[point.key]} for point in self.points]}

    @cached_property
    def table(self) -> DataFrame:
        """A row for every point and quantity: ``BenchRun.columns``, and the ``order`` of the point's sweep or None."""
        from pandas import DataFrame, Series  # noqa: PLC0415  half a second that a worker process saves

        rows = [row for point in self.points for row in point.columns(self.document["quantities"])]
        table = DataFrame(rows, dtype=object).astype(dict.fromkeys(("finished", "is_control", "is_extrapolated"), bool))
        orders, places = sweep_orders(table), zip(table.key, table.quantity, strict=True)
        return table.assign(order=Series([orders.get(place) for place in places], dtype=object))

    @cached_property
    def noise(self) -> float:
        """The share by which repeats of a point scatter: median over shortest less 1, in the median of all points.

        It is 0 where no point has more than one repeat.
        """
        excess = [point.seconds_median / min(point.repeats) - 1.0 for point in self.points if len(point.repeats) > 1]
        return statistics.median(excess) if excess else 0.0


def save(folder: Path, bench: Bench) -> None:
    """Write a benchmark into a folder, replacing an earlier one; raises LinkproofError where it cannot be written."""
    save_study(folder, KIND, bench.document, ((point.key, *point.written()) for point in bench.points))


def load(folder: Path) -> Bench:
    """Read a benchmark back; no engine is imported. Raises LinkproofError if it is missing or damaged."""
    return Bench(*load_study(folder, KIND, FORM, BenchRun.from_row))


# The order is fitted to errors below the first bound (no solution) and above the second (no step error).
SATURATED = 0.3
ABOVE_FLOOR = 3.0
# Local slopes that differ from the order by less than this are the same slope, seen through scatter.
SLOPE_SHARE, SLOPE_ROOM = 0.25, 0.3
LEAST_POINTS, LEAST_ORDER, LEAST_DROP = 3, 0.4, 3.0
# A refinement that takes less than this factor off no longer improves.
LEAST_GAIN = 1.5
# Largest errors, over the peak, that somebody may want.
WANTED = tuple(10.0**-k for k in range(2, 9))


def is_falling(errors: Sequence[float]) -> bool:
    """Whether the last error, of the finest step, is the least, and below the one before by more than scatter.

    That is by ``LEAST_GAIN``. ``errors`` are from the coarsest step to the finest; one of 0 is not falling.
    """
    if len(errors) < 2 or int(np.argmin(errors)) < len(errors) - 1 or errors[-1] <= 0.0:
        return False
    return errors[-2] / errors[-1] >= LEAST_GAIN


def observed_order(steps: Sequence[float], errors: Sequence[float]) -> float | None:
    """Slope of log error over log step, coarse to fine, where it is steady; None unless three points agree on it.

    ``errors`` are over the peak, not empty. The slope is that of the longest run of refinements whose local slopes
    agree with their own Theil-Sen slope, which an outlier does not move; of equally long runs the finest counts. Points
    at the floor or past it, and points so wrong that they are no solution, are left out.
    """
    best, log_steps = int(np.argmin(errors)), np.log(np.asarray(steps, dtype=float))
    log_errors = np.log(np.maximum(np.asarray(errors, dtype=float), np.finfo(float).tiny))
    lowest = log_errors[best] + (0.0 if is_falling(errors) else math.log(ABOVE_FLOOR))
    usable = [k for k in range(best + 1) if lowest <= log_errors[k] <= math.log(SATURATED)]
    windows: list[tuple[int, int, float]] = []
    for first in range(len(usable)):
        for end in range(first + LEAST_POINTS, len(usable) + 1):
            window = usable[first:end]
            slope = _steady_slope(log_steps[window], log_errors[window])
            windows += [(len(window), window[-1], slope)] if slope is not None else []
    return max(windows)[2] if windows else None


def theil_sen(x: Array, y: Array) -> float:
    """Median of the slopes of y over x, (n,) each, of all pairs of points (P. K. Sen, J. Am. Stat. Assoc. 63, 1968).

    There must be two points, and no two with the same x. SciPy's also works out a confidence interval, which costs ten
    times as much and is not wanted here.
    """
    first, second = np.triu_indices(len(x), 1)
    return float(np.median((y[second] - y[first]) / (x[second] - x[first])))


def _steady_slope(steps: Array, errors: Array) -> float | None:
    """The slope of a window if every refinement in it has about this slope; else None.

    ``steps`` and ``errors`` are logarithms. It must be ``LEAST_ORDER`` or more, and the error fall by ``LEAST_DROP``.
    """
    slope = theil_sen(steps, errors)
    local = np.diff(errors) / np.diff(steps)
    steady = bool(np.all(np.abs(local - slope) <= SLOPE_SHARE * abs(slope) + SLOPE_ROOM))
    return slope if steady and slope >= LEAST_ORDER and errors[0] - errors[-1] >= math.log(LEAST_DROP) else None


def still_improves(errors: Sequence[float]) -> bool:
    """Whether another refinement is worth its price; ``errors`` are those so far, coarse to fine.

    It is not after two in a row that made the error no smaller by ``LEAST_GAIN``, which is more than scatter.
    """
    return len(errors) < LEAST_POINTS or min(errors[-2:]) * LEAST_GAIN < min(errors[:-2])


def sustained(errors: Sequence[float], limit: float) -> int | None:
    """Index of the first error from which all, down to the smallest, are at or below ``limit``.

    Errors, one at least, are given from the coarsest step to the finest. A coarse step can be right by accident; one
    that the next finer step contradicts is not to be relied on. None where the limit is never reached.
    """
    place = int(np.argmin(errors))
    if errors[place] > limit:
        return None
    while place > 0 and errors[place - 1] <= limit:
        place -= 1
    return place


LARGE_OVERHEAD = 0.3  # of the stepping: a larger share of work that is not the engine's is named
Row = Any  # of a table: a named tuple
PLACE = ["mechanism", "variant", "regime"]
FOREMOST = ("Mkr", "phi")  # the quantity by which a place is judged unless the user names others: the first that it has


def rows(points: DataFrame) -> list[Row]:
    """The rows of a table as named tuples, with its columns; ``DataFrame.itertuples`` takes ten times as long."""
    row = _row_type(tuple(points.columns))
    return [row._make(values) for values in points.to_numpy(dtype=object).tolist()]


@cache
def _row_type(columns: tuple[str, ...]) -> Row:
    """The named tuple with these columns, the same class each time."""
    return namedtuple("Row", columns)


def sweeps(points: DataFrame) -> list[DataFrame]:
    """The sweep of every method in every quantity and place: its points that finished, coarse to fine.

    Each is a table of its own; one without a finished point is left out.
    """
    methods = points[points.finished & (points.kind == METHOD)]
    groups = methods.groupby([*PLACE, "quantity", "engine", "setting"], sort=False)
    return [sweep.sort_values("step", ascending=False, kind="stable") for _, sweep in groups]


def least(points: DataFrame) -> Row:
    """The row of the point with the smallest error; every row must have one, and there must be one."""
    return min(rows(points), key=lambda row: row.error_max)


def has_floor(sweep: DataFrame) -> bool:
    """Whether the finest steps fail to lower the least error, so that it is a floor; ``sweep`` is coarse to fine.

    It is False for a single point.
    """
    return len(sweep) > 1 and not is_falling(list(sweep.error_max))


def sweep_orders(points: DataFrame) -> dict[tuple[str, str], float]:
    """The observed order of the sweep of each point, where it has one, by the point's key and the quantity."""
    orders: dict[tuple[str, str], float] = {}
    for sweep in sweeps(points):
        order = observed_order(list(sweep.step), list(sweep.error_max))
        if order is not None:
            orders |= dict.fromkeys(zip(sweep.key, sweep.quantity, strict=True), order)
    return orders


def choices(points: DataFrame) -> list[Row | None]:
    """For every error of ``WANTED`` the cheapest point at or below it; None where there is none.

    ``points`` are one engine's in one quantity of a place. A point of a sweep counts if the finer ones, down to the
    sweep's least error, hold the error too.
    """
    done = points[points.finished]
    settings = rows(done[done.kind == SETTING])
    methods = [rows(sweep) for sweep in sweeps(done)]
    found = []
    for limit in WANTED:
        reaching = [row for row in settings if row.error_max <= limit]
        for method in methods:
            at = sustained([row.error_max for row in method], limit)
            reaching += [] if at is None else [method[at]]
        found.append(min(reaching, key=lambda row: row.total_seconds, default=None))
    return found


def large_overheads(bench: Bench) -> list[Row]:
    """Of every engine and setting the row with the largest overhead, over ``LARGE_OVERHEAD``; the largest first."""
    large = bench.table[bench.table.overhead.astype(float) > LARGE_OVERHEAD]
    worst = large.sort_values("overhead", ascending=False, kind="stable").drop_duplicates(["engine", "setting"])
    return rows(worst)


Regimes: TypeAlias = "Mapping[str, Sequence[DataFrame]]"


def by_regime(bench: Bench) -> Regimes:
    """The places of each regime, a mechanism's rows each, where something finished, in the order measured.

    Keys are the regimes' names.
    """
    regimes: dict[str, list[DataFrame]] = {}
    for place in places(bench):
        if place.finished.any():
            regimes.setdefault(place.regime.iloc[0], []).append(place)
    return regimes


def places(bench: Bench) -> list[DataFrame]:
    """The rows of a benchmark divided by mechanism, variant and regime, a table each, in the order measured."""
    return [place for _, place in bench.table.groupby(PLACE, sort=False)]


def quantities(place: DataFrame) -> list[str]:
    """Names of the quantities that were measured in a place, in the requested order."""
    return list(place.quantity[place.finished].unique())


def foremost(place: DataFrame) -> str:
    """The name of the quantity by which a place is judged: the first of ``FOREMOST`` measured, else the first that is.

    Where nothing finished, the first requested.
    """
    names = quantities(place) or [place.quantity.iloc[0]]
    return next((name for name in FOREMOST if name in names), names[0])


def engines(place: DataFrame, quantity: str = "") -> list[DataFrame]:
    """Every engine's rows in a quantity of a place, a table each, the foremost by default; the control's last."""
    mine = place[place.quantity == (quantity or foremost(place))]
    return sorted((points for _, points in mine.groupby("engine", sort=False)), key=lambda rows: rows.is_control.any())
