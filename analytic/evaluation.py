"""Signals by name over many crank angles: only what is requested is computed, in pieces that stay in the cache."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.motion.dead_centres import farthest_between
from analytic.moving import MovingSweep
from analytic.signals import check_signals, is_wrapped, signal

Array = NDArray[np.float64]

# Crank angles per piece. Measured on the needle mechanisms: from 4096 to 16384 the cost per angle is the same within a
# tenth; shorter pieces pay NumPy's cost per call (1024: twice), longer ones leave the cache (100 000 at once: twice).
PIECE: Final = 6144


def evaluate(
    mechanism: Mechanism,
    angle: ArrayLike,
    names: Iterable[str],
    *,
    speed: ArrayLike | None = None,
    acceleration: ArrayLike = 0.0,
) -> dict[str, Array]:
    """Signals of ``analytic.signals`` by name at every crank angle (rad, any shape); arrays of that shape, SI.

    ``speed`` (rad/s) and ``acceleration`` (rad/s²) of the crank are signed, scalar or of the angles' shape; the speed
    is needed by whatever depends on the crank's motion. S counts from the top dead centre of a full turn, or where
    there is none from the farthest place between the least and the largest angle. Angles of links are unwrapped along
    the last axis.
    """
    chosen = check_signals(mechanism, names, has_speed=speed is not None)
    angle = np.asarray(angle, dtype=float)
    motion = [
        _flat_as_angles(angle, 0.0 if speed is None else speed, "speed"),
        _flat_as_angles(angle, acceleration, "acceleration"),
    ]
    values = _evaluate_pieces(mechanism, chosen, angle.ravel(), motion)
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


def _evaluate_pieces(mechanism: Mechanism, names: tuple[str, ...], angle: Array, motion: Sequence[Array]) -> Array:
    """Signals (signals, angles) piece by piece; S counts from the ground's origin."""
    values = np.empty((len(names), angle.size))
    for start in range(0, angle.size, PIECE):
        here = slice(start, start + PIECE)
        moves = (move[here] if move.ndim else move for move in motion)
        at = MovingSweep(mechanism, mechanism.sweep(angle[here]), *moves)
        for row, name in zip(values, names, strict=True):
            row[here] = signal(at, name)
    return values
