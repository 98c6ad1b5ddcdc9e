"""Which engines are installed, and keeping them quiet and apart."""

from __future__ import annotations

import ctypes
import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib import import_module, metadata


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
        return _not_installed(package, extra)
    return None


def why_unusable(package: str, extra: str = "", oldest: str = "") -> str | None:
    """Why an engine cannot be used, from the package's metadata: nothing is imported.

    ``extra`` is as in ``why_absent``, ``oldest`` the first version that will do.
    """
    version = installed_version(package)
    return _not_installed(package, extra) if version is None else _too_old(version, package, extra, oldest)


def _not_installed(package: str, extra: str) -> str:
    return f"{package} is not installed: {_cure(package, extra)}"


def _too_old(version: str, package: str, extra: str, oldest: str) -> str | None:
    if not oldest or _numbers(version) >= _numbers(oldest):
        return None
    return f"{package} {version} is too old, {oldest} is the first that will do: {_cure(package, extra)}"


def _cure(package: str, extra: str) -> str:
    return f"pip install --upgrade 'linkproof[{extra or package}]' brings it"


def _numbers(version: str) -> tuple[int, ...]:
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
