"""Finding engines: every adapter announced under the entry-point group ``linkproof.engines``, in name order."""

from __future__ import annotations

from importlib.metadata import EntryPoint, entry_points

from analytic.errors import UnknownNameError
from engines.contract import Engine

GROUP = "linkproof.engines"


def announced() -> dict[str, EntryPoint]:
    """Entry points by engine name; nothing is imported."""
    return {entry.name: entry for entry in sorted(entry_points(group=GROUP), key=lambda entry: entry.name)}


def engine_names() -> tuple[str, ...]:
    """Names of all engines that have an adapter, installed or not."""
    return tuple(announced())


def engine(name: str) -> Engine:
    """The adapter of that name; importing it does not import the engine itself."""
    found = announced()
    if name not in found:
        raise UnknownNameError("engine", name, found)
    adapter: Engine = found[name].load()()
    return adapter
