"""Finding engines: every adapter announced under the entry-point group ``linkproof.engines``, in name order.

A plug-in that cannot be loaded, or does not keep the contract, costs its own rows alone: a stand-in takes its place and
raises, when it is run, the error of the loading. A stand-in takes the place of two plug-ins of one name as well, as the
name is ambiguous.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import re
import signal
import sys
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from importlib import import_module, metadata
from importlib.metadata import EntryPoint, entry_points
from typing import Final, NoReturn

from analytic.description.linkage import DriverKind
from analytic.errors import UnknownNameError
from engines.contract import Abilities, Engine, Outcome, ReadOut, Run, Setting
from engines.scene import Channel, Scene

GROUP = "linkproof.engines"
CONTRACT: Final = ("name", "abilities", "is_control", "version", "run")  # what every adapter has to have
LONGEST_LOADING: Final = 30.0  # s within which an adapter must be imported and return its version
NO_ABILITIES: Final = Abilities({}, frozenset(), frozenset(), frozenset(), settings=frozenset())
_FAILED: dict[str, BaseException] = {}  # by entry point: what failed once is not tried again


class PluginError(Exception):
    """An adapter that can be imported and does not keep the contract."""


@dataclass
class Unusable:
    """Stand-in for an adapter that cannot be used: for the ``error`` that loading it raised, or for a ``reason``.

    ``module`` is where its adapter was announced to be, ``announced_by`` the version of the package that did.
    """

    name: str
    module: str
    announced_by: str | None = None
    error: BaseException | None = None
    reason: str | None = None
    is_control: bool = False
    abilities: Abilities = NO_ABILITIES

    def version(self) -> str | None:
        """The plug-in's own version, since the engine's is not available."""
        return self.announced_by

    def why_unavailable(self) -> str | None:
        """The reason, if there is one; an error is reported when it is run."""
        return self.reason

    def run(self, scene: Scene, setting: Setting) -> Run:
        """Raise what loading raised."""
        if self.error is not None:
            raise self.error
        return Run(Outcome.UNAVAILABLE, self.reason or "")


def announced() -> dict[str, list[EntryPoint]]:
    """Entry points by engine name, more than one where several packages have the same name; nothing is imported."""
    return _announced(tuple(sys.path))


@cache
def _announced(_: tuple[str, ...]) -> dict[str, list[EntryPoint]]:
    """Read once for a search path: reading takes longer than many a run."""
    groups: dict[str, list[EntryPoint]] = {}
    for entry in sorted(entry_points(group=GROUP), key=lambda entry: (entry.name, entry.value)):
        same = groups.setdefault(entry.name, [])
        if entry.value not in [other.value for other in same]:
            same.append(entry)
    return groups


def module_of(entry: EntryPoint) -> str:
    """The module that an entry point names; it may be no name of a module at all."""
    return entry.value.partition(":")[0].strip()


def engine_names() -> tuple[str, ...]:
    """Names of all engines that have an adapter, installed or not."""
    return tuple(announced())


def plugins() -> dict[str, str]:
    """Engines whose adapters are not ours, each with the packages that announce it; nothing is imported."""
    return {
        name: " and ".join(sorted(map(_package_name, points)))
        for name, points in announced().items()
        if not all(_is_ours(each.value) for each in points)
    }


def entry_point(name: str) -> EntryPoint | Unusable:
    """Where the adapter of that name is announced, or a stand-in where several are; nothing is imported.

    Raises UnknownNameError for a name that no package announces.
    """
    groups = announced()
    if name not in groups:
        raise UnknownNameError("engine", name, groups)
    entry, *others = groups[name]
    if not others:
        return entry
    reason = f"engine '{name}' is announced by {plugins()[name]}: uninstall all of them but one"
    return Unusable(name, module_of(entry), reason=reason)


def engine(name: str) -> Engine:
    """The adapter of that name, or its stand-in; importing it does not import the engine itself.

    Raises UnknownNameError for a name that no package announces.
    """
    entry = entry_point(name)
    if isinstance(entry, Unusable):
        return entry
    try:
        if entry.value in _FAILED:
            raise _FAILED[entry.value]
        return _load_adapter(entry)
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt) and signal.getsignal(signal.SIGINT) != signal.SIG_IGN:
            raise  # the user's; a worker hears none
        _FAILED[entry.value] = error
        return Unusable(name, module_of(entry), entry.dist.version if entry.dist else "", error)


def why_unavailable(adapter: Engine) -> str | None:
    """Why an engine cannot be used here, in one sentence with the cure, None where it can; nothing is imported."""
    words = getattr(adapter, "why_unavailable", None)
    if words is not None:
        reason: str | None = words()
        if not isinstance(reason, str | None):
            raise PluginError(f"expected why_unavailable as text or None, got a {type(reason).__name__}")
        return reason
    if adapter.version() is not None:
        return None
    ours = _is_ours(type(adapter).__module__)
    cure = f"install it with: pip install 'linkproof[{adapter.name}]'" if ours else "install it"
    return f"engine '{adapter.name}' is not installed: {cure}"


def _load_adapter(entry: EntryPoint) -> Engine:
    """Import the adapter of an entry point and check it; raises PluginError for one that breaks the contract."""
    late = f"loading it took longer than {LONGEST_LOADING:g} s"
    # Its output goes elsewhere: that of the command may be JSON or a script.
    with _time_limit(LONGEST_LOADING, late), contextlib.redirect_stdout(sys.stderr):
        adapter: Engine = entry.load()()
        lacking = [part for part in CONTRACT if not hasattr(adapter, part)]
        if lacking:
            raise PluginError(f"expected an adapter with {', '.join(CONTRACT)}, got one without {', '.join(lacking)}")
        check_adapter(adapter)
    if adapter.name != entry.name:
        raise PluginError(f"expected an adapter with the name it is announced by, got {adapter.name!r}")
    return adapter


def check_adapter(adapter: Engine) -> None:
    """Raise PluginError for an adapter whose facts are not as the contract has them."""
    version = adapter.version()
    if not isinstance(adapter.name, str) or not adapter.name.strip():
        raise PluginError(f"expected a name as text, got {adapter.name!r}")
    if not isinstance(version, str | None):
        raise PluginError(f"expected a version as text or None, got a {type(version).__name__}")
    if not isinstance(adapter.is_control, bool) or not _are_plain(adapter.abilities):
        raise PluginError("expected is_control as True or False and abilities of the contract's own types, got others")


def _package_name(entry: EntryPoint) -> str:
    return f"{entry.dist.name} {entry.dist.version}" if entry.dist else entry.value


def _are_plain(abilities: object) -> bool:
    """Whether abilities are words, settings and types of the contract, which every process knows."""
    if type(abilities) is not Abilities or not isinstance(abilities.readouts, Mapping):
        return False
    types = [*abilities.drives, *abilities.joints, *abilities.loads]
    readouts = abilities.readouts.items()
    return (
        all(isinstance(each, type) and each.__module__ == Scene.__module__ for each in types)
        and all(isinstance(channel, Channel) and type(readout) is ReadOut for channel, readout in readouts)
        and all(isinstance(word, str) for words in abilities.as_dict().values() for word in words.values())
        and all(isinstance(each, Setting) for each in abilities.settings)
        and all(isinstance(each, DriverKind) for each in abilities.drivers)
    )


def _is_ours(module: str) -> bool:
    return module.startswith("engines.")


@contextlib.contextmanager
def _time_limit(seconds: float, words: str) -> Iterator[None]:
    """Raise TimeoutError, where the system has timers, inside what takes longer, so that it is known where."""
    if not hasattr(signal, "setitimer") or threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(*_: object) -> NoReturn:
        raise TimeoutError(words)

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


# Which engines are installed, and keeping them quiet and apart.


def installed_version(name: str) -> str | None:
    """Version of an installed engine; None where it is absent."""
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def why_absent(package: str, extra: str = "") -> str | None:
    """Why a package cannot be imported, None where it can; an error inside an installed one is not hidden by this.

    ``extra`` is the extra that brings the package, by default of its name.
    """
    try:
        import_module(package)
    except ModuleNotFoundError as error:
        if error.name != package:
            raise
        return _not_installed_sentence(package, extra)
    return None


def why_unusable(package: str, extra: str = "", oldest: str = "") -> str | None:
    """Why an engine cannot be used, from the package's metadata: nothing is imported.

    ``extra`` is as in ``why_absent``, ``oldest`` the first version that will do.
    """
    version = installed_version(package)
    if version is None:
        return _not_installed_sentence(package, extra)
    if _version_numbers(version) >= _version_numbers(oldest):
        return None
    return f"{package} {version} is too old, {oldest} is the first that will do: {_how_to_install(package, extra)}"


def _not_installed_sentence(package: str, extra: str) -> str:
    return f"{package} is not installed: {_how_to_install(package, extra)}"


def _how_to_install(package: str, extra: str) -> str:
    return f"pip install --upgrade 'linkproof[{extra or package}]' brings it"


def _version_numbers(version: str) -> tuple[int, ...]:
    return tuple(int(number) for number in re.findall(r"\d+", version)[:3])


def flush() -> None:
    """Flush the buffers that Python and C have for standard output and error."""
    for stream in filter(None, (sys.stdout, sys.stderr)):
        stream.flush()
    with suppress(OSError, AttributeError, TypeError):  # a system without a C library that can be loaded
        ctypes.CDLL(None).fflush(None)


@contextmanager
def silenced(into: str = os.devnull) -> Iterator[None]:
    """Send what the process writes to its standard output and error nowhere, or to a file, C code's included."""
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
