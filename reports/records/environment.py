"""Where results were made: date, machine and commit, then the versions of everything else on one line."""

from __future__ import annotations

from collections.abc import Container, Mapping


def environment_facts(environment: Mapping[str, str], leave_out: Container[str] = ()) -> list[tuple[str, str]]:
    """Name and value of each fact; names in ``leave_out`` are given elsewhere."""
    first = [name for name in ("date", "machine", "hosts", "commit") if name in environment]
    rest = [f"{name} {version}" for name, version in environment.items() if name not in first and name not in leave_out]
    return [*((name.capitalize(), environment[name]) for name in first), ("Versions", ", ".join(rest))]
