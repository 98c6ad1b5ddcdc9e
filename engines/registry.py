"""Finding engines: every adapter announced under the entry-point group ``linkproof.engines``, in name order.

A plug-in that cannot be loaded, or does not keep the contract, costs its own rows alone: a stand-in takes its place and
raises, when it is run, the error of the loading.
"""

from __future__ import annotations

import contextlib
import ctypes
import io
import os
import re
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from importlib.metadata import EntryPoint, entry_points
from typing import Final

from analytic.errors import UnknownNameError, install_words
from engines.contract import Abilities, Engine, Run, Setting
from engines.scene import Scene

GROUP = "linkproof.engines"
CONTRACT: Final = ("name", "abilities", "is_control", "version", "run")  # what every adapter has to have
NO_ABILITIES: Final = Abilities({}, frozenset(), frozenset(), frozenset(), settings=frozenset())


class PluginError(Exception):
    """An adapter that can be imported and does not keep the contract."""


@dataclass
class Unusable:
    """Stand-in for an adapter that cannot be loaded: loading it raised the ``error``.

    ``module`` is where its adapter was announced to be, ``announced_by`` the version of the package that did, "" where
    that is unknown.
    """

    name: str
    module: str
    announced_by: str | None
    error: BaseException
    is_control: bool = False
    abilities: Abilities = NO_ABILITIES

    def version(self) -> str | None:
        """Version of the package that announces the adapter, since the engine's is not available; "" if unknown."""
        return self.announced_by

    def why_unavailable(self) -> str | None:
        """None, since ``run`` reports the error."""
        return None

    def run(self, scene: Scene, setting: Setting) -> Run:
        """Raise the error that loading the adapter raised, whatever the scene and setting."""
        raise self.error


def _announced() -> dict[str, EntryPoint]:
    """Entry points by engine name, in name order; where two announce one name, ours wins. Nothing is imported.

    They are read once for each ``sys.path``.
    """
    return _read_announced(tuple(sys.path))


@cache
def _read_announced(_: tuple[str, ...]) -> dict[str, EntryPoint]:
    """The group's entry points by engine name, in name order, ours where another has the same name.

    The argument, ``sys.path``, is only the key by which they are cached: reading them takes longer than many runs.
    """
    entries = sorted(entry_points(group=GROUP), key=lambda entry: _is_ours(entry.value))
    return dict(sorted((entry.name, entry) for entry in entries))


def engine_names() -> tuple[str, ...]:
    """Names of all engines that have an adapter, installed or not, in their order."""
    return tuple(_announced())


def own_names() -> tuple[str, ...]:
    """Names of the suite's own engines, in order, without plug-ins: what its documentation and tests are about."""
    return tuple(name for name, entry in _announced().items() if _is_ours(entry.value))


def entry_point(name: str) -> EntryPoint:
    """The entry point that announces the adapter of that name; raises UnknownNameError if no package does."""
    entries = _announced()
    if name not in entries:
        raise UnknownNameError("engine", name, entries)
    return entries[name]


def is_plugin(name: str) -> bool:
    """Whether the adapter of that name is another package's; raises UnknownNameError for an unknown name."""
    return not _is_ours(entry_point(name).value)


def engine(name: str) -> Engine:
    """A new adapter of that name, or an Unusable one if loading it raises anything; the engine itself is not imported.

    Raises UnknownNameError for a name that no package announces; a user's KeyboardInterrupt passes.
    """
    try:
        return _load_adapter(entry_point(name))
    except UnknownNameError:
        raise
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt) and signal.getsignal(signal.SIGINT) != signal.SIG_IGN:
            raise  # the user's; a worker hears none
        return stand_in(name, error)


def stand_in(name: str, error: BaseException) -> Unusable:
    """An Unusable adapter for a name whose loading raised ``error``; raises UnknownNameError for an unknown name."""
    entry = entry_point(name)
    module = entry.value.partition(":")[0].strip()  # which may be no name of a module at all
    return Unusable(name, module, entry.dist.version if entry.dist else "", error)


