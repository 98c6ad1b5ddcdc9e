"""The free crank: the constrained bodies' equation of motion projected on q', tabulated over φ and integrated.

With q̇ = q' φ̇ and q̈ = q' φ̈ + q'' φ̇² (coordinate partitioning: R. A. Wehage, E. J. Haug, ASME Journal of Mechanical
Design 104, 1982), the projection of M q̈ = F + Gᵀ λ on q' has no joint forces in it and reads

    (q'ᵀ M q') φ̈ = M1 + q'ᵀ F − (q'ᵀ M q'') φ̇²

whose coefficients depend on φ alone. They are solved from the bodies and tabulated. Loads over the crank angle need not
be smooth: only the levers they act on are tabulated, the loads are evaluated. Table and integrator are those of
``analytic.numerics``, which know no linkage: numerical methods are shared with the closed form, formulas are not.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN, Law, TimeLaw
from analytic.errors import AssemblyError, LinkproofError
from analytic.numerics.collocation import Windows, gauss_scheme
from analytic.numerics.integration import Push, integrate
from analytic.numerics.periodic_table import PeriodicTable, tabulate
from engines.direct_adapter.assembly import Equations, UnsolvableError
from engines.direct_adapter.path import Path
from engines.direct_adapter.solution import bends, transfer
from engines.mechanics.driver import driven
from engines.mechanics.loads import applied_loads
from engines.mechanics.states import start_motion
from engines.scene import AppliedForce, AppliedTorque, Free, Scene

Array = NDArray[np.float64]

NODES = 24  # of a window of the integration
BLOCK = 512  # instants solved at once: their matrices stay in a processor's cache
LOOKS = 97  # angles at which the terms of the coefficients are looked at
LEAST = 1e-3  # of its terms' peak: a coefficient smaller than this is what is left of terms that cancel
ROUNDINGS = 64.0  # of the terms of an acceleration, that it may be off by
EPS = float(np.finfo(float).eps)


@dataclass(frozen=True)
class FreeCrank:
    """φ̈ of a free crank at angles and speeds (n,), from coefficients over a path.

    ``rounding`` is what of φ̈ at rest is noise, rad/s². φ counts in ``scale``: rad, or a unit of length in m, and the
    coefficients with it.
    """

    table: PeriodicTable
    laws: tuple[Law, ...]
    torque: float
    rounding: float
    scale: float = 1.0

    def __call__(self, angle: Array, speed: Array) -> Array:
        """For an integrator; raises AssemblyError outside the table."""
        start, end = self.table.edges[[0, -1]]
        if np.max((angle - start) % self.table.period) > end - start:
            raise AssemblyError("the free crank runs up against its stop")
        columns = self.table(angle)
        loads = [value for law in self.laws for value in law(angle * self.scale)]
        factors = np.stack([-speed * speed, np.ones_like(speed), -speed, *loads])
        return np.asarray((self.torque + np.sum(factors * columns[1:], axis=0)) / columns[0])

    def push(self, law: TimeLaw) -> Push:
        """What a torque over time adds to φ̈."""
        return lambda time, angle: np.asarray(law(time) * self.scale / self.table(angle)[0])


def released_motion(equations: Equations, path: Path, drive: Free, tolerance: float) -> Windows:
    """The motion of a crank let go in its start state; raises UnsolvableError where it cannot be followed."""
    scene = equations.scene
    driver = equations.driver
    start = tuple(float(value[0]) / driver.scale for value in driven(scene, *start_motion(scene)[:2]))
    most = 0.0 if drive.over_time is None else max(map(abs, drive.over_time.torque))
    crank = free_crank(equations, path, drive.torque * driver.scale, most * driver.scale)
    try:
        return integrate(
            crank,
            (start[0], start[1]),
            drive.duration,
            gauss_scheme(NODES),
            tolerance=tolerance,
            rounding=crank.rounding,
            period=crank.table.period,
            push=None if drive.over_time is None else crank.push(drive.over_time),
            knots=() if drive.over_time is None else drive.over_time.times,
        )
    except LinkproofError as error:
        raise UnsolvableError(
            f"the free crank cannot be followed, the linkage locks or all but locks: {error}"
        ) from None


def free_crank(equations: Equations, path: Path, torque: float, timed: float = 0.0) -> FreeCrank:
    """Tabulate the coefficients of the free crank's motion along a path; ``timed`` is what a torque over time adds."""
    first, last = float(path.angle[0]), float(path.angle[-1])
    if equations.driver.turns and path.turns is None and last - first > FULL_TURN:
        raise UnsolvableError("the linkage is in another pose after a turn of its crank")
    scene = equations.scene
    forces = [load for load in scene.forces if not load.force.is_constant]
    torques = [load for load in scene.torques if not load.torque.is_constant]
    steady = replace(
        scene,
        forces=tuple(load for load in scene.forces if load.force.is_constant),
        torques=tuple(load for load in scene.torques if load.torque.is_constant),
    )
    units = _unit_loads(scene, forces, torques)

    def coefficients(angle: Array) -> tuple[Array, Array]:
        blocks = np.array_split(angle, max(1, len(angle) // BLOCK))
        parts = [_coefficients(equations, path, steady, units, block) for block in blocks]
        values, terms = (np.concatenate(part, axis=1) for part in zip(*parts, strict=True))
        if not np.all(np.isfinite(values)):
            raise UnsolvableError("the equation of motion is not finite everywhere; check masses, inertias and loads")
        return values, terms

    laws = (*(load.force for load in forces), *(load.torque for load in torques))
    most = [np.max(np.abs(law.values[..., part])) for law in laws for part in range(law.values.shape[-1])]
    values, terms = coefficients(np.linspace(first, last, LOOKS))
    moment = abs(torque) + timed + terms[2] + np.array(most) @ terms[4:]
    least_peak = LEAST * np.max(terms, axis=1)
    period = math.inf if not equations.driver.turns else FULL_TURN if path.turns is None else path.period
    table = tabulate(lambda angle: coefficients(angle)[0], ends=(first, last), least_peak=least_peak, period=period)
    rounding = float(ROUNDINGS * EPS * np.max(moment / values[0]))
    return FreeCrank(table, laws, torque, rounding, equations.driver.scale)


def _unit_loads(scene: Scene, forces: list[AppliedForce], torques: list[AppliedTorque]) -> list[Scene]:
    """One scene per component of the given loads, with that component at 1 and no other load."""
    bare = replace(scene, gravity=(0.0, 0.0), forces=(), torques=(), springs=(), dampers=())
    scenes = [
        replace(bare, forces=(replace(load, force=Law(np.array(unit))),))
        for load in forces
        for unit in ((1.0, 0.0), (0.0, 1.0))
    ]
    return scenes + [replace(bare, torques=(replace(load, torque=Law(np.array([1.0]))),)) for load in torques]


def _coefficients(
    equations: Equations, path: Path, steady: Scene, units: list[Scene], angle: Array
) -> tuple[Array, Array]:
    """Rows (c, n): q'ᵀMq', q'ᵀMq'', q'ᵀF at rest, drag per φ̇, and the levers of loads over φ; and their terms' sizes.

    The sizes take each coordinate's lever for at least one unit of length: what is small beside them is cancellation.
    """
    closed = path.closed(angle)
    solver = closed.solver(equations)
    first = transfer(equations, closed, solver)
    bend = bends(equations, closed, solver, first, np.ones(len(angle)))
    lever, second = (equations.spread(part) * equations.metres for part in (first, bend))
    pose, rest = closed.pose.scaled(equations.unit), np.zeros_like(lever)
    at_rest, moving = (applied_loads(steady, pose, rate) for rate in (rest, lever))
    forces = [equations.mass * lever, equations.mass * second, at_rest, at_rest - moving]
    forces += [applied_loads(unit, pose, rest) for unit in units]
    values = [np.sum(lever * force, axis=(1, 2)) for force in forces]
    reaches = np.abs(lever) + equations.metres
    sizes = [np.sum(reaches * np.abs(force), axis=(1, 2)) for force in forces]
    return np.stack(values).astype(float), np.stack(sizes).astype(float)
