"""The table of limits: one data file, one look-up."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from analytic.description.crank_motion import REGIMES

OWN = "own"  # stands in the table for every regime of a linkage's own
TABLE = Path(__file__).with_name("limits.toml")


@dataclass(frozen=True)
class Limit:
    """The largest error_max allowed, and why."""

    value: float
    reason: str


@dataclass(frozen=True)
class _Row:
    quantities: tuple[str, ...]
    settings: tuple[str, ...]
    regimes: tuple[str, ...]
    limit: Limit

    def fits(self, quantity: str, setting: str, regime: str) -> bool:
        return (
            quantity in self.quantities
            and (not self.settings or setting in self.settings)
            and (not self.regimes or regime in self.regimes)
        )


@cache
def _rows() -> tuple[_Row, ...]:
    table = tomllib.loads(TABLE.read_text(encoding="utf-8"))["limit"]
    return tuple(
        _Row(
            tuple(row["quantities"]),
            tuple(row.get("settings", ())),
            tuple(row.get("regimes", ())),
            Limit(float(row["value"]), row["reason"]),
        )
        for row in table
    )


def limit(quantity: str, setting: str, regime: str) -> Limit:
    """The limit a record is held against; raises LookupError for a quantity the table does not cover.

    Forces of all joints share a limit, and so do all regimes that linkages define for themselves.
    """
    quantity, regime = quantity.partition(":")[0], regime if regime in REGIMES else OWN
    for row in _rows():
        if row.fits(quantity, setting, regime):
            return row.limit
    raise LookupError(f"limits.toml has no row for {quantity}, {setting}, {regime}: add one with its reason")
