"""The analysis of a benchmark's records: orders, least errors, fronts, the point to choose, and the settings' standing.

Pure functions of records. Times are those of set-up and stepping, each the shortest of the repeats: a method that steps
fast because it builds for long is not cheap.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from comparisons.work_precision.records import METHOD, SETTING, Bench, BenchRecord, PointRecord, split_by_quantity
from engines.contract import Setting

Array = NDArray[np.float64]

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
    """Whether the finest step has the least error, smaller by more than scatter than that of the step before."""
    if len(errors) < 2 or int(np.argmin(errors)) < len(errors) - 1 or errors[-1] <= 0.0:
        return False
    return errors[-2] / errors[-1] >= LEAST_GAIN


def observed_order(steps: Sequence[float], errors: Sequence[float]) -> float | None:
    """Slope of log error over log step where it is steady; None unless three points agree on it.

    The longest run of refinements counts, of equal ones the finest, whose local slopes agree with their own Theil-Sen
    slope, which an outlier does not move. Points at the floor or past it, and those so wrong that they are no solution,
    are left out.
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
    """Median of the slopes between all pairs of points (P. K. Sen, J. Am. Stat. Assoc. 63, 1968).

    SciPy's also works out a confidence interval, which costs ten times as much and is not wanted here.
    """
    first, second = np.triu_indices(len(x), 1)
    return float(np.median((y[second] - y[first]) / (x[second] - x[first])))


def _steady_slope(steps: Array, errors: Array) -> float | None:
    """The slope of a window whose every refinement has that slope, near enough."""
    slope = theil_sen(steps, errors)
    local = np.diff(errors) / np.diff(steps)
    steady = bool(np.all(np.abs(local - slope) <= SLOPE_SHARE * abs(slope) + SLOPE_ROOM))
    return slope if steady and slope >= LEAST_ORDER and errors[0] - errors[-1] >= math.log(LEAST_DROP) else None


def still_improves(errors: Sequence[float]) -> bool:
    """Whether another refinement is worth its price: not after two in a row without a smaller error."""
    if len(errors) < LEAST_POINTS:
        return True
    return min(errors[-2:]) * LEAST_GAIN < min(errors[:-2])


def pareto(costs: Sequence[float], errors: Sequence[float]) -> NDArray[np.bool_]:
    """Which of the points (n,) no other beats, that is, is at most as dear and as wrong, and less in one of the two."""
    order = np.lexsort((errors, costs))
    unbeaten = np.zeros(len(costs), dtype=bool)
    least, at = math.inf, math.nan
    for k in order:
        # Sorted by cost, then error: only a smaller error, or a twin of the last point on the front, is not beaten.
        if errors[k] < least or (errors[k] == least and costs[k] == at):
            unbeaten[k] = True
            least, at = errors[k], costs[k]
    return unbeaten


def sustained(errors: Sequence[float], limit: float) -> int | None:
    """Place of the coarsest step from which on every finer one, down to the smallest error, is at or below ``limit``.

    A coarse step can be right by accident; one that the next finer step contradicts is not to be relied on. None where
    the error is never reached.
    """
    place = int(np.argmin(errors))
    if errors[place] > limit:
        return None
    while place > 0 and errors[place - 1] <= limit:
        place -= 1
    return place


def price(costs: Sequence[float], errors: Sequence[float], limit: float) -> float | None:
    """The cost at which the error of a sweep, coarse to fine, falls to ``limit``, by logarithms between two points.

    None where it never gets there.
    """
    place = sustained(errors, limit)
    if place is None:
        return None
    if place == 0 or errors[place] <= 0.0:
        return float(costs[place])
    above, below = math.log(errors[place - 1] / limit), math.log(limit / errors[place])
    share = above / (above + below)
    return math.exp((1.0 - share) * math.log(costs[place - 1]) + share * math.log(costs[place]))


@dataclass(frozen=True)
class MethodSweep:
    """One method in one quantity: its points that finished, coarse to fine."""

    records: tuple[BenchRecord, ...]

    @property
    def first(self) -> BenchRecord:
        """The coarsest point, for all that the points share."""
        return self.records[0]

    @property
    def least(self) -> BenchRecord:
        """The point of the smallest error."""
        return min(self.records, key=_largest_error)

    @cached_property
    def seconds(self) -> tuple[float, ...]:
        """Shortest time of each point, set-up and stepping, s."""
        return tuple(record.total_seconds for record in self.records)

    @cached_property
    def errors(self) -> tuple[float, ...]:
        """The largest error of each point, over the peak."""
        return tuple(map(_largest_error, self.records))

    @cached_property
    def order(self) -> float | None:
        """The observed order; None unless three points agree on it."""
        return observed_order([record.step or 0.0 for record in self.records], self.errors)

    @property
    def has_floor(self) -> bool:
        """Whether finer steps do not lower the least error."""
        return len(self.errors) > 1 and not is_falling(self.errors)


