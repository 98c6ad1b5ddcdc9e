"""How far an extrapolation is off, from the passes it is made of.

The *estimate* foresees what the last pass has left of the error; the *disagreement* is what the coarsest pass changes,
an estimate of the error without it and so a generous one of the error with it. Where passes do not agree at all, each
of them went its own way, as beyond an angle at which the linkage can change its assembly; none is to be believed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from engines.contract import History, Signal
from engines.stepping.histories import labelled
from engines.stepping.richardson import Pass, extrapolate

SAFETY = 2.0  # of an estimated error over what the theory of evenly shrinking terms says
COARSE = 0.5  # the relative error for which a step that is far too long stands
# A component this much smaller than its neighbours is rounding and has no relative error.
NOTHING = 1e-9


def estimated_error(passes: Sequence[Pass], orders: Sequence[int]) -> float:
    """Error of the extrapolation of all passes, relative to the peaks; infinite for a single pass."""
    counts = range(max(1, len(passes) - 2), len(passes) + 1)
    changes = [change(a, b) for a, b in pairwise(extrapolate(passes[:count], orders) for count in counts)]
    return remaining_error(changes, passes[-1].step / passes[-2].step) if changes else math.inf


def remaining_error(changes: Sequence[float], ratio: float) -> float:
    """Error left of an extrapolation by what its last passes changed, the last at ``ratio`` of the step before it.

    If the terms of the error, cₖ h²ᵏ, shrink evenly, the error left by k passes is as much less than the last change as
    that is less than the one before, times the square of the ratio of their steps. With one change only, COARSE
    stands for the one before it. Measured on all test linkages: half to twice the error from three passes on, seven
    tenths to six times from two, as long as the constraint solver's tolerance is not what limits it.
    """
    before = changes[-2] if len(changes) > 1 else COARSE
    now = changes[-1]
    shrinking = now / before if before else 1.0
    return SAFETY * now * min(1.0, shrinking) * ratio**2


def change(one: History, other: History) -> float:
    """Largest relative difference of two histories of one scene, over the peak of its own component in ``other``.

    Taken in accelerations and torque, which integrators find hardest, or in what else was recorded; 0 if nothing was.
    """
    hard = [(one.acceleration, other.acceleration), (one.torque, other.torque)]
    easy: list[tuple[Signal | None, Signal | None]] = [
        (one.joint_force[name], other.joint_force[name]) for name in one.joint_force
    ]
    easy += [(one.velocity, other.velocity), (one.position, other.position)]
    for pairs in (hard, easy):
        present = [(a, b) for a, b in pairs if a is not None and b is not None]
        if present:
            return max(_relative(a, b) for a, b in present)
    return 0.0


def _relative(one: Signal, other: Signal) -> float:
    shape = (-1, other.values.shape[-1] if other.values.ndim > 1 else 1)
    peak = np.abs(other.values).reshape(shape).max(axis=0)
    difference = np.abs(one.values - other.values).reshape(shape).max(axis=0)
    moves = peak > NOTHING * peak.max()
    return float(np.max(difference[moves] / peak[moves], initial=0.0))


@dataclass(frozen=True)
class Disagreement:
    """A difference and what it is about: over the peak, for positions over the scene's size, for angles in rad."""

    size: float
    about: str
    time: float


def disagreement(passes: Sequence[Pass], orders: Sequence[int], reach: float) -> Disagreement:
    """Where the extrapolated motion of a scene of size ``reach``, m, depends most on the coarsest pass."""
    full, finer = extrapolate(passes, orders), extrapolate(passes[1:], orders)
    return max(_disagreements(full, finer, reach), key=lambda each: each.size)


def angle_disagreement(passes: Sequence[Pass], orders: Sequence[int], body: int) -> float:
    """How far a body's extrapolated angle depends on the coarsest pass, rad; the passes hold positions."""
    alone = [replace(each, history=History(position=each.history.position)) for each in passes]
    full, finer = extrapolate(alone, orders).position, extrapolate(alone[1:], orders).position
    assert full is not None
    assert finer is not None
    return float(np.max(np.abs(full.values[:, body, 2] - finer.values[:, body, 2])))


def _disagreements(full: History, finer: History, reach: float) -> Iterator[Disagreement]:
    yield Disagreement(0.0, "nothing", 0.0)
    for (name, one), (_, other) in zip(labelled(full), labelled(finer), strict=True):
        if one.values.ndim < 3:
            yield _worst(name, one, other, None, slice(None))
            continue
        where, angle = (reach, 1.0) if name == "position" else (None, None)
        yield _worst(name, one, other, where, slice(2))
        yield _worst("angle" if name == "position" else f"angular {name}", one, other, angle, slice(2, 3))


def _worst(about: str, full: Signal, finer: Signal, scale: float | None, columns: slice) -> Disagreement:
    values = full.values[..., columns]
    off = np.abs(values - finer.values[..., columns]).reshape(len(values), -1).max(axis=1)
    worst = int(np.argmax(off))
    size = float(np.max(np.abs(values))) if scale is None else scale
    return Disagreement(float(off[worst]) / (size or 1.0), about, float(full.time[worst]))
