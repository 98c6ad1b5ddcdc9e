"""Running a scene in an engine, and checking the run that its adapter returns: contract, finite values, gaps."""

from __future__ import annotations

import contextlib
import math
import os
import sys
import traceback
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path
from signal import SIG_IGN, SIGINT, getsignal
from typing import Final, Protocol

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from analytic.numerics.arrays import Array
from comparisons.trials.observed_motion import POINTS
from engines.contract import Engine, History, Method, Origin, Outcome, Run, Setting, Signal, StudiedEngine
from engines.scene import Channel, Drive, Prescribed, Scene

# Runs that gave no result: how each failed, whose fault it was, and where.


GIB: Final = 1 << 30
# Set to anything, this shows on the terminal what workers print, and the traceback of everything they raise.
SHOW_OUTPUT: Final = "LINKPROOF_WORKER_OUTPUT"
OURS: Final = ("analytic", "engines", "comparisons", "reports")

_ROOT = Path(__file__).parents[3]
_LONGEST_MESSAGE = 300  # characters of an exception's own words


class Failure(StrEnum):
    """Ways in which a run can end besides its engine's own ``engines.contract.Outcome``."""

    TIMED_OUT = "timed-out"
    CRASHED = "crashed"
    ADAPTER_ERROR = "adapter-error"  # the engine's adapter raised
    SUITE_ERROR = "suite-error"  # anything else raised: the reference, the judging, a check


@dataclass(frozen=True)
class RunBounds:
    """Bounds of one job: ``seconds`` of wall time, and ``memory``, bytes that it may add to the address space.

    Address space counts reserved memory, used or not. It is bounded where the system can (Linux).
    """

    seconds: float = 600.0
    memory: int = 4 * GIB


DEFAULT_BOUNDS = RunBounds()


@dataclass(frozen=True)
class Lost:
    """A job that gave no result; ``reason`` in one sentence."""

    outcome: Failure
    reason: str


class AdapterError(Exception):
    """An adapter raised, or violated the contract; the message names the fault and, of an exception, its line."""


class _Named(Protocol):
    name: str


@contextlib.contextmanager
def blamed_on(adapter: _Named) -> Iterator[None]:
    """In the block, raise an AdapterError, with the adapter's name, the exception and its line, for any exception.

    A MemoryError, an exit and an AdapterError pass. An interruption is the user's in a process that hears Ctrl-C, and
    the adapter's in a worker.
    """
    try:
        yield
    except (MemoryError, SystemExit, AdapterError):
        raise
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt) and getsignal(SIGINT) != SIG_IGN:
            raise
        module = getattr(adapter, "module", type(adapter).__module__)  # a stand-in knows the module it stands for
        modules = (module, getattr(adapter, "loop", module))  # a loop may be a module beside the adapter's
        packages = tuple(name.rpartition(".")[0] or name for name in modules)
        place = _error_location(error, packages, f"announced in {module}")
        raise AdapterError(f"the adapter of {adapter.name} raised {_error_words(error)} ({place})") from error


def lost(error: BaseException, memory: int) -> Lost:
    """The Lost record for a job that raised ``error`` within a memory bound, bytes.

    MemoryError and SystemExit are CRASHED, an AdapterError is ADAPTER_ERROR, all others are SUITE_ERROR. Writes the
    traceback of the last two kinds to the terminal if the environment has ``SHOW_OUTPUT``.
    """
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
    """A sentence on an exception that is a fault of linkproof, since no input should raise it; it asks for a report."""
    return (
        f"this is a fault of linkproof: {_error_words(error)} ({_error_location(error, OURS)}); report it with the "
        f"command and the input, and with the traceback that {SHOW_OUTPUT}=1 shows"
    )


def _error_words(error: BaseException) -> str:
    """An error's type and message on one line, "TYPE: MESSAGE", cut to _LONGEST_MESSAGE characters."""
    words = " ".join(str(error).split())
    return f"{type(error).__name__}: {words}"[:_LONGEST_MESSAGE].rstrip(": ")


def _error_location(error: BaseException, packages: tuple[str, ...], otherwise: str = "") -> str:
    """File and line of the innermost frame inside these packages, by name: "FILE, line N"; a SyntaxError's own counts.

    Without one ``otherwise`` or, if that is "", the innermost frame at all, or "no file".
    """
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


