"""Engines by name. A plug-in is imported in worker processes alone, where importing it may hang or crash.

The command's process asks a worker, once, for what it has to know of a plug-in. Without worker processes a plug-in is
imported where it is run.
"""

from __future__ import annotations

import multiprocessing
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from analytic.errors import LinkproofError
from comparisons.trials.runs.run_engine import AdapterError, Failure, Lost, RunBounds, blamed_on
from comparisons.trials.runs.workers import LocalPool
from engines import registry
from engines.contract import Abilities, Engine, Method, Run, Setting, StudiedEngine
from engines.scene import Scene

LONGEST_LOADING: Final = RunBounds(30.0)  # within which a plug-in must be imported and tell what it can do
_ASKED: Final[dict[tuple[str, str], Engine]] = {}  # plug-ins by name and entry point


@dataclass
class PluginEngine:
    """What a worker has told of a plug-in's engine; ``methods`` asks for more, and ``run`` imports it here."""

    name: str
    module: str
    is_control: bool
    abilities: Abilities
    told_version: str | None
    absent: str | None
    expected_failures: Mapping[str, str]

    def version(self) -> str | None:
        """The engine's version; None where it is absent or has none."""
        return self.told_version

    def why_unavailable(self) -> str | None:
        """The reason why it cannot be used; None where it can."""
        return self.absent

    def methods(self, scene: Scene) -> tuple[Method, ...]:
        """The engine's ways of stepping that can be studied, as a worker tells them; () if it has none.

        Raises AdapterError where the adapter raises or the worker is lost, LinkproofError where no worker can start.
        """
        ((_, told),) = LocalPool(1).run(_methods, [(self.name, scene)], bounds=LONGEST_LOADING)
        if isinstance(told, Lost):
            raise AdapterError(told.reason)
        return told

    def run(self, scene: Scene, setting: Setting) -> Run:
        """Import the engine in this process, and run it there; raises what the adapter raises."""
        return registry.engine(self.name).run(scene, setting)

    def run_method(self, scene: Scene, method: Method, step: float) -> Run:
        """Import the engine in this process, and run it there by a method at a longest ``step``, s.

        Raises AssertionError for an engine without methods, and what the adapter raises.
        """
        adapter = registry.engine(self.name)
        assert isinstance(adapter, StudiedEngine)
        return adapter.run_method(scene, method, step)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as the adapter's name: in another process it is loaded as the engine itself."""
        return registry.engine, (self.name,)


def _methods(name: str, scene: Scene) -> tuple[Method, ...]:
    """Run in a worker: the methods of a plug-in's engine for a scene, () if it has none to study.

    Raises AdapterError where the adapter raises.
    """
    adapter = registry.engine(name)
    with blamed_on(adapter):
        return adapter.methods(scene) if isinstance(adapter, StudiedEngine) else ()


def _facts(name: str) -> tuple[Any, ...]:
    """Run in a worker: load a plug-in and return the fields of its ``PluginEngine``, in order.

    Raises AdapterError where it does not load or its adapter raises.
    """
    adapter = registry.engine(name)
    with blamed_on(adapter):
        if isinstance(adapter, registry.Unusable):
            raise adapter.error
        absent, module = registry.why_unavailable(adapter), type(adapter).__module__
        facts = module, adapter.is_control, adapter.abilities, adapter.version(), absent
        return name, *facts, dict(getattr(adapter, "expected_failures", {}))


def engine(name: str) -> Engine:
    """The adapter of that name or, of a plug-in, its stand-in: a ``PluginEngine``, or one whose run raises an error.

    Raises UnknownNameError for a name that nobody announces.
    """
    return engines((name,))[0]


def engines(names: Sequence[str]) -> list[Engine]:
    """The adapters of these names, as from ``engine``, in their order; all plug-ins are asked at the same time.

    What a plug-in has told is kept. In a worker they are loaded there. Raises UnknownNameError as ``engine`` does.
    """
    if multiprocessing.current_process().daemon:  # a worker
        return [registry.engine(name) for name in names]
    plugins = {name: (name, registry.entry_point(name).value) for name in names if registry.is_plugin(name)}
    new = [key for key in plugins.values() if key not in _ASKED]
    try:
        for number, told in LocalPool().run(_facts, [(name,) for name, _ in new], bounds=LONGEST_LOADING):
            _ASKED[new[number]] = _known(new[number][0], told)
    except LinkproofError:  # no worker can be started
        _ASKED.update({key: registry.engine(key[0]) for key in new})
    return [_ASKED[plugins[name]] if name in plugins else registry.engine(name) for name in names]


def _known(name: str, told: tuple[Any, ...] | Lost) -> Engine:
    """The engine with the facts that a worker has told, or a stand-in with the reason why the worker was lost.

    ``name`` is the plug-in's.
    """
    if not isinstance(told, Lost):
        return PluginEngine(*told)
    whole = told.outcome in (Failure.ADAPTER_ERROR, Failure.SUITE_ERROR)
    reason = told.reason if whole else f"the adapter of {name} cannot be loaded: its process {told.reason}"
    return registry.stand_in(name, AdapterError(reason))