def why_unavailable(adapter: Engine) -> str | None:
    """The reason, in one sentence with the cure, why an engine cannot be used here; None where it can.

    It is the answer of the adapter's own ``why_unavailable`` or, without one, by its version. Raises PluginError for an
    answer that is neither text nor None.
    """
    words = getattr(adapter, "why_unavailable", None)
    if words is not None:
        reason: str | None = words()
        if not isinstance(reason, str | None):
            raise PluginError(f"expected why_unavailable as text or None, got a {type(reason).__name__}")
        return reason
    return None if adapter.version() is not None else f"engine '{adapter.name}' is not installed: install it"


def _load_adapter(entry: EntryPoint) -> Engine:
    """Import, create, check and return the adapter of an entry point; raises PluginError if it breaks the contract.

    Errors of the import and of the adapter's own code pass; what they print to standard output is dropped.
    """
    with contextlib.redirect_stdout(io.StringIO()):  # the output of the command may be JSON or a script
        adapter: Engine = entry.load()()
        lacking = [part for part in CONTRACT if not hasattr(adapter, part)]
        if lacking:
            raise PluginError(f"expected an adapter with {', '.join(CONTRACT)}, got one without {', '.join(lacking)}")
        check_adapter(adapter)
    if adapter.name != entry.name:
        raise PluginError(f"expected an adapter with the name of its entry point, got {adapter.name!r}")
    return adapter


def check_adapter(adapter: Engine) -> None:
    """Raise PluginError unless name, version, ``is_control`` and ``abilities`` have the contract's types.

    A blank name counts as none.
    """
    version = adapter.version()
    if not isinstance(adapter.name, str) or not adapter.name.strip():
        raise PluginError(f"expected a name as text, got {adapter.name!r}")
    if not isinstance(version, str | None):
        raise PluginError(f"expected a version as text or None, got a {type(version).__name__}")
    if not isinstance(adapter.is_control, bool) or not isinstance(adapter.abilities, Abilities):
        raise PluginError("expected is_control as True or False and abilities as Abilities, got others")


def _is_ours(module: str) -> bool:
    """Whether a module, by its name or an entry point's value, is one of linkproof's own adapters."""
    return module.startswith("engines.")


# Which engines are installed, and keeping them quiet and apart.


@cache
def installed_version(name: str) -> str | None:
    """Version of the installed package of this name, looked up once in a process; None where it is absent."""
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def why_unusable(package: str, extra: str, oldest: str = "") -> str | None:
    """The reason, with the cure, why an engine cannot be used: its package is absent or too old; else None.

    The package's metadata tell, nothing is imported. ``extra`` is the extra of linkproof that brings the package, if
    there is one of that name, ``oldest`` the first version that will do, "" for any. Raises PackageNotFoundError where
    it cannot be used and linkproof itself is not installed.
    """
    version = installed_version(package)
    if version is not None and _version_numbers(version) >= _version_numbers(oldest):
        return None
    is_extra = extra in (metadata.metadata("linkproof").get_all("Provides-Extra") or ())
    command = install_words(extra) if is_extra else f"pip install '{package}'"
    fault = "is not installed" if version is None else f"{version} is too old, {oldest} is the first that will do"
    return f"{package} {fault}: {command.replace('install ', 'install --upgrade ', 1)} brings it"


def _version_numbers(version: str) -> tuple[int, ...]:
    """The first three numbers of a version, as text, for comparison; fewer if it has fewer, none for ""."""
    return tuple(int(number) for number in re.findall(r"\d+", version)[:3])


def flush() -> None:
    """Flush Python's buffers of standard output and error, and all of C's where its library can be loaded."""
    for stream in filter(None, (sys.stdout, sys.stderr)):
        stream.flush()
    with suppress(OSError, AttributeError, TypeError):  # a system without a C library that can be loaded
        ctypes.CDLL(None).fflush(None)


@contextmanager
def silenced(into: str = os.devnull) -> Iterator[None]:
    """In the block, append standard output and error, C code's included, to a file; by default they are lost.

    ``into`` is its path; raises OSError where it cannot be opened.
    """
    flush()  # what was written before is not lost
    streams = [(stream, os.dup(stream)) for stream in (1, 2)]
    try:
        with open(into, "a") as file:
            for stream, _ in streams:
                os.dup2(file.fileno(), stream)
        yield
    finally:
        flush()  # buffered output is not written later
        for stream, copy in streams:
            os.dup2(copy, stream)
            os.close(copy)