_LONGEST_REASON: Final = 1000  # characters of a reason
_LARGEST: Final = 1e100  # of a signal, in any unit: squares of values computed from it are still finite
# A gap is longer than so many of the engine's own steps: anywhere, and where it may start anew, at the borders of the
# motion's parts. Measured of every engine and setting over the catalogue's motions, swings with dwells and released
# cranks: up to 1.7 anywhere, and 4 at borders, where pymunk's ``best`` has no forces for three samples.
GAP, BORDER_GAP = 2.5, 5.0
NEIGHBOURS = 5  # steps on either side, whose median is the engine's own step there
LONG_QUANTILE = (
    0.9  # of all steps turn a prescribed driver less than a long one, which a short part of a slow motion may have
)
ROUNDING = 1e-9  # of the duration


def run_engine(adapter: Engine, model: Scene, way: Setting | Method, step: float | None = None) -> Run:
    """The run of a scene by a setting, or by a method at a longest ``step``, s, which a setting has not.

    The samples of a finished run cover the whole motion; they and their squares are finite: a run for which this does
    not hold has diverged. Raises AdapterError for every exception of the adapter but MemoryError, which the process
    with the memory bound reports, and SystemExit, and for a run that violates the contract.
    """
    with blamed_on(adapter):
        return checked(started(adapter, model, way, step), model, adapter.name)


def started(adapter: Engine, model: Scene, way: Setting | Method, step: float | None) -> Run:
    """The adapter's run of a scene, not yet checked; arguments as for ``run_engine``.

    Raises what the adapter raises, and AssertionError for a method without a step or an engine without methods.
    """
    if isinstance(way, Setting):
        return adapter.run(model, way)
    assert step is not None
    assert isinstance(adapter, StudiedEngine)
    return adapter.run_method(model, way, step)


def checked(run: Run, model: Scene, name: str) -> Run:
    """The run, checked against the contract: plain data, and samples of the scene's shapes; its reason on one line.

    A copy comes back. One that claims to have finished has diverged if it cannot be read between its samples, is not
    finite throughout, or does not cover the whole motion. Raises AdapterError, with the engine's ``name``, for what no
    simulation can do wrong.
    """
    fault = next(_contract_faults(run, model), None)
    if fault is not None:
        raise AdapterError(f"the adapter of {name} returned a run that is not as the contract has it: expected {fault}")
    run = replace(run, reason=" ".join(run.reason.split())[:_LONGEST_REASON])
    if run.outcome is Outcome.FINISHED:
        for channel, signal in _requested_signals(run.history, model):
            if signal is not None and (why := _unusable(signal, model.drive)):
                return replace(run, outcome=Outcome.DIVERGED, reason=f"{channel} {why}")
    return run


def _unusable(signal: Signal, drive: Drive) -> str:
    """Why a signal of a run cannot be judged, in words that follow its name; "" if it can.

    It has too few samples, values that are not finite or too large, or a ``gap``.
    """
    if len(signal.time) < POINTS:
        return f"has {len(signal.time)} samples, too few to read between"
    small = (np.abs(signal.values) < _LARGEST).reshape(len(signal.time), -1).all(axis=1)
    if not small.all():
        first = int(np.argmin(small))
        how = f"beyond {_LARGEST:g}" if np.isfinite(signal.values[first]).all() else "not finite"
        return f"is {how} from {signal.time[first]:.4g} s on"
    hole = gap(signal.time, drive)
    return f"has no samples {hole}" if hole else ""


def _requested_signals(history: History | None, model: Scene) -> Iterator[tuple[str, Signal | None]]:
    """Yield every signal that a scene requests, after its name in words; None for one that the history lacks."""
    for channel in sorted(model.channels - {Channel.JOINT_FORCE}):
        yield channel.value, getattr(history, channel.value, None)
    if Channel.JOINT_FORCE in model.channels:
        for joint in model.joints:
            yield f"the force of joint {joint.name}", history.joint_force.get(joint.name) if history else None


def _contract_faults(run: object, model: Scene) -> Iterator[str]:
    """Yield every violation of the contract by a run, as "VALUE, got VALUE", in words that follow "expected"."""
    if type(run) is not Run:
        yield f"a Run, got {_shown_value(run)}"
        return
    if not isinstance(run.outcome, Outcome):
        yield f"an Outcome, got {_shown_value(run.outcome)}"
    if not isinstance(run.reason, str):
        yield f"a reason as text, got {_shown_value(run.reason)}"
    for part in ("seconds", "setup_seconds"):
        if not _is_time(getattr(run, part)):
            yield f"{part} that are finite and not negative, got {_shown_value(getattr(run, part))}"
    if type(run.steps) is not int or not 0 <= run.steps < 1 << 63:
        yield f"steps as a number from 0 on, got {_shown_value(run.steps)}"
    if not isinstance(run.passes, tuple) or not all(map(_is_time, run.passes)):
        yield f"passes as steps in s, got {_shown_value(run.passes)}"
    plain = isinstance(run.details, Mapping) and all(isinstance(key, str) for key in run.details)
    wrong = [value for value in run.details.values() if not _is_plain(value)] if plain else [run.details]
    if wrong:
        yield f"details that are texts and finite numbers, got {_shown_value(wrong[0])}"
    if run.outcome is Outcome.FINISHED:
        yield from _history_faults(run.history, model)


