"""How far passes at different steps agree: the extrapolation with the coarsest pass against the one without it.

That is an estimate of the error of the latter, so a generous one of the former. Where passes do not agree at all, each
of them went its own way, as beyond an angle at which the linkage can change its assembly; none is to be believed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from engines.contract import History, Signal
from engines.pymunk_adapter.layout import Layout
from engines.stepping.richardson import extrapolate

Array = NDArray[np.float64]

# Powers of the step in the error of a pass; the read-outs are centred, the closing of the joints is not.
ORDERS = (2, 3, 4, 5, 6, 7, 8)


@dataclass(frozen=True)
class Pass:
    """What one pass gave: its longest step, s, and the history at its samples."""

    step: float
    history: History


@dataclass(frozen=True)
class Doubt:
    """A disagreement and what it is about: over the peak, for positions over the scene's size, for angles in rad."""

    size: float
    about: str
    time: float


def extrapolated(passes: Sequence[Pass]) -> History:
    """All passes combined so that the leading powers of the step cancel."""
    return extrapolate([(done.step, done.history) for done in passes], ORDERS)


def doubt(passes: Sequence[Pass], layout: Layout) -> Doubt:
    """Where the extrapolated motion depends most on the coarsest pass."""
    full, finer = extrapolated(passes), extrapolated(passes[1:])
    return max(_disagreements(full, finer, layout), key=lambda found: found.size)


def angle_doubt(passes: Sequence[Pass], crank: int) -> float:
    """How far the extrapolated crank angle depends on the coarsest pass, rad; the passes hold positions."""
    alone = [replace(done, history=History(position=done.history.position)) for done in passes]
    full, finer = extrapolated(alone).position, extrapolated(alone[1:]).position
    assert full is not None
    assert finer is not None
    return float(np.max(np.abs(full.values[:, crank, 2] - finer.values[:, crank, 2])))


def _disagreements(full: History, finer: History, layout: Layout) -> Iterator[Doubt]:
    yield Doubt(0.0, "nothing", 0.0)
    if full.position is not None and finer.position is not None:
        yield _worst("position", full.position, finer.position, layout.reach, slice(2))
        yield _worst("angle", full.position, finer.position, 1.0, slice(2, 3))
    for name in ("velocity", "acceleration"):
        one, other = getattr(full, name), getattr(finer, name)
        if one is not None:
            yield _worst(name, one, other, None, slice(2))
            yield _worst(f"angular {name}", one, other, None, slice(2, 3))
    if full.torque is not None and finer.torque is not None:
        yield _worst("drive torque", full.torque, finer.torque, None, slice(None))
    for name, signal in full.joint_force.items():
        yield _worst(f"force in joint '{name}'", signal, finer.joint_force[name], None, slice(None))


def _worst(about: str, full: Signal, finer: Signal, scale: float | None, columns: slice) -> Doubt:
    values = full.values[..., columns]
    off = np.abs(values - finer.values[..., columns]).reshape(len(values), -1).max(axis=1)
    worst = int(np.argmax(off))
    size = float(np.max(np.abs(values))) if scale is None else scale
    return Doubt(float(off[worst]) / (size or 1.0), about, float(full.time[worst]))
