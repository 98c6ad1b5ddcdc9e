"""Engines by name, as every process may have them: a plug-in's own code is imported in worker processes alone.

Who installs a plug-in need not use it, and nobody knows what importing it does: it may print, hang or end the process.
So the command's own process, where it needs a plug-in's word, has it from a worker.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from importlib.metadata import EntryPoint
from typing import Any, Final

from comparisons.runs.run_engine import AdapterError, Failure, Lost, blamed_on
from comparisons.runs.worker_process import is_worker, start_server
from comparisons.runs.workers import Bounds, run_jobs
from engines import registry
from engines.contract import Abilities, Engine, Method, Run, Setting, StudiedEngine
from engines.scene import Scene

_IMPORTED: Final[set[str]] = set()  # plug-ins that this worker has imported
_PLACEHOLDERS: Final[dict[tuple[str, ...], Engine]] = {}  # plug-ins that workers have looked at, by their entry points


@dataclass
class Plugin:
    """A placeholder for a plug-in that is not imported; sent to a worker, it becomes the adapter itself.

    Running it imports it here, as intended for runs without workers.
    """

    name: str
    module: str
    engine_version: str | None
    abilities: Abilities
    is_control: bool
    reason: str | None
    expected_failures: Mapping[str, str] = field(default_factory=dict)

    def __reduce__(self) -> tuple[Any, ...]:
        return _adapter, (self.name,)

    def version(self) -> str | None:
        """The engine's version; None if it is not installed."""
        return self.engine_version

    def why_unavailable(self) -> str | None:
        """Why the engine cannot be used, in a sentence; None if it can."""
        return self.reason

    def run(self, scene: Scene, setting: Setting) -> Run:
        """The adapter's run."""
        return registry.engine(self.name).run(scene, setting)


@dataclass
class StudiedPlugin(Plugin):
    """A placeholder for a plug-in whose ways of stepping can be studied."""

    work_unit: str = ""

    def methods(self, scene: Scene) -> tuple[Method, ...]:
        """The adapter's methods on a scene, from a worker; raises AdapterError where it gives none."""
        (methods,) = _call_in_workers(_method_rows, [(self.name, scene)])
        if isinstance(methods, Lost):
            raise _load_error(self.name, methods)
        return tuple(Method(**each) for each in methods)

    def run_method(self, scene: Scene, method: Method, step: float) -> Run:
        """The adapter's run by a method."""
        adapter = registry.engine(self.name)
        assert isinstance(adapter, StudiedEngine)
        return adapter.run_method(scene, method, step)


def engine(name: str) -> Engine:
    """The adapter of that name, or what stands for it; raises UnknownNameError for a name that nobody announces."""
    return engines((name,))[0]


def engines(names: Sequence[str]) -> list[Engine]:
    """The adapters of these names, as ``engine`` has them; plug-ins are all looked at at the same time."""
    if is_worker():
        return [_adapter(name) for name in names]
    foreign = registry.plugins()
    points = {name: registry.entry_point(name) for name in names}
    # Not told from others by the type EntryPoint: once importlib_metadata is imported, entry points are of its own.
    entries = {name: point for name, point in points.items() if not isinstance(point, registry.Unusable)}
    keys = {name: _entry_point_key(entry) for name, entry in entries.items() if name in foreign}
    new = [name for name, key in keys.items() if key not in _PLACEHOLDERS]
    for name, facts in zip(new, _call_in_workers(_plugin_facts, [(name,) for name in new]), strict=True):
        _PLACEHOLDERS[keys[name]] = _placeholder(name, entries[name], facts)
    return [_PLACEHOLDERS[keys[name]] if name in keys else registry.engine(name) for name in names]


def _placeholder(name: str, entry: EntryPoint, facts: dict[str, Any] | Lost) -> Engine:
    module = registry.module_of(entry)
    if isinstance(facts, Lost):
        version = entry.dist.version if entry.dist else None
        return registry.Unusable(name, module, version, _load_error(name, facts))
    kind = StudiedPlugin if "work_unit" in facts else Plugin
    return kind(name, module, **facts)


def _entry_point_key(entry: EntryPoint) -> tuple[str, ...]:
    return (entry.name, entry.value, str(entry.dist.locate_file("")) if entry.dist else "")


def _adapter(name: str) -> Engine:
    """The adapter itself, in a worker that no other's plug-in has been in, whatever that did to Python."""
    if is_worker():
        if _IMPORTED - {name}:
            os._exit(0)  # the job is done anew in a fresh one
        if name in registry.plugins():
            _IMPORTED.add(name)
    return registry.engine(name)


def _call_in_workers(function: Any, jobs: Sequence[tuple[Any, ...]]) -> list[Any]:  # noqa: ANN401
    """The result of a function for each of the jobs, or its failure."""
    if not jobs:
        return []
    start_server(["comparisons.campaign.campaign"])  # which runs will need, as the server starts once
    results = dict(
        run_jobs(function, jobs, bounds=Bounds(registry.LONGEST_LOADING + 5.0))
    )  # loading ends by itself, mostly
    return [results[number] for number in range(len(jobs))]


def _load_error(name: str, lost: Lost) -> AdapterError:
    whole = lost.outcome in (Failure.ADAPTER_ERROR, Failure.SUITE_ERROR)
    return AdapterError(lost.reason if whole else f"the adapter of {name} cannot be loaded: its process {lost.reason}")


def _plugin_facts(name: str) -> dict[str, Any]:
    """A plug-in's properties as plain data; the registry has checked its abilities and version."""
    adapter = engine(name)
    with blamed_on(adapter):
        if isinstance(adapter, registry.Unusable) and adapter.error is not None:
            raise adapter.error
        facts: dict[str, Any] = {
            "engine_version": adapter.version(),
            "abilities": replace(adapter.abilities, readouts=dict(adapter.abilities.readouts)),
            "is_control": adapter.is_control,
            "reason": registry.why_unavailable(adapter),
            "expected_failures": {str(k): str(v) for k, v in getattr(adapter, "expected_failures", {}).items()},
        }
        return facts | ({"work_unit": str(adapter.work_unit)} if isinstance(adapter, StudiedEngine) else {})


def _method_rows(name: str, scene: Scene) -> list[dict[str, Any]]:
    """The methods of a plug-in on a scene, as plain data."""
    adapter = engine(name)
    with blamed_on(adapter):
        assert isinstance(adapter, StudiedEngine)
        methods = [asdict(method) for method in adapter.methods(scene)]
        if any(not isinstance(value, str | float | int | None) for each in methods for value in each.values()):
            raise registry.PluginError("expected methods that are words and numbers, got others")
        return methods
