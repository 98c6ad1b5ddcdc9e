"""Runs that gave no result: how each failed, whose fault it was, and where.

Imports the standard library alone, as worker processes do at their start.
"""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import traceback
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Final, Protocol

GIB: Final = 1 << 30
# Set to anything, this shows on the terminal what workers print, and the traceback of everything they raise.
SHOW_OUTPUT: Final = "LINKPROOF_WORKER_OUTPUT"
OURS: Final = ("analytic", "engines", "comparisons", "reports")

_ROOT = Path(__file__).parents[2]
_LENGTH = 300  # characters of an exception's own words


class Failure(StrEnum):
    """Ways in which a run can end besides its engine's own ``engines.contract.Outcome``."""

    TIMED_OUT = "timed-out"
    CRASHED = "crashed"
    ADAPTER_ERROR = "adapter-error"  # the engine's adapter raised
    SUITE_ERROR = "suite-error"  # anything else raised: the reference, the judging, a check


@dataclass(frozen=True)
class Lost:
    """A job that gave no result; ``reason`` in one sentence, ``host`` as in records."""

    outcome: Failure
    reason: str
    host: str = ""


class AdapterError(Exception):
    """An adapter raised, or violated the contract; the message names the fault and its line."""


class _Named(Protocol):
    name: str


@contextlib.contextmanager
def blamed_on(adapter: _Named) -> Iterator[None]:
    """Turn whatever is raised inside into an AdapterError, but MemoryError, which speaks of the bounds, and an exit.

    An interruption is the user's in a process that hears Ctrl-C, and the adapter's in a worker.
    """
    try:
        yield
    except (MemoryError, SystemExit, AdapterError):
        raise
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt) and signal.getsignal(signal.SIGINT) != signal.SIG_IGN:
            raise
        module = getattr(adapter, "module", type(adapter).__module__)  # a stand-in knows the module it stands for
        place = _place(error, (module.rpartition(".")[0] or module,), f"announced in {module}")
        raise AdapterError(f"the adapter of {adapter.name} raised {_words(error)} ({place})") from error


def lost(error: BaseException, memory: int) -> Lost:
    """The loss of a job that raised ``error`` within a bound of ``memory`` bytes."""
    if isinstance(error, MemoryError):
        return Lost(Failure.CRASHED, f"needed more than {memory / GIB:.3g} GiB of memory")
    if isinstance(error, SystemExit):
        code = error.code if isinstance(error.code, int) else int(error.code is not None)
        return Lost(Failure.CRASHED, f"exited with code {code}")
    if os.environ.get(SHOW_OUTPUT):
        traceback.print_exception(error, file=sys.stderr)
    if isinstance(error, AdapterError):
        return Lost(Failure.ADAPTER_ERROR, str(error))
    return Lost(Failure.SUITE_ERROR, suite_error(error))


def suite_error(error: BaseException) -> str:
    """One sentence on an exception that no input of a user should raise."""
    return (
        f"this is a fault of linkproof: {_words(error)} ({_place(error, OURS)}); report it with the command and the "
        f"input, and with the traceback that {SHOW_OUTPUT}=1 shows"
    )


def _words(error: BaseException) -> str:
    words = " ".join(str(error).split())
    return f"{type(error).__name__}: {words}"[:_LENGTH].rstrip(": ")


def _place(error: BaseException, packages: tuple[str, ...], otherwise: str = "") -> str:
    """File and line of the innermost frame inside these packages; else ``otherwise``, or of the innermost at all."""
    walk = traceback.walk_tb(error.__traceback__)
    frames = [(frame.f_globals.get("__name__", ""), frame.f_code.co_filename, n) for frame, n in walk]
    prefixes = tuple(f"{name}." for name in packages)
    if isinstance(error, SyntaxError) and error.filename:
        frames.append((packages[0], error.filename, error.lineno or 0))
    inside = [frame for frame in frames if f"{frame[0]}.".startswith(prefixes)] or ([] if otherwise else frames)
    if not inside:
        return otherwise or "no file"
    _, file, line = inside[-1]
    path = Path(file)
    return f"{path.relative_to(_ROOT) if path.is_relative_to(_ROOT) else path}, line {line}"
