"""A cell of a stress map and the record of its run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from comparisons.judging.records import QuantityRecord, RunRecord, Verdict


class StressVerdict(StrEnum):
    """The verdict of a cell."""

    WITHIN = "within limit"
    OVER = "over limit"
    CAUGHT = "caught"
    MISSED = "missed"
    ALARM = "alarm"
    DIVERGED = "diverged"
    TIMED_OUT = "timed-out"
    CRASHED = "crashed"
    ADAPTER_ERROR = "adapter-error"
    SUITE_ERROR = "suite-error"
    UNSUPPORTED = "unsupported"
    UNAVAILABLE = "unavailable"


@dataclass(frozen=True)
class Cell:
    """One run of a map; ``usage`` is a setting or the name of a method."""

    axis: str
    row: str
    value: float
    engine: str
    usage: str

    @property
    def key(self) -> str:
        """The cell in words that a command understands."""
        return "/".join((self.axis, self.row, f"{self.value:.6g}", self.engine, self.usage))

    @property
    def command(self) -> str:
        """The command that runs the cell again."""
        return f"linkproof stress '{self.key}'"

    @property
    def line(self) -> tuple[str, str, str, str]:
        """Axis, row, engine and usage, shared with the cells of other values."""
        return (self.axis, self.row, self.engine, self.usage)


@dataclass(frozen=True, kw_only=True)
class CellResult(RunRecord):
    """The run of a cell: the quantity nearest to its limit, and the invariants that failed, or else the nearest.

    ``wrong`` and ``reason`` are in the words of a reader; ``differing`` is what differs from a plain run-up of the
    linkage. ``spent`` is everything: reference, set-up, stepping, judging, s.
    """

    axis: str
    row: str
    value: float
    verdict: StressVerdict
    reason: str = ""
    wrong: str = ""
    differing: Mapping[str, Any] = field(default_factory=dict)
    spent: float = 0.0
    solver_work: int = 0

    @property
    def cell(self) -> Cell:
        """The cell that was run."""
        return Cell(self.axis, self.row, self.value, self.engine, self.setting)

    @property
    def key(self) -> str:
        """The cell in words."""
        return self.cell.key

    @property
    def nearest(self) -> QuantityRecord | None:
        """The quantity nearest to its limit, or furthest over it."""
        return next(iter(self.errors), None)

    @property
    def worst_check(self) -> QuantityRecord | None:
        """The invariant nearest to its limit, or furthest over it."""
        return next(iter(self.invariants), None)

    @property
    def alarms(self) -> tuple[str, ...]:
        """Names of the invariants that failed."""
        return tuple(invariant.quantity for invariant in self.invariants if invariant.outcome != Verdict.PASSED)

    @property
    def data(self) -> dict[str, Any]:
        """The result as JSON-ready data."""
        return {**super().data, "command": self.cell.command}


def blank_result(cell: Cell, mechanism: str, motion: str = "") -> CellResult:
    """The result of a cell before it is run."""
    return CellResult(
        mechanism=mechanism,
        variant="",
        regime=motion,
        conditions=f"{cell.axis}, {cell.row}: {cell.value:.6g}",
        engine=cell.engine,
        engine_version="",
        setting=cell.usage,
        axis=cell.axis,
        row=cell.row,
        value=cell.value,
        verdict=StressVerdict.UNAVAILABLE,
    )
