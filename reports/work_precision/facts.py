"""What a saved benchmark says, place by place and engine by engine, before it is put into a table or a page."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from comparisons.work_precision.analysis import (
    WANTED,
    PointChoice,
    Standing,
    SweepFinding,
    choices,
    findings,
    on_front,
    standings,
)
from comparisons.work_precision.records import SETTING, Bench, BenchRecord
from comparisons.work_precision.step_sweep import falls_with_effort
from reports.text.numbers import bound

# The quantity a place is judged by, where the user names none: the first of these that it has.
FOREMOST = ("Mkr", "phi")


@dataclass(frozen=True)
class EngineFacts:
    """One engine in one quantity of one mechanism and regime; ``records`` are in the order measured."""

    engine: str
    records: tuple[BenchRecord, ...]
    own_efforts: tuple[tuple[str, float | None], ...]

    @cached_property
    def sweeps(self) -> tuple[SweepFinding, ...]:
        """Order and floor of every method at every effort."""
        return findings(self.records)

    @cached_property
    def methods(self) -> tuple[SweepFinding, ...]:
        """Those at the effort a method comes with."""
        return tuple(one for one in self.sweeps if self.is_own(one.first))

    @cached_property
    def choices(self) -> tuple[PointChoice, ...]:
        """The point to choose for every error."""
        return choices(self.records, WANTED)

    @cached_property
    def standings(self) -> tuple[Standing, ...]:
        """The settings against the methods' front."""
        return standings(self.records)

    def is_own(self, record: BenchRecord) -> bool:
        """Whether a point is a method's at the effort it comes with."""
        return (record.setting, record.effort) in self.own_efforts

    def way(self, record: BenchRecord) -> str:
        """How a point was run, without its step: a setting, or a method with any effort that is not its own."""
        if record.kind == SETTING or self.is_own(record):
            return record.setting
        return f"{record.setting}, {effort_words(record.effort, record.effort_unit)}"


def effort_words(effort: float | None, unit: str) -> str:
    """A solver effort: "300 iterations", "relative tolerance 1e-6"; of an engine's own, that it is."""
    if effort is None:
        return f"the engine's own {unit}" if unit else ""
    if falls_with_effort(unit):
        return f"{unit} {bound(effort)}"
    return f"{effort:g} {unit}"


@dataclass(frozen=True)
class PlaceFacts:
    """One mechanism under one regime."""

    mechanism: str
    title: str
    variant: str
    regime: str
    records: tuple[BenchRecord, ...]
    own_efforts: Mapping[str, tuple[tuple[str, float | None], ...]]
    _seen: dict[str, tuple[EngineFacts, ...]] = field(default_factory=dict, compare=False, repr=False)

    @property
    def quantities(self) -> tuple[str, ...]:
        """Quantities that were measured here, in the order asked for."""
        return tuple(dict.fromkeys(record.quantity for record in self.records if record.finished))

    @property
    def foremost(self) -> str:
        """The quantity it is judged by; of a place where nothing finished, the first asked for."""
        found = self.quantities or (self.records[0].quantity,)
        return next((name for name in FOREMOST if name in found), found[0])

    def engines(self, quantity: str) -> tuple[EngineFacts, ...]:
        """Every engine in one quantity, worked out once; engines that gave nothing are there to say so."""
        if quantity not in self._seen:
            mine: dict[str, list[BenchRecord]] = {record.engine: [] for record in self.records}
            for record in self.records:
                mine[record.engine] += [record] if record.quantity == quantity else []
            self._seen[quantity] = tuple(
                EngineFacts(name, tuple(records), self.own_efforts.get(name, ())) for name, records in mine.items()
            )
        return self._seen[quantity]

    def front(self, quantity: str) -> list[BenchRecord]:
        """The points that no point of any engine beats."""
        return on_front(record for record in self.records if record.quantity == quantity)


def places(bench: Bench) -> tuple[PlaceFacts, ...]:
    """All mechanisms and regimes of a benchmark, in the order measured."""
    titles = {told["name"]: told["title"] for told in bench.document["mechanisms"]}
    own: dict[str, list[tuple[str, float | None]]] = {}
    for told in bench.document["methods"]:
        own.setdefault(told["engine"], []).append((told["name"], told["effort"]))
    efforts = {name: tuple(pairs) for name, pairs in own.items()}
    groups: dict[tuple[str, str, str], list[BenchRecord]] = {}
    for record in bench.records:
        groups.setdefault(record.place, []).append(record)
    return tuple(
        PlaceFacts(place[0], titles.get(place[0], place[0]), place[1], place[2], tuple(records), efforts)
        for place, records in groups.items()
    )


def engine_names(bench: Bench) -> tuple[str, ...]:
    """All engines of a benchmark, sorted: an engine keeps its colour within a report."""
    return tuple(sorted({record.engine for record in bench.records}))


def failed_methods(facts: EngineFacts) -> tuple[str, ...]:
    """Methods and settings that never finished anything."""
    finished = {record.setting for record in facts.records if record.finished}
    names = dict.fromkeys(r.setting for r in facts.records if not r.finished and r.setting not in finished)
    reasons = {r.setting: f"{r.outcome}: {r.detail}" for r in reversed(facts.records) if not r.finished}
    return tuple(f"{name or facts.engine}: {reasons[name]}" for name in names)
