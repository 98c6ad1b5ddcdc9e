"""The free crank: the constrained bodies' equation of motion projected on q', tabulated over φ.

With q̇ = q' φ̇ and q̈ = q' φ̈ + q'' φ̇² (coordinate partitioning: R. A. Wehage, E. J. Haug, ASME Journal of Mechanical
Design 104, 1982), the projection of M q̈ = F + Gᵀ λ on q' has no joint forces in it and reads

    (q'ᵀ M q') φ̈ = M1 + q'ᵀ F − (q'ᵀ M q'') φ̇²

whose coefficients depend on φ alone. They are solved from the bodies and tabulated. Loads over the crank angle need not
be smooth: only the levers they act on are tabulated, the loads are evaluated.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from analytic.description.law import Law
from engines.direct_adapter.collocation import Slope
from engines.direct_adapter.equations import Equations, Reals
from engines.direct_adapter.instants import metres, transfer
from engines.direct_adapter.loads import applied_loads
from engines.direct_adapter.path import Path
from engines.direct_adapter.table import Table, tabulate
from engines.scene import AppliedForce, AppliedTorque, Scene


@dataclass(frozen=True)
class EquationOfMotion:
    """φ̈ of a free crank with its derivative over φ̇, at angles and speeds (n,)."""

    table: Table
    laws: tuple[Law, ...]
    torque: float

    @property
    def breaks(self) -> Reals:
        """Angles of one turn at which a load over φ is not smooth, rad."""
        return np.unique(np.concatenate([[], *(law.angles for law in self.laws if law.angles is not None)]))

    def __call__(self, angle: Reals, speed: Reals) -> Slope:
        """For an integrator; raises UnsolvableError outside the table."""
        columns = self.table(angle)
        inertia, centrifugal, drag = columns[0], columns[1], columns[3]
        values = [value for law in self.laws for value in law(angle)]
        factors = np.stack([-speed * speed, np.ones_like(speed), -speed, *values])
        magnitude = abs(self.torque) + self.table.largest[1:] @ np.abs(factors)
        return Slope(
            (self.torque + np.sum(factors * columns[1:], axis=0)) / inertia,
            -(drag + 2.0 * centrifugal * speed) / inertia,
            magnitude / inertia,
        )


def equation_of_motion(equations: Equations, path: Path, torque: float) -> EquationOfMotion:
    """Tabulate the coefficients of the free crank's motion along a path."""
    scene = equations.scene
    forces = [load for load in scene.forces if not load.force.is_constant]
    torques = [load for load in scene.torques if not load.torque.is_constant]
    steady = replace(
        scene,
        forces=tuple(load for load in scene.forces if load.force.is_constant),
        torques=tuple(load for load in scene.torques if load.torque.is_constant),
    )
    units = _unit_loads(scene, forces, torques)

    def coefficients(angle: Reals) -> tuple[Reals, Reals]:
        return _coefficients(equations, path, steady, units, angle)

    laws = (*(load.force for load in forces), *(load.torque for load in torques))
    return EquationOfMotion(tabulate(coefficients, path), laws, torque)


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
    equations: Equations, path: Path, steady: Scene, units: list[Scene], angle: Reals
) -> tuple[Reals, Reals]:
    """Rows (c, n): q'ᵀMq', q'ᵀMq'', q'ᵀF at rest, drag per φ̇, and the levers of loads over φ; and their terms' sizes.

    The sizes take each coordinate's lever for at least one unit of length: what is small beside them is cancellation.
    """
    closed = path.closed(angle)
    solver = closed.solver(equations)
    first = transfer(equations, solver)
    bend = solver.solve(equations.bend(closed.arms, equations.spread(first)))
    lever, second = (equations.spread(part) * metres(equations) for part in (first, bend))
    rest = np.zeros_like(lever)
    at_rest, moving = (applied_loads(steady, equations, closed.pose, rate, angle) for rate in (rest, lever))
    forces = [equations.mass * lever, equations.mass * second, at_rest, at_rest - moving]
    forces += [applied_loads(unit, equations, closed.pose, rest, angle) for unit in units]
    values = [np.sum(lever * force, axis=(1, 2)) for force in forces]
    reaches = np.abs(lever) + metres(equations)
    sizes = [np.sum(reaches * np.abs(force), axis=(1, 2)) for force in forces]
    return np.stack(values), np.stack(sizes)
