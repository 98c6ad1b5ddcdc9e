"""What a saved benchmark says, place by place and engine by engine, before it is put into a table or a page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from comparisons.work_precision.analysis import (
    WANTED,
    PointChoice,
    Standing,
    SweepFinding,
    choices,
    findings,
    standings,
)
from comparisons.work_precision.records import SETTING, Bench, BenchRecord
from comparisons.work_precision.step_sweep import falls_with_effort
from reports.document.numbers import bound
from reports.document.templates import plain

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

    @property
    def label(self) -> str:
        """The engine's name for a reader."""
        return engine_label(self.engine, self.is_control)

    @property
    def is_control(self) -> bool:
        """Whether it is the reference's control."""
        return any(record.is_control for record in self.records)

    @cached_property
    def choices(self) -> tuple[PointChoice, ...]:
        """The point to choose for every error."""
        return choices(self.records, WANTED)

    @cached_property
    def standings(self) -> tuple[Standing, ...]:
        """The settings against the methods' front; the control has none."""
        return () if self.is_control else standings(self.records)

    def is_own(self, record: BenchRecord) -> bool:
        """Whether a point is a method's at the effort it comes with."""
        return (record.setting, record.effort) in self.own_efforts

    def way(self, record: BenchRecord) -> str:
        """How a point was run, without its step: a setting, or a method with any effort that is not its own.

        Of several runs extrapolated it ends in "x3", with which the name of a method may end already.
        """
        runs = f" x{record.runs}" if record.is_extrapolated else ""
        way = record.setting.removesuffix(runs) + runs
        if record.kind == SETTING or self.is_own(record):
            return way
        return f"{way}, {effort_words(record.effort, record.effort_unit)}"


def engine_label(name: str, is_control: bool) -> str:
    """An engine's name for a reader, who is told of the reference's control."""
    return f"{name} (control)" if is_control else name


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

    @property
    def quantities(self) -> tuple[str, ...]:
        """Quantities that were measured here, in the order asked for."""
        return tuple(dict.fromkeys(record.quantity for record in self.records if record.finished))

    @property
    def foremost(self) -> str:
        """The quantity it is judged by; of a place where nothing finished, the first asked for."""
        found = self.quantities or (self.records[0].quantity,)
        return next((name for name in FOREMOST if name in found), found[0])

    @cached_property
    def _by_quantity(self) -> dict[str, tuple[EngineFacts, ...]]:
        names = dict.fromkeys(record.engine for record in self.records)
        mine: dict[str, dict[str, list[BenchRecord]]] = {}
        for record in self.records:
            mine.setdefault(record.quantity, {name: [] for name in names})[record.engine].append(record)
        return {quantity: tuple(self._facts(rows)) for quantity, rows in mine.items()}

    def _facts(self, rows: Mapping[str, Sequence[BenchRecord]]) -> list[EngineFacts]:
        facts = [EngineFacts(name, tuple(mine), self.own_efforts.get(name, ())) for name, mine in rows.items()]
        return sorted(facts, key=lambda one: one.is_control)

    def engines(self, quantity: str) -> tuple[EngineFacts, ...]:
        """Every engine in one quantity, the control last; those that gave nothing are there too."""
        return self._by_quantity[quantity]

    def ranked(self, quantity: str) -> list[BenchRecord]:
        """What makes the front over all engines: all but the control's points."""
        return [record for record in self.records if record.quantity == quantity and not record.is_control]


Regimes = Mapping[str, Sequence[PlaceFacts]]


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


def regimes(places: Sequence[PlaceFacts]) -> Regimes:
    """The places of each regime where something finished."""
    finished = [place for place in places if place.quantities]
    names = dict.fromkeys(place.regime for place in finished)
    return {name: tuple(place for place in finished if place.regime == name) for name in names}


def judged_by(regimes: Regimes) -> str:
    """The quantities that places are judged by, for a reader."""
    return " or ".join(dict.fromkeys(plain(place.foremost) for places in regimes.values() for place in places))


def engine_labels(bench: Bench) -> dict[str, str]:
    """What a reader is told of all engines of a benchmark, by name, the control last."""
    controls = {record.engine: record.is_control for record in bench.records}
    return {name: engine_label(name, controls[name]) for name in sorted(controls, key=lambda one: (controls[one], one))}


def failed_methods(facts: EngineFacts) -> tuple[str, ...]:
    """Methods and settings that never finished anything, by reason; then what of a quantity was left out."""
    finished = {record.setting for record in facts.records if record.finished}
    reasons = {r.setting: f"{r.outcome}: {r.detail}" for r in reversed(facts.records) if not r.finished}
    names: dict[str, list[str]] = {}
    for name in dict.fromkeys(record.setting for record in facts.records):
        if name not in finished:
            names.setdefault(reasons[name], []).append(name or facts.engine)
    left_out = dict.fromkeys(r.left_out[r.quantity] for r in facts.records if r.finished and r.quantity in r.left_out)
    return (*(f"{', '.join(same)}: {reason}" for reason, same in names.items()), *left_out)