@dataclass(frozen=True)
class PointChoice:
    """The cheapest point of an engine at or below an error; ``record`` is None where the engine never gets there.

    ``closest`` is the engine's point of the smallest error.
    """

    record: BenchRecord | None
    closest: BenchRecord


@dataclass(frozen=True)
class SettingComparison:
    """A setting against the methods' front: ``ratio`` of its time to the cheapest method's at the setting's error.

    ``best`` is compared with all methods, every other setting with those of a single run.
    ``rival`` is the measured point behind that price, None where no method gets there: then the ratio is None too. A
    ratio below one is a setting ahead of every method.
    """

    record: BenchRecord
    rival: BenchRecord | None
    rival_seconds: float | None

    @property
    def ratio(self) -> float | None:
        """Time of the setting over the cheapest method's at the same error."""
        return None if self.rival_seconds is None else self.record.total_seconds / self.rival_seconds


def method_sweeps(records: Iterable[BenchRecord]) -> tuple[MethodSweep, ...]:
    """The methods' sweeps among these records, in the order they appear."""
    groups: dict[tuple[object, ...], list[BenchRecord]] = {}
    for record in records:
        if record.kind == METHOD and record.finished:
            groups.setdefault(record.sweep, []).append(record)
    return tuple(
        MethodSweep(tuple(sorted(group, key=lambda record: -(record.step or 0.0)))) for group in groups.values()
    )


def judged(points: Sequence[PointRecord]) -> tuple[PointRecord, ...]:
    """Points with their orders, and the quantities in which they are on their engine's front, filled in."""
    records = split_by_quantity(points, ())
    orders: dict[str, dict[str, float]] = {}
    for sweep in method_sweeps(records):
        if (order := sweep.order) is not None:
            for record in sweep.records:
                orders.setdefault(record.key, {})[record.quantity] = order
    fronts: dict[str, list[str]] = {}
    for group in group_by_engine(records).values():
        for record in (record for part in split_by_runs(group) for record in on_front(part)):
            fronts.setdefault(record.key, []).append(record.quantity)
    return tuple(
        replace(point, orders=orders.get(point.key, {}), fronts=tuple(fronts.get(point.key, ()))) for point in points
    )


Key = tuple[str, str, str, str, str]


def group_by_engine(records: Iterable[BenchRecord]) -> dict[Key, list[BenchRecord]]:
    """Records by mechanism, variant, regime, quantity and engine, in the order they appear."""
    groups: dict[Key, list[BenchRecord]] = {}
    for record in records:
        groups.setdefault((*record.place, record.quantity, record.engine), []).append(record)
    return groups


def split_by_runs(records: Iterable[BenchRecord]) -> tuple[list[BenchRecord], list[BenchRecord]]:
    """Single runs, and those made of several."""
    parts: tuple[list[BenchRecord], list[BenchRecord]] = ([], [])
    for record in records:
        parts[record.is_extrapolated].append(record)
    return parts


def on_front(records: Iterable[BenchRecord]) -> list[BenchRecord]:
    """The records of one quantity that no other beats in both time and error, by time."""
    finished = [record for record in records if record.finished]
    unbeaten = pareto([_seconds(record) for record in finished], [_largest_error(record) for record in finished])
    return sorted((record for record, keep in zip(finished, unbeaten, strict=True) if keep), key=_seconds)


_seconds = attrgetter("total_seconds")


def _largest_error(record: BenchRecord) -> float:
    assert record.error_max is not None
    return record.error_max


def choices(records: Sequence[BenchRecord], limits: Sequence[float] = WANTED) -> tuple[PointChoice, ...]:
    """The point to choose for every error, among one engine's records of one quantity; empty if nothing finished.

    A point of a sweep counts if the finer ones, down to the sweep's least error, hold the error too.
    """
    finished = [record for record in records if record.finished]
    if not finished:
        return ()
    closest = min(finished, key=lambda record: (_largest_error(record), _seconds(record)))
    return tuple(
        PointChoice(min(_points_reaching(finished, error), key=_seconds, default=None), closest) for error in limits
    )


def _points_reaching(records: Sequence[BenchRecord], limit: float) -> Iterator[BenchRecord]:
    """Settings at or below an error, and of every sweep its coarsest step that holds it."""
    yield from (record for record in records if record.kind == SETTING and _largest_error(record) <= limit)
    for sweep in method_sweeps(records):
        place = sustained(sweep.errors, limit)
        if place is not None:
            yield sweep.records[place]


