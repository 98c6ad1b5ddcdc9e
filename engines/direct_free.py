"""The free crank: the constrained bodies' equation of motion projected on q', tabulated over φ, integrated over time.

With q̇ = q' φ̇ and q̈ = q' φ̈ + q'' φ̇² (coordinate partitioning: R. A. Wehage, E. J. Haug, ASME Journal of Mechanical
Design 104, 1982), the projection of M q̈ = F + Gᵀ λ on q' has no joint forces in it and reads

    (q'ᵀ M q') φ̈ = M1 + q'ᵀ F − (q'ᵀ M q'') φ̇²

whose coefficients depend on φ alone. They are solved from the bodies at Chebyshev points of short panels, which are
halved until the series ends in rounding. Loads over the crank angle need not be smooth: only the levers they act on
are tabulated, the loads are evaluated.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial import chebyshev

from analytic.laws import Law
from engines.contract import AppliedForce, AppliedTorque, Scene
from engines.direct_assembly import UnsolvableError
from engines.direct_collocation import Slope
from engines.direct_equations import Equations, Reals
from engines.direct_instants import metres, transfer
from engines.direct_loads import applied_loads
from engines.direct_path import FULL_TURN, Path

POINTS = 16
PANELS = 24
HALVINGS = 12
TAIL = 1e-14  # of a coefficient's largest value: where a panel's series may end
NOISE = 1e-9  # likewise, where rounding keeps it from ending in less


@dataclass(frozen=True)
class Table:
    """Coefficients over φ on panels between ``edges`` (p + 1,): ``series`` (p, columns, points), Chebyshev.

    ``largest`` (columns,) is the largest magnitude of each.
    """

    edges: Reals
    series: Reals
    largest: Reals
    repeats: bool

    def __call__(self, angle: Reals) -> Reals:
        """All columns (c, n) at crank angles (n,); raises UnsolvableError outside the panels."""
        start, end = self.edges[0], self.edges[-1]
        if self.repeats:
            angle = start + (angle - start) % FULL_TURN
        outside = ~((angle >= start) & (angle <= end))
        if not self.repeats and np.any(outside):
            stop = math.degrees(end if angle[np.argmax(outside)] > end else start)
            raise UnsolvableError(f"the free crank runs up against its stop at {stop:.4g}°")
        panel = np.clip(np.searchsorted(self.edges, angle, side="right") - 1, 0, len(self.series) - 1)
        left, right = self.edges[panel], self.edges[panel + 1]
        x = np.clip((2.0 * angle - left - right) / (right - left), -1.0, 1.0)
        terms = np.cos(np.arccos(x)[:, None] * _ORDERS)
        return np.asarray((self.series[panel] @ terms[..., None])[..., 0].T)


_ORDERS = np.arange(POINTS, dtype=float)
_NODES = chebyshev.chebpts1(POINTS)
_TO_SERIES = np.linalg.inv(chebyshev.chebvander(_NODES, POINTS - 1))


def tabulate(columns: Callable[[Reals], Reals], path: Path) -> Table:
    """Chebyshev series of ``columns`` (angles (n,) in, (c, n) out) over a path."""
    edges = np.linspace(path.angle[0], path.angle[-1], PANELS + 1)
    todo = [(float(left), float(right), np.inf) for left, right in itertools.pairwise(edges)]
    done: list[tuple[float, Reals]] = []
    largest = np.zeros(0)
    for halving in range(HALVINGS + 1):
        series, values = _fitted(columns, todo)
        sizes = np.max(np.abs(values), axis=(1, 2))
        largest = np.maximum(largest, sizes) if len(largest) else sizes
        tails = np.max(np.abs(series[:, :, -2:]) / np.where(largest > 0.0, largest, 1.0)[:, None], axis=(1, 2))
        before = np.array([tail for *_, tail in todo])
        # What is small and does not get smaller by halving is rounding.
        ended = (tails <= TAIL) | ((tails <= NOISE) & (tails > 0.5 * before)) | (halving == HALVINGS)
        done += [(todo[i][0], series[i]) for i in np.flatnonzero(ended)]
        todo = [half for i in np.flatnonzero(~ended) for half in _halves(*todo[i][:2], float(tails[i]))]
        if not todo:
            break
    done.sort(key=lambda panel: panel[0])
    starts = [start for start, _ in done]
    series = np.stack([part for _, part in done])
    return Table(np.array([*starts, path.angle[-1]]), series, largest, path.turns is not None)


Panel = tuple[float, float, float]  # start, end, tail of the series of the panel it is half of


def _fitted(columns: Callable[[Reals], Reals], panels: list[Panel]) -> tuple[Reals, Reals]:
    """Series (p, c, points) and the values (c, p, points) they are fitted to."""
    left, right = np.array([panel[:2] for panel in panels]).T
    angles = 0.5 * (left + right)[:, None] + 0.5 * (right - left)[:, None] * _NODES
    values = columns(angles.ravel()).reshape(-1, *angles.shape)
    if not np.all(np.isfinite(values)):
        raise UnsolvableError("the equation of motion is not finite everywhere; check masses, inertias and loads")
    return np.einsum("kj,cpj->pck", _TO_SERIES, values), values


def _halves(left: float, right: float, tail: float) -> tuple[Panel, Panel]:
    middle = 0.5 * (left + right)
    return (left, middle, tail), (middle, right, tail)


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
    varying = [load for load in scene.forces if not load.force.is_constant]
    turning = [load for load in scene.torques if not load.torque.is_constant]
    steady = replace(
        scene,
        forces=tuple(load for load in scene.forces if load.force.is_constant),
        torques=tuple(load for load in scene.torques if load.torque.is_constant),
    )
    levers = _unit_loads(scene, varying, turning)

    def columns(angle: Reals) -> Reals:
        return _columns(equations, path, steady, levers, angle)

    laws = (*(load.force for load in varying), *(load.torque for load in turning))
    return EquationOfMotion(tabulate(columns, path), laws, torque)


def _unit_loads(scene: Scene, forces: list[AppliedForce], torques: list[AppliedTorque]) -> list[Scene]:
    """One scene per component of the given loads, with that component at 1 and no other load."""
    bare = replace(scene, gravity=(0.0, 0.0), forces=(), torques=(), springs=(), dampers=())
    scenes = [
        replace(bare, forces=(replace(load, force=Law(np.array(unit))),))
        for load in forces
        for unit in ((1.0, 0.0), (0.0, 1.0))
    ]
    return scenes + [replace(bare, torques=(replace(load, torque=Law(np.array([1.0]))),)) for load in torques]


def _columns(equations: Equations, path: Path, steady: Scene, levers: list[Scene], angle: Reals) -> Reals:
    """Rows: q'ᵀMq', q'ᵀMq'', q'ᵀF at rest, the drag per φ̇, and the levers of the loads over φ."""
    closed = path.closed(angle)
    solver = closed.solver(equations)
    coordinates = transfer(equations, solver)
    bend = solver.solve(equations.bend(closed.arms, equations.spread(coordinates)))
    lever, second = (equations.spread(part) * metres(equations) for part in (coordinates, bend))

    def power(scene: Scene, rate: Reals) -> Reals:
        return np.asarray(np.sum(lever * applied_loads(scene, equations, closed.pose, rate, angle), axis=(1, 2)))

    rest = np.zeros_like(lever)
    moment = power(steady, rest)
    weighted = equations.mass * lever
    return np.stack(
        [
            np.sum(weighted * lever, axis=(1, 2)),
            np.sum(weighted * second, axis=(1, 2)),
            moment,
            moment - power(steady, lever),
            *(power(scene, rest) for scene in levers),
        ]
    )
