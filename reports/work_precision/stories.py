"""How an engine's settings stand against its fixed-step methods over all mechanisms: why they are what they are."""

from __future__ import annotations

import statistics
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from comparisons.work_precision.analysis import Standing
from comparisons.work_precision.step_sweep import SATURATED, price
from engines.contract import Setting
from reports.text.numbers import error, figure, seconds
from reports.work_precision.facts import EngineFacts, PlaceFacts

LEAD = (
    "Why the settings are what they are: each against the engine's own methods at fixed steps, at the error it comes "
    "to itself, case by case (a mechanism under a regime). Ratios that name no case are medians."
)


@dataclass(frozen=True)
class SettingStory:
    """How a setting of one engine stands over all places, in a few sentences; ``used`` is how it ran in the first."""

    engine: str
    setting: str
    told: str
    used: str


@dataclass(frozen=True)
class _Case:
    """A setting in one place."""

    place: PlaceFacts
    facts: EngineFacts
    standing: Standing

    @property
    def error(self) -> float:
        return self.standing.record.error_max or 0.0

    def price(self, wanted: float) -> float | None:
        """What the cheapest method costs at an error, s."""
        prices = (price(one.points.seconds, one.points.errors, wanted) for one in self.facts.sweeps)
        return min((one for one in prices if one is not None), default=None)


def stories(found: Iterable[PlaceFacts], noise: float) -> tuple[SettingStory, ...]:
    """Why naive, tuned and best are what they are, by the figures: one story per engine and setting."""
    groups: dict[tuple[str, str], list[_Case]] = {}
    for place in found:
        for facts in place.engines(place.foremost):
            for one in facts.standings:
                groups.setdefault((facts.engine, one.record.setting), []).append(_Case(place, facts, one))
    ordered = sorted(groups.items(), key=lambda item: (item[0][0], _rank(item[0][1])))
    return tuple(
        SettingStory(name, setting, ". ".join(_sentences(group, noise)) + ".", _used(group[0]))
        for (name, setting), group in ordered
    )


def _rank(setting: str) -> int:
    names = [one.value for one in Setting]
    return names.index(setting) if setting in names else len(names)


def _used(case: _Case) -> str:
    told = case.standing.record.used
    return f"As run on {case.place.mechanism}, {case.place.regime}: {told}." if told else ""


def _sentences(group: Sequence[_Case], noise: float) -> list[str]:
    times = [case.standing.record.seconds_min or 0.0 for case in group]
    solved = [case for case in group if case.error <= SATURATED]
    met = [case for case in solved if case.standing.ratio is not None]
    told = [f"{_span([case.error for case in group], error)} in {_span(times, seconds)}"]
    if len(solved) < len(group):
        told.append(f"It is no solution at all in {_share(len(group) - len(solved), len(group))}")
    if met:
        told += _against_the_front(met, noise)
    if len(met) < len(solved):
        told.append(f"No method measured gets as far in {_share(len(solved) - len(met), len(group))}")
    return told


def _against_the_front(met: Sequence[_Case], noise: float) -> list[str]:
    """The ratios to the cheapest method, which that is, and what more or less accuracy would cost."""
    ratios = [case.standing.ratio or 0.0 for case in met]
    worst = met[ratios.index(max(ratios))]
    near = sum(ratio <= 1.0 + noise for ratio in ratios)
    told = f"On or ahead of the methods' front in {_share(near, len(met))}; {_median(ratios)} × its time"
    if len(met) > 1:
        told += f", {figure(max(ratios), 2)} × at most ({worst.place.mechanism}, {worst.place.regime})"
    rivals = [case.facts.way(case.standing.rival) for case in met if case.standing.rival]
    sentences = [told, f"Cheapest methods there: {_counted(rivals)}"]
    more, less = _steps_away(met, 0.1), _steps_away(met, 10.0)
    if more and less:
        sentences.append(
            f"Along that front a tenth of the error costs {_median(more)} × the time, ten times the error "
            f"{_median(less)} ×"
        )
    return sentences


def _steps_away(met: Sequence[_Case], factor: float) -> list[float]:
    """Time of the cheapest method at a multiple of the setting's error, over its time at that error."""
    found = []
    for case in met:
        beside = case.price(factor * case.error)
        if beside is not None and case.standing.rival_seconds:
            found.append(beside / case.standing.rival_seconds)
    return found


def _median(values: Sequence[float]) -> str:
    return figure(statistics.median(values), 2)


def _share(count: int, total: int) -> str:
    return f"{count} of {total} cases" if total > 1 else ("the one case" if count else "none")


def _span(values: Sequence[float], words: Callable[[float], str]) -> str:
    low, high = words(min(values)), words(max(values))
    return low if low == high else f"{low} to {high}"


def _counted(names: Iterable[str]) -> str:
    counts = Counter(names).most_common(3)
    return ", ".join(name if count == 1 else f"{name} ({count} times)" for name, count in counts)