def compare_settings(records: Sequence[BenchRecord]) -> tuple[SettingComparison, ...]:
    """How far off the methods' front each setting is, among one engine's records of one quantity."""
    sweeps = method_sweeps(records)
    results = []
    for record in records:
        if record.kind == SETTING and record.finished:
            rivals = [sweep for sweep in sweeps if record.setting == Setting.BEST or not sweep.first.is_extrapolated]
            prices = [(price(sweep.seconds, sweep.errors, _largest_error(record)), sweep) for sweep in rivals]
            met = [(cost, sweep) for cost, sweep in prices if cost is not None]
            cheapest = min(met, key=lambda pair: pair[0], default=None)
            if cheapest is None:
                results.append(SettingComparison(record, None, None))
            else:
                place = sustained(cheapest[1].errors, _largest_error(record))
                assert place is not None
                results.append(SettingComparison(record, cheapest[1].records[place], cheapest[0]))
    return tuple(results)


# The results of a benchmark for one mechanism under one regime, engine by engine.


# The quantity by which a place is judged unless the user names others: the first of these that it has.
FOREMOST = ("Mkr", "phi")


@dataclass(frozen=True)
class EngineFacts:
    """One engine in one quantity of one mechanism and regime; ``records`` are in the order measured."""

    engine: str
    records: tuple[BenchRecord, ...]

    @cached_property
    def sweeps(self) -> tuple[MethodSweep, ...]:
        """The sweep of every method over its steps."""
        return method_sweeps(self.records)

    @property
    def is_control(self) -> bool:
        """Whether it is the reference's control."""
        return any(record.is_control for record in self.records)

    @cached_property
    def choices(self) -> tuple[PointChoice, ...]:
        """The point to choose for every error; empty if nothing finished."""
        return choices(self.records)

    @cached_property
    def setting_comparisons(self) -> tuple[SettingComparison, ...]:
        """The settings compared with the methods' front; empty for the control."""
        return () if self.is_control else compare_settings(self.records)


@dataclass(frozen=True)
class PlaceFacts:
    """One mechanism under one regime."""

    mechanism: str
    title: str
    variant: str
    regime: str
    records: tuple[BenchRecord, ...]

    @property
    def quantities(self) -> tuple[str, ...]:
        """Quantities that were measured here, in the requested order."""
        return tuple(dict.fromkeys(record.quantity for record in self.records if record.finished))

    @property
    def foremost(self) -> str:
        """The quantity it is judged by; of a place where nothing finished, the first requested."""
        names = self.quantities or (self.records[0].quantity,)
        return next((name for name in FOREMOST if name in names), names[0])

    def engines(self, quantity: str) -> tuple[EngineFacts, ...]:
        """Every engine in one quantity, the control last; those that gave nothing are there too."""
        return self._by_quantity[quantity]

    @cached_property
    def _by_quantity(self) -> dict[str, tuple[EngineFacts, ...]]:
        names = dict.fromkeys(record.engine for record in self.records)
        mine: dict[str, dict[str, list[BenchRecord]]] = {}
        for record in self.records:
            mine.setdefault(record.quantity, {name: [] for name in names})[record.engine].append(record)
        return {quantity: tuple(self._engine_facts(rows)) for quantity, rows in mine.items()}

    def _engine_facts(self, rows: Mapping[str, Sequence[BenchRecord]]) -> list[EngineFacts]:
        facts = [EngineFacts(name, tuple(mine)) for name, mine in rows.items()]
        return sorted(facts, key=lambda entry: entry.is_control)

    def rankable_records(self, quantity: str) -> list[BenchRecord]:
        """The points for the front over all engines, as measured: all but those of the reference's control."""
        return [record for record in self.records if record.quantity == quantity and not record.is_control]


Regimes = Mapping[str, Sequence[PlaceFacts]]


def places(bench: Bench) -> tuple[PlaceFacts, ...]:
    """All mechanisms and regimes of a benchmark, in the order measured."""
    titles = {facts["name"]: facts["title"] for facts in bench.document["mechanisms"]}
    groups: dict[tuple[str, str, str], list[BenchRecord]] = {}
    for record in bench.records:
        groups.setdefault(record.place, []).append(record)
    return tuple(
        PlaceFacts(name, titles.get(name, name), variant, regime, tuple(records))
        for (name, variant, regime), records in groups.items()
    )


def by_regime(places: Sequence[PlaceFacts]) -> Regimes:
    """The places of each regime where something finished."""
    finished = [place for place in places if place.quantities]
    names = dict.fromkeys(place.regime for place in finished)
    return {name: tuple(place for place in finished if place.regime == name) for name in names}
