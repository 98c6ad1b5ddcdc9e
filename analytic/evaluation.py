"""Quantities by name over many crank angles: only what is asked for is computed, in pieces that stay in the cache."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.dynamics import reduced
from analytic.errors import UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from analytic.request import requested

Array = NDArray[np.float64]

# Crank angles per piece. Measured on the needle mechanisms: from 4096 to 16384 the cost per angle is the same within a
# tenth; shorter pieces pay NumPy's cost per call (1024: twice), longer ones leave the cache (100 000 at once: twice).
PIECE: Final = 6144


@dataclass(frozen=True)
class Instants:
    """A piece of the crank angles with the crank's speed, rad/s, and acceleration, rad/s², at each."""

    sweep: Sweep
    speed: Array
    acceleration: Array

    @cached_property
    def inertia(self) -> Array:
        """Jeq, which Teq and Mkr need as well."""
        return reduced.reduced_inertia(self.sweep)

    @cached_property
    def torque(self) -> Array:
        """Mkr, which Peq needs as well."""
        inertia = self.inertia if np.any(self.acceleration) else np.zeros(self.sweep.angle.shape)
        return reduced.balance(self.sweep, inertia, self.speed, self.acceleration)

    @cached_property
    def squared_speed(self) -> Array:
        """ω²."""
        return self.speed * self.speed


PATHS: Final = ("auto", "numpy", "compiled")
# Where the compiled path begins to pay, in crank angles times bodies. Measured on the needle mechanisms: NumPy takes 20
# to 40 ns each; a compiled call takes 0.1 ms, as much as NumPy for 500 to 4000 angles, where the kernels are in memory;
# else importing numba and reading the kernels from disk takes 1 s, and compiling them, once on a machine, 20 s or more.
LEAST_WORK: Final = 20_000
WORK_OF_LOADING: Final = 50_000_000
WORK_OF_COMPILING: Final = 1_000_000_000

# S, v and a are the output's coordinate along its direction and its time derivatives, not counted from a dead centre.
QUANTITIES: Final[Mapping[str, Callable[[Instants], Array]]] = {
    "Jeq": lambda at: at.inertia,
    "half_slope": lambda at: reduced.half_inertia_slope(at.sweep),
    "Q": lambda at: reduced.generalised_force(at.sweep),
    "Mkr": lambda at: at.torque,
    "Teq": lambda at: 0.5 * at.inertia * at.squared_speed,
    "Peq": lambda at: at.torque * at.speed,
    "S": lambda at: at.sweep.output(),
    "v": lambda at: at.sweep.output(1) * at.speed,
    "a": lambda at: at.sweep.output(2) * at.squared_speed + at.sweep.output(1) * at.acceleration,
}
"""What can be asked for: Jeq kg m², half_slope ½Jeq' kg m², Q N m, Mkr N m, Teq J, Peq W, S m, v m/s, a m/s²."""


def evaluate(
    mechanism: Mechanism,
    angle: ArrayLike,
    quantities: Iterable[str],
    *,
    speed: ArrayLike | None = None,
    acceleration: ArrayLike = 0.0,
    path: str = "auto",
) -> dict[str, Array]:
    """Quantities of ``QUANTITIES`` by name at every crank angle (rad, any shape); arrays of that shape.

    ``speed`` (rad/s) and ``acceleration`` (rad/s²) of the crank are signed, scalar or of the angles' shape; the speed
    is needed by whatever depends on the crank's motion. ``path`` is ``numpy``, ``compiled``
    (``analytic.compiled.evaluation``), or ``auto``: compiled where that saves time, its own start included.
    """
    request = requested(angle, quantities, speed, acceleration)
    if is_compiled(path, request.angle.size * len(mechanism.structure.bodies)):
        from analytic.compiled.evaluation import CompiledMechanism  # noqa: PLC0415 - it needs this module

        compiled = CompiledMechanism(mechanism)
        return compiled.evaluate(angle, request.names, speed=speed, acceleration=acceleration)
    found = {name: np.empty(request.angle.shape) for name in request.names}
    moves = request.speed, request.acceleration
    for start in range(0, request.angle.size, PIECE):
        here = slice(start, start + PIECE)
        at = Instants(mechanism.sweep(request.angle[here]), *(move[here] if move.ndim else move for move in moves))
        for name in request.names:
            found[name][here] = QUANTITIES[name](at)
    return {name: values.reshape(request.shape) for name, values in found.items()}


def is_compiled(path: str, work: int) -> bool:
    """Whether to take the compiled path for ``work`` crank angles times bodies."""
    if path not in PATHS:
        raise UnknownNameError("path", path, PATHS)
    if path != "auto" or work < LEAST_WORK:
        return path == "compiled"
    from analytic.compiled.evaluation import available, is_loaded, is_ready  # noqa: PLC0415 - it needs this module

    if is_loaded():
        return True
    return work >= WORK_OF_LOADING and available() and (work >= WORK_OF_COMPILING or is_ready())
