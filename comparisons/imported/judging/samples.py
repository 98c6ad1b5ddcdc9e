"""Imported signals beside the closed form at the file's own instants: nothing in the file is interpolated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from comparisons.faults.simulation import ChangedMotion, Simulation, holds_acceleration
from comparisons.imported.columns import ImportedSignal
from comparisons.imported.judging.crank_column import SPREAD, ColumnMotion
from comparisons.judging.jumps import near_jump, near_jumps
from comparisons.reference.motion import Motion

Array = NDArray[np.float64]

NEIGHBOURS: Final = 8  # a share of the samples that are near one another


@dataclass(frozen=True)
class Samples:
    """A signal as judged: ``values`` (n,), SI, at times (n,), s, each within its ``rounding``, from ``imported``."""

    name: str
    time: Array
    values: Array
    rounding: Array
    time_rounding: Array
    imported: ImportedSignal


def floor(model: Simulation, samples: Sequence[Samples], truth: Sequence[Array]) -> list[Array]:
    """Uncertainty of each signal (n,) from the file's rounding of values, instants and crank angles."""
    floors = []
    likewise = model.motion.likewise if isinstance(model.motion, ColumnMotion) else ()
    others = [model.moving(motion).predicted(samples) for motion in likewise]
    early, late = (model.predicted([_moved(sample, sign) for sample in samples]) for sign in (-1.0, 1.0))
    for number, signal in enumerate(samples):
        by_time = np.maximum(np.abs(early[number] - truth[number]), np.abs(late[number] - truth[number]))
        apart = [
            np.where(near_jumps(signal.time, model.motion), 0.0, np.abs(o[number] - truth[number])) for o in others
        ]
        by_angle = _near_largest(apart, model.motion) if apart else 0.0
        floors.append(signal.rounding + np.where(signal.time_rounding > 0.0, by_time, 0.0) + SPREAD * by_angle)
    return floors


def _near_largest(differences: Sequence[Array], motion: Motion) -> Array:
    """The largest of a few trials' differences near each sample; anywhere, where the motion may be any at all."""
    largest = np.max(differences, axis=0)
    if not (isinstance(motion, ColumnMotion) and motion.is_known):
        return np.full(len(largest), np.max(largest))
    size = max(1, len(largest) // NEIGHBOURS)
    return np.asarray(maximum_filter1d(largest, size, mode="nearest"))


def _moved(signal: Samples, sign: float) -> Samples:
    return replace(signal, time=signal.time + sign * signal.time_rounding)


def jumps_of(model: Simulation, signal: Samples) -> Array:
    """By how much the closed form of a signal changes at the jump near each sample, (n,); 0 away from jumps."""
    sizes = np.zeros(len(signal.time))
    if not holds_acceleration(signal.name):
        return sizes
    for jump in model.motion.jumps:
        at_rest = model.moving(ChangedMotion(model.motion, order=0))  # as the crank is before the start
        earlier = model if jump > 0.0 else at_rest
        (after,) = model.predicted([replace(signal, time=np.array([jump]))])
        (before,) = earlier.predicted([replace(signal, time=np.array([np.nextafter(jump, 0.0)]))])
        size = float((after - before)[0]) or np.finfo(float).tiny
        larger = near_jump(signal.time, model.motion, jump) & (np.abs(size) > np.abs(sizes))
        sizes = np.where(larger, np.where(signal.time < jump, size, -size), sizes)
    return sizes
