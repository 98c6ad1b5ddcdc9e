"""Signals by name over many crank angles: only what is requested is computed, in pieces that stay in the cache."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.machine_code.compiling import MOST_OPERATIONS, Result, StraightFunction, in_threads, is_worthwhile
from analytic.machine_code.tracing import LinkageTrace, is_traceable, linkage_trace
from analytic.motion.dead_centres import farthest_between
from analytic.moving import MovingSweep
from analytic.signals import check_signals, is_wrapped, signal

Array = NDArray[np.float64]

# Crank angles per piece. Measured on the needle mechanisms: from 4096 to 16384 the cost per angle is the same within a
# tenth; shorter pieces pay NumPy's cost per call (1024: twice), longer ones leave the cache (100 000 at once: twice).
PIECE: Final = 6144
SHARE: Final = 16384  # crank angles of one call of machine code: less than a millisecond's work
ONE_ROW: Final = np.empty((1, 0))


def evaluate(
    mechanism: Mechanism,
    angle: ArrayLike,
    names: Iterable[str],
    *,
    speed: ArrayLike | None = None,
    acceleration: ArrayLike = 0.0,
    cores: int | None = None,
    path: str = "auto",
) -> dict[str, Array]:
    """Signals of ``analytic.signals`` by name at every crank angle (rad, any shape); arrays of that shape, SI.

    ``speed`` (rad/s) and ``acceleration`` (rad/s²) of the crank are signed, scalar or of the angles' shape; the speed
    is needed by whatever depends on the crank's motion. S counts from the top dead centre of a full turn, or where
    there is none from the farthest place between the least and the largest angle. Angles of links are unwrapped along
    the last axis. ``path`` is ``numpy``, ``compiled``, or ``auto``: compiled where that saves time, compiling included.
    ``cores`` is the number of threads of the compiled path, all of the machine's if None.
    """
    chosen = check_signals(mechanism, names, has_speed=speed is not None)
    angle = np.asarray(angle, dtype=float)
    motion = [
        _flat_as_angles(angle, 0.0 if speed is None else speed, "speed"),
        _flat_as_angles(angle, acceleration, "acceleration"),
    ]
    values = None
    if is_worthwhile(path, MOST_OPERATIONS, angle.size) and is_traceable(mechanism):
        trace = _traced(mechanism, chosen, bool(np.any(motion[1])))
        if is_worthwhile(path, len(trace.trace.lines_needed(trace.lines)), angle.size):
            values = _by_machine_code(trace, angle.ravel(), motion, cores)
    if values is None:
        values = _by_numpy(mechanism, chosen, angle.ravel(), motion)
    if "S" in chosen:
        values[chosen.index("S")] += farthest_between(mechanism, angle)
    table = {name: row.reshape(angle.shape) for name, row in zip(chosen, values, strict=True)}
    wrapped = [name for name in table if angle.ndim and is_wrapped(name, mechanism.linkage)]
    return table | {name: np.unwrap(table[name]) for name in wrapped}


def _flat_as_angles(angle: Array, value: ArrayLike, name: str) -> Array:
    """A motion quantity as it is if scalar, else flattened like the angles; raises LinkproofError for another shape."""
    values = np.asarray(value, dtype=float)
    if values.ndim and values.shape != angle.shape:
        raise LinkproofError(
            f"{name}: expected a number or an array of the crank angles' shape {angle.shape}, got shape "
            f"{values.shape}; pass one value per angle"
        )
    return values.ravel() if values.ndim else values


def _by_numpy(mechanism: Mechanism, names: tuple[str, ...], angle: Array, motion: Sequence[Array]) -> Array:
    """Signals (signals, angles) by NumPy, piece by piece; S counts from the ground's origin."""
    values = np.empty((len(names), angle.size))
    for start in range(0, angle.size, PIECE):
        here = slice(start, start + PIECE)
        moves = (move[here] if move.ndim else move for move in motion)
        at = MovingSweep(mechanism, mechanism.sweep(angle[here]), *moves)
        for row, name in zip(values, names, strict=True):
            row[here] = signal(at, name)
    return values


def _by_machine_code(trace: LinkageTrace, angle: Array, motion: Sequence[Array], cores: int | None) -> Array | None:
    """Signals (signals, angles) by compiled machine code, in threads; None where the linkage cannot move at some angle.

    The caller then takes ``_by_numpy``, which raises the error that says why.
    """
    function = _compile_trace(trace)
    values = np.empty((len(trace.lines), angle.size))  # the last says where it moves

    def part(start: int) -> None:
        here = slice(start, start + SHARE)
        given = trace.values({}, angle[here], *(move[here] if move.ndim else move for move in motion))
        function([given[line] for line in function.lanes], ONE_ROW, angle[here].size, values[:, here])

    in_threads(part, range(0, angle.size, SHARE), cores)
    return values[:-1] if np.all(values[-1]) else None


@lru_cache(maxsize=8)
def _traced(mechanism: Mechanism, names: tuple[str, ...], accelerates: bool) -> LinkageTrace:
    """The list of operations of the linkage's signals, all of its numbers being constants."""
    return linkage_trace(mechanism, (), names, accelerates=accelerates, all_groups=False)


@lru_cache(maxsize=8)
def _compile_trace(trace: LinkageTrace) -> StraightFunction:
    inputs = {*trace.trace.inputs.values()} & {*trace.trace.lines_needed(trace.lines)}
    return StraightFunction(trace.trace, sorted(inputs), (), [Result(line) for line in trace.lines])
