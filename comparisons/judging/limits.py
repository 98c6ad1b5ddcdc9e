"""The table of limits: one data file, one look-up."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from analytic.description.crank_motion import LAWS, REGIMES

OWN = "own"  # stands in the table for every regime of a linkage's own
SWING = "swing"  # stands there for every law from one crank angle to another but constant speed, which is one law
TABLE = Path(__file__).with_name("limits.toml")


@dataclass(frozen=True)
class Limit:
    """The largest error_max allowed, and why."""

    value: float
    reason: str


@cache
def _rows() -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = tomllib.loads(TABLE.read_text(encoding="utf-8"))["limit"]
    return found


def limit(quantity: str, setting: str, regime: str) -> Limit:
    """The limit a record is held against; raises LookupError for a quantity the table does not cover.

    Forces of all joints share a limit, and so do all regimes that linkages define for themselves.
    """
    quantity = quantity.partition(":")[0]
    regime = regime if regime in REGIMES else SWING if regime in LAWS else OWN
    for row in _rows():
        fits = setting in row.get("settings", [setting]) and regime in row.get("regimes", [regime])
        if quantity in row["quantities"] and fits:
            return Limit(float(row["value"]), row["reason"])
    raise LookupError(f"limits.toml has no row for {quantity}, {setting}, {regime}: add one with its reason")
