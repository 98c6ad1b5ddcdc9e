"""Signals by name over many crank angles: only what is requested is computed, in pieces that stay in the cache."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.machine_code.compiling import StraightFunction, in_threads, is_worthwhile
from analytic.machine_code.linkage_trace import LinkageTrace, is_traceable, linkage_trace
from analytic.machine_code.printing import Result
from analytic.moving import MovingSweep
from analytic.signals import check_signals, is_wrapped, signal
from analytic.turn.farthest import farthest_between

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
    motion = [_like(angle, 0.0 if speed is None else speed, "speed"), _like(angle, acceleration, "acceleration")]
    farthest = farthest_between(mechanism, angle) if "S" in chosen else 0.0
    values = _by_machine_code(mechanism, chosen, angle.ravel(), motion, farthest, cores, path)
    if values is None:
        values = _by_numpy(mechanism, chosen, angle, motion, farthest)
    found = {name: row.reshape(angle.shape) for name, row in zip(chosen, values, strict=True)}
    wrapped = [name for name in found if angle.ndim and is_wrapped(name, mechanism.linkage)]
    return found | {name: np.unwrap(found[name]) for name in wrapped}


def _like(angle: Array, value: ArrayLike, name: str) -> Array:
    """A scalar as it is, an array flattened like the angles."""
    values = np.asarray(value, dtype=float)
    if values.ndim and values.shape != angle.shape:
        raise LinkproofError(
            f"{name}: expected a number or an array of the crank angles' shape {angle.shape}, got shape "
            f"{values.shape}; pass one value per angle"
        )
    return values.ravel() if values.ndim else values


def _by_numpy(
    mechanism: Mechanism, names: tuple[str, ...], angle: Array, motion: list[Array], farthest: float
) -> Array:
    """Signals (signals, angles), piece by piece."""
    flat = angle.ravel()
    values = np.empty((len(names), flat.size))
    for start in range(0, flat.size, PIECE):
        here = slice(start, start + PIECE)
        moves = (move[here] if move.ndim else move for move in motion)
        at = MovingSweep(mechanism, mechanism.sweep(flat[here]), *moves, farthest)
        for row, name in zip(values, names, strict=True):
            row[here] = signal(at, name)
    return values


def _by_machine_code(
    mechanism: Mechanism,
    names: tuple[str, ...],
    angle: Array,
    motion: list[Array],
    farthest: float,
    cores: int | None,
    path: str,
) -> Array | None:
    """Signals (signals, angles); None where NumPy serves, for it has a sentence where the linkage cannot move."""
    accelerates = bool(np.any(motion[1]))
    of = _trace(mechanism, names, accelerates) if is_traceable(mechanism) else None
    if not is_worthwhile(path, len(of.trace.leading_to(of.lines)) if of else 0, angle.size) or of is None:
        return None
    function = _function(mechanism, names, accelerates)
    values = np.empty((len(names), angle.size))
    stuck: list[int] = []

    def part(start: int) -> None:
        here = slice(start, start + SHARE)
        moves = (move[here] if move.ndim else move for move in motion)
        given = of.trace.computed(function.lanes, of.values({}, angle[here], *moves))
        found = function(given, ONE_ROW, len(angle[here]))
        values[:, here] = found[:-1]
        if not np.all(found[-1]):
            stuck.append(start)

    in_threads(part, range(0, angle.size, SHARE), cores)
    if stuck:
        return None
    for row, name in zip(values, names, strict=True):
        if name == "S":
            row += farthest
    return values


@lru_cache(maxsize=8)
def _trace(mechanism: Mechanism, names: tuple[str, ...], accelerates: bool) -> LinkageTrace:
    """The linkage's signals as a list, all of its numbers constants."""
    return linkage_trace(mechanism, (), names, accelerates=accelerates, all_groups=False)


@lru_cache(maxsize=8)
def _function(mechanism: Mechanism, names: tuple[str, ...], accelerates: bool) -> StraightFunction:
    of = _trace(mechanism, names, accelerates)
    return StraightFunction(of.trace, of.borders(of.lines)[1], (), [Result(line) for line in of.lines])
