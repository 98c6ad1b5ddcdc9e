"""Quantities by name over many crank angles: only what is requested is computed, in pieces that stay in the cache."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.compiled.choice import is_compiled
from analytic.compiled.evaluation import by_kernels
from analytic.compiled.flat_linkage import Integers, has_kernels
from analytic.dynamics import reduced
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from analytic.moving import Moving
from analytic.request import EvaluationRequest, evaluation_request

Array = NDArray[np.float64]

# Crank angles per piece. Measured on the needle mechanisms: from 4096 to 16384 the cost per angle is the same within a
# tenth; shorter pieces pay NumPy's cost per call (1024: twice), longer ones leave the cache (100 000 at once: twice).
PIECE: Final = 6144
# s, what NumPy takes per crank angle and body; measured on the needle mechanisms, 20 to 40 ns.
PER_ANGLE: Final = 3e-8


@dataclass(frozen=True)
class MovingSweep(Moving):
    """Some crank angles with the crank's speed, rad/s, and acceleration, rad/s², at each; S counts from the origin."""

    mechanism: Mechanism
    sweep: Sweep
    speed: Array
    acceleration: Array
    farthest: float | Array = 0.0

    @cached_property
    def squared_speed(self) -> Array:
        """ω²."""
        return self.speed * self.speed


# S, v and a are the output's coordinate along its direction and its time derivatives, not counted from a dead centre.
QUANTITIES: Final[Mapping[str, Callable[[MovingSweep], Array]]] = {
    "Jeq": lambda at: at.inertia,
    "half_slope": lambda at: reduced.half_inertia_derivative(at.sweep),
    "Q": lambda at: reduced.generalised_force(at.sweep),
    "Mkr": lambda at: at.torque,
    "Teq": lambda at: 0.5 * at.inertia * at.squared_speed,
    "Peq": lambda at: at.torque * at.speed,
    "S": lambda at: at.sweep.output(),
    "v": lambda at: at.sweep.output(1) * at.speed,
    "a": lambda at: at.sweep.output(2) * at.squared_speed + at.sweep.output(1) * at.acceleration,
}
"""What can be requested: Jeq kg m², half_slope ½Jeq' kg m², Q N m, Mkr N m, Teq J, Peq W, S m, v m/s, a m/s²."""


def evaluate(
    mechanism: Mechanism,
    angle: ArrayLike,
    quantities: Iterable[str],
    *,
    speed: ArrayLike | None = None,
    acceleration: ArrayLike = 0.0,
    cores: int | None = None,
    path: str = "auto",
) -> dict[str, Array]:
    """Quantities of ``QUANTITIES`` by name at every crank angle (rad, any shape); arrays of that shape.

    ``speed`` (rad/s) and ``acceleration`` (rad/s²) of the crank are signed, scalar or of the angles' shape; the speed
    is needed by whatever depends on the crank's motion. ``path`` is ``numpy``, ``compiled``, or ``auto``: compiled
    where that saves time, its own start included. ``cores`` is the number of threads of the compiled path, all of the
    machine's if None.
    """
    request = evaluation_request(angle, quantities, speed, acceleration)
    values = None
    seconds = PER_ANGLE * request.angle.size * len(mechanism.structure.bodies)
    if is_compiled(path, "evaluation", seconds) and has_kernels(mechanism.structure):
        values = by_kernels(mechanism, request, cores)
    if values is None:
        values = _by_numpy(mechanism, request)
    return {name: row.reshape(request.shape) for name, row in zip(request.names, values, strict=True)}


def _by_numpy(mechanism: Mechanism, request: EvaluationRequest) -> Array:
    """Quantities (quantities, angles), piece by piece."""
    values = np.empty((len(request.names), request.angle.size))
    for start in range(0, request.angle.size, PIECE):
        here = slice(start, start + PIECE)
        at = moving_sweep(mechanism, mechanism.sweep(request.angle[here]), request, here)
        for row, name in zip(values, request.names, strict=True):
            row[here] = QUANTITIES[name](at)
    return values


def moving_sweep(mechanism: Mechanism, sweep: Sweep, request: EvaluationRequest, here: slice | Integers) -> MovingSweep:
    """A sweep of some of the crank angles, with the crank's motion there."""
    speed, acceleration = (move[here] if move.ndim else move for move in (request.speed, request.acceleration))
    return MovingSweep(mechanism, sweep, speed, acceleration)
