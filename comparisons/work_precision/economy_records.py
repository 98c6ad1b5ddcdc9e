"""What an economy's measurement found: flat records of runs and of the closed form, ready for JSON."""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any


@dataclass(frozen=True)
class RunCost:
    """What a scene costs in an engine, and how much there is of it.

    ``seconds`` are of whole runs, one for every repeat, ``stepping`` the part of them that the engine itself counts as
    stepping. ``bodies``, ``conditions`` of joints and drive, and ``loads`` are the scene's; ``values`` are the numbers
    recorded.
    """

    mechanism: str
    variant: str
    engine: str
    engine_version: str
    setting: str
    reduction: str
    about: str
    outcome: str
    reason: str
    seconds: tuple[float, ...]
    stepping: tuple[float, ...]
    steps: int
    bodies: int
    conditions: int
    loads: int
    values: int


@dataclass(frozen=True)
class AngleCost:
    """What the closed form costs: ``seconds`` of every repeat over ``angles`` crank angles, by ``evaluate``'s path."""

    mechanism: str
    variant: str
    path: str
    reduction: str
    quantities: tuple[str, ...]
    angles: int
    seconds: tuple[float, ...]


@dataclass(frozen=True)
class Economy:
    """All that was measured, by mechanism, engine and reduction, the whole scene first."""

    runs: tuple[RunCost, ...]
    angles: tuple[AngleCost, ...]

    def rows(self) -> dict[str, list[dict[str, Any]]]:
        """As JSON-ready rows, each with its smallest and median time beside its repeats."""
        return {"runs": [_row(cost) for cost in self.runs], "angles": [_row(cost) for cost in self.angles]}

    @classmethod
    def from_rows(cls, rows: Mapping[str, Iterable[Mapping[str, Any]]]) -> Economy:
        """Back from ``rows``; raises KeyError where one lacks a field."""
        runs = tuple(RunCost(**_values(RunCost, row)) for row in rows["runs"])
        return cls(runs, tuple(AngleCost(**_values(AngleCost, row)) for row in rows["angles"]))


def _row(cost: RunCost | AngleCost) -> dict[str, Any]:
    found = {"seconds_min": min(cost.seconds), "seconds_median": statistics.median(cost.seconds)}
    return {name: list(value) if isinstance(value, tuple) else value for name, value in asdict(cost).items()} | found


def _values(kind: type[RunCost] | type[AngleCost], row: Mapping[str, Any]) -> dict[str, Any]:
    values = {field.name: row[field.name] for field in fields(kind)}
    return {name: tuple(value) if isinstance(value, list) else value for name, value in values.items()}
