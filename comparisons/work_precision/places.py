"""The results of a benchmark for one mechanism under one regime, engine by engine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from comparisons.work_precision.analysis import (
    MethodSweep,
    PointChoice,
    SettingComparison,
    choices,
    compare_settings,
    method_sweeps,
)
from comparisons.work_precision.records import Bench, BenchRecord

# The quantity by which a place is judged unless the user names others: the first of these that it has.
FOREMOST = ("Mkr", "phi")
# Methods' names and the solver efforts that they come with.
Efforts = tuple[tuple[str, float | None], ...]


@dataclass(frozen=True)
class EngineFacts:
    """One engine in one quantity of one mechanism and regime; ``records`` are in the order measured."""

    engine: str
    records: tuple[BenchRecord, ...]
    own_efforts: Efforts

    @cached_property
    def sweeps(self) -> tuple[MethodSweep, ...]:
        """Order and floor of every method at every effort."""
        return method_sweeps(self.records)

    @cached_property
    def methods(self) -> tuple[MethodSweep, ...]:
        """The sweeps at a method's default effort."""
        return tuple(sweep for sweep in self.sweeps if self.is_own(sweep.first))

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

    def is_own(self, record: BenchRecord) -> bool:
        """Whether a point belongs to a method at its default effort."""
        return (record.setting, record.effort) in self.own_efforts


@dataclass(frozen=True)
class PlaceFacts:
    """One mechanism under one regime."""

    mechanism: str
    title: str
    variant: str
    regime: str
    records: tuple[BenchRecord, ...]
    own_efforts: Mapping[str, Efforts]

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
        return {quantity: tuple(self._facts(rows)) for quantity, rows in mine.items()}

    def _facts(self, rows: Mapping[str, Sequence[BenchRecord]]) -> list[EngineFacts]:
        facts = [EngineFacts(name, tuple(mine), self.own_efforts.get(name, ())) for name, mine in rows.items()]
        return sorted(facts, key=lambda entry: entry.is_control)

    def ranked(self, quantity: str) -> list[BenchRecord]:
        """The points for the front over all engines: all but the control's."""
        return [record for record in self.records if record.quantity == quantity and not record.is_control]


Regimes = Mapping[str, Sequence[PlaceFacts]]


def places(bench: Bench) -> tuple[PlaceFacts, ...]:
    """All mechanisms and regimes of a benchmark, in the order measured."""
    titles = {facts["name"]: facts["title"] for facts in bench.document["mechanisms"]}
    efforts: dict[str, Efforts] = {}
    for words in bench.document["methods"]:
        efforts[words["engine"]] = (*efforts.get(words["engine"], ()), (words["name"], words["effort"]))
    groups: dict[tuple[str, str, str], list[BenchRecord]] = {}
    for record in bench.records:
        groups.setdefault(record.place, []).append(record)
    return tuple(
        PlaceFacts(name, titles.get(name, name), variant, regime, tuple(records), efforts)
        for (name, variant, regime), records in groups.items()
    )


def by_regime(places: Sequence[PlaceFacts]) -> Regimes:
    """The places of each regime where something finished."""
    finished = [place for place in places if place.quantities]
    names = dict.fromkeys(place.regime for place in finished)
    return {name: tuple(place for place in finished if place.regime == name) for name in names}