def _history_faults(history: object, model: Scene) -> Iterator[str]:
    """Yield violations of the contract by a finished run's history, in words that follow "expected".

    A signal that it lacks is none.
    """
    if type(history) is not History or not isinstance(history.joint_force, Mapping):
        yield f"a History of a run that finished, got {_shown_value(history)}"
        return
    bodies = (len(model.bodies), 3)
    shapes = {"torque": ((),), "position": (bodies,), "velocity": (bodies,), "acceleration": (bodies,)}
    for name, signal in _requested_signals(history, model):
        if signal is not None:
            yield from (f"{fault} in {name}" for fault in _signal_faults(signal, shapes.get(name, ((2,), ()))))


def _signal_faults(signal: object, shapes: tuple[tuple[int, ...], ...]) -> Iterator[str]:
    """Yield the first violation of the contract by a signal, in words that follow "expected"; nothing without one.

    ``shapes`` are those that one sample may have.
    """
    if type(signal) is not Signal or not isinstance(signal.origin, Origin):
        yield f"a Signal, got {_shown_value(signal)}"
    elif not all(isinstance(part, np.ndarray) and part.dtype.kind in "fiu" for part in (signal.time, signal.values)):
        yield "times and values as arrays of real numbers, got others"
    elif signal.time.ndim != 1 or signal.values.shape not in [(len(signal.time), *shape) for shape in shapes]:
        expected = " or ".join(str(("samples", *shape)).replace("'", "") for shape in shapes)
        yield f"values of shape {expected} for {signal.time.size} times, got {signal.values.shape}"
    elif not (np.isfinite(signal.time).all() and (np.diff(signal.time) >= 0.0).all()):
        yield "times that are finite and never decrease, got others"


def _is_time(value: object) -> bool:
    """Whether a value is a finite time, s, not negative."""
    return isinstance(value, float | int) and 0.0 <= value < math.inf


def _is_plain(value: object) -> bool:
    """Whether a value is a text or a finite number."""
    return isinstance(value, str) or (isinstance(value, float | int) and abs(value) < math.inf)


def _shown_value(value: object) -> str:
    """A number as text; anything else by its type, since its own text may be anything."""
    return repr(value) if isinstance(value, float | int) else f"a {type(value).__name__}"


def gap(time: Array, drive: Drive) -> str:
    """The widest place, in words, where samples at these times (n,), s, leave out several of their steps; "" without.

    The words are "from T to T s" and the own step. Before the first and behind the last sample counts too. The own step
    is the median of those before or of those after, the larger one: it may change from one part of a motion to the
    next. A gap is longer than ``GAP`` own steps, at borders of the motion's parts than ``BORDER_GAP``; between samples
    it also turns a prescribed driver further than long steps do.
    """
    borders = _part_borders(drive)
    instants = np.concatenate([borders[:1], time, borders[-1:]])
    steps = np.diff(instants)
    medians = np.median(sliding_window_view(np.pad(steps, NEIGHBOURS, mode="reflect"), NEIGHBOURS), axis=1)
    own = np.maximum(medians[: len(steps)], medians[-len(steps) :])
    before, behind = instants[:-1] - ROUNDING * borders[-1], instants[1:] + ROUNDING * borders[-1]
    at_border = np.searchsorted(borders, before) < np.searchsorted(borders, behind, "right")
    beyond = steps - np.where(at_border, BORDER_GAP, GAP) * own
    if isinstance(drive, Prescribed):
        turned = np.abs(np.diff(drive.motion.angle(instants)))[1:-1]
        beyond[1:-1][turned <= GAP * np.quantile(turned, LONG_QUANTILE)] = 0.0
    worst = int(np.argmax(beyond))
    if not beyond[worst] > 0.0:
        return ""
    return f"from {instants[worst]:.4g} to {instants[worst + 1]:.4g} s, where its own step is {own[worst]:.2g} s"


def _part_borders(drive: Drive) -> Array:
    """Times, s, ascending, at which a motion starts or ends, changes its part, or its torque over time has a kink."""
    if isinstance(drive, Prescribed):
        return np.array([0.0, *(segment.end for segment in drive.motion.segments)])
    kinks = drive.over_time.times if drive.over_time else ()
    return np.array([0.0, *(kink for kink in kinks if 0.0 < kink < drive.duration), drive.duration])
