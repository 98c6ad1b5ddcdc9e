"""The environment of results: date, machine and commit, then all versions on one line."""

from __future__ import annotations

from collections.abc import Container, Mapping
from typing import Final

AT_A_TIME: Final = "runs at a time"  # how many ran side by side, each on a share of the machine


def environment_facts(environment: Mapping[str, str], leave_out: Container[str] = ()) -> list[tuple[str, str]]:
    """Name and value of each fact; names in ``leave_out`` are given elsewhere."""
    first = [name for name in ("date", "machine", "hosts", "commit", AT_A_TIME) if name in environment]
    rest = [f"{name} {version}" for name, version in environment.items() if name not in first and name not in leave_out]
    return [*((name.capitalize(), environment[name]) for name in first), ("Versions", ", ".join(rest))]


def side_by_side(environment: Mapping[str, str]) -> str:
    """A note on times: "while 4 ran" where runs were made side by side, else empty."""
    return f"while {environment[AT_A_TIME]} ran" if AT_A_TIME in environment else ""
