"""Units a linkage file may state; each is converted to SI once, on reading."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from analytic.errors import UnknownNameError

UNITS: Final[Mapping[str, Mapping[str, float]]] = tomllib.loads(
    Path(__file__).with_name("units.toml").read_text(encoding="utf-8")
)


def factor(kind: str, unit: str) -> float:
    """SI value of one ``unit``; raises UnknownNameError naming the nearest known unit of that kind."""
    known = UNITS[kind]
    if unit not in known:
        raise UnknownNameError(f"{kind} unit", unit, known)
    return known[unit]
