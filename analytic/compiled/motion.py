"""The motion of a crank integrated in compiled code: the kernels of the linkage inside the loop over the windows.

The method is that of ``analytic.numerics.integration``, of a higher order. The equation is read from its table, which
is good to a few roundings, else from the linkage at every node; ``FreeMotion.error_bound`` compares the motion with one
of another integrator and another table. The formulas of the linkage are the same.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.choice import kernels
from analytic.compiled.flat_linkage import FlatLinkage, flatten, has_kernels
from analytic.description.linkage import LinkTorque
from analytic.dynamics.equation_of_motion import EquationOfMotion
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.numerics import integration
from analytic.numerics.collocation import GaussScheme, Windows, gauss_scheme

if TYPE_CHECKING:
    from analytic.compiled.kernels.integration import Space

Array = NDArray[np.float64]

# A multiple of the eight numbers that a processor works on at once. Of 14 to 32, 24 was the quickest by a fifth.
NODES: Final = 24
# Read from a table, nodes cost less and products more. Of 8 to 24, the quickest at 1e-12 and at 1e-5.
TABLE_NODES: Final = 20
LOOSE, LOOSE_NODES = 1e-7, 14
NO_CELLS: Final = (np.empty(1), 1.0, np.empty((0, 1, 3)))


def is_able(equation: EquationOfMotion) -> bool:
    """Whether the kernels know an equation."""
    return equation.half_slope == "exact" and equation.over_time is None and has_kernels(equation.mechanism.structure)


def check_able(equation: EquationOfMotion) -> None:
    """Raise LinkproofError where this path is asked for and cannot be taken."""
    if not is_able(equation):
        raise LinkproofError(
            f"path: expected 'numpy' or 'auto' with the half slope '{equation.half_slope}' of a linkage "
            f"{equation.mechanism.structure.formula}, got 'compiled', whose kernels know the exact one only, of cranks "
            "that turn, groups of class II and no change points; leave the path out"
        )
    kernels("integration")


def integrate(
    equation: EquationOfMotion, start: tuple[float, float], duration: float, *, tolerance: float, rounding: float
) -> Windows | None:
    """``analytic.numerics.integration.integrate`` of an equation that the kernels know; None where it would raise."""
    integrator = kernels("integration")
    table = equation.table
    flat = _flattened(equation) if table is None else _flat(equation.mechanism)
    cells = NO_CELLS if table is None else (table.edges, table.period, table.coefficients)
    nodes = NODES if table is None else TABLE_NODES if tolerance < LOOSE else LOOSE_NODES
    scheme, (design, space) = gauss_scheme(nodes), _memory(flat, nodes)
    most = integration.MOST_WINDOWS
    # Memory that is never written to costs nothing.
    starts, base = np.empty(most + 1), np.empty(most)
    angles, speeds = np.empty((most, len(scheme.angle))), np.empty((most, len(scheme.speed)))
    tolerance = max(tolerance, integration.LEAST_TOLERANCE)
    count = integrator.advance(
        flat.tables,
        design,
        integrator.Cells(*cells),
        _transposed(nodes),
        (float(start[0]), float(start[1])),
        float(duration),
        tolerance,
        rounding,
        space,
        starts,
        base,
        angles,
        speeds,
    )
    if count == integrator.LOST:
        return None
    ends = starts[: count + 1].copy()
    return Windows(ends, base[:count].copy(), _columns(angles[:count]), _columns(speeds[:count]))


def _columns(rows: Array) -> Array:
    """One window a column, in memory of their own."""
    return np.ascontiguousarray(rows.T)


def _flattened(equation: EquationOfMotion) -> FlatLinkage:
    """The linkage with the crank torque as one of its loads."""
    mechanism = equation.mechanism
    if np.any(equation.torque.values):
        linkage = mechanism.linkage
        load = LinkTorque(linkage.crank, equation.torque)
        mechanism = Mechanism(replace(linkage, torques=(*linkage.torques, load)))
    return flatten(mechanism)


_flat = lru_cache(maxsize=8)(flatten)


def _memory(flat: FlatLinkage, nodes: int) -> tuple[Array, Space]:
    linkage, space = kernels("linkage"), kernels("integration").Space
    rows = {name: np.empty(nodes) for name in space._fields}
    return linkage.design_of(flat), space(**{**rows, "work": linkage.scratch(flat)})


@lru_cache
def _transposed(nodes: int) -> GaussScheme:
    """The scheme as the kernels take it."""
    return GaussScheme(*(np.ascontiguousarray(part.T) for part in gauss_scheme(nodes)))
