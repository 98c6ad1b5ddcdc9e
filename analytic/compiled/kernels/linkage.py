"""A linkage over blocks of crank angles, compiled once for all linkages.

For callers in compiled code, an integrator above all:

``equation_rows(tables, design, n, work) -> faults``
    The terms of the equation of motion at ``n <= BLOCK`` crank angles φ, rad, in ``work[ANGLE : ANGLE + n]``: Q, N m,
    without the crank torque M1, from ``work[SUMS + FORCE]`` on; b, N m s, from ``work[SUMS + DAMPING]`` on; Jeq and
    ½ Jeq', kg m², from ``work[SUMS + JEQ]`` and ``work[SUMS + HALF_DERIVATIVE]`` on. ``faults`` counts the angles at
    which there is no motion; the terms there mean nothing.

``tables`` are those of ``analytic.compiled.flat_linkage.flatten(mechanism)``; ``design`` and ``work`` are made once by
``design_of(flat)`` and ``scratch(flat)``. A ``work`` belongs to one thread. Nothing is allocated.

An entry of another file that calls these must be compiled by ``jit.entry`` and end in the parameter
``sources: int = SOURCES``, see there.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.flat_linkage import CRANK_BODY, FlatLinkage, Tables
from analytic.compiled.kernels import layout
from analytic.compiled.kernels.constants import derive
from analytic.compiled.kernels.jit import SOURCES, entry
from analytic.compiled.kernels.layout import ANGLE, BLOCK, BODY, COSINE, DW, FAULT, LAW, LAWS, SINE, C
from analytic.compiled.kernels.solution import faults, solve
from analytic.compiled.kernels.sums import constant_laws, sum_forces, sum_half_derivative, sum_inertia, tabled_laws
from analytic.compiled.kernels.trigonometry import cosines_and_sines

Array = NDArray[np.float64]


def design_of(flat: FlatLinkage) -> Array:
    """The linkage as it is described, with the constants derived from it."""
    design = np.zeros(design_size(flat))
    design[: len(flat.numbers)] = flat.numbers
    derived(flat.tables, design)
    return design


def design_size(flat: FlatLinkage) -> int:
    """Floats of a design."""
    return len(flat.numbers) + layout.CRANK_CONSTANTS + layout.DYAD_CONSTANTS * len(flat.structure.dyads)


def scratch(flat: FlatLinkage) -> Array:
    """Scratch memory for one thread."""
    ground = LAWS + LAW * len(flat.tables.laws)
    crank = ground + BODY * CRANK_BODY
    work = np.zeros(crank + BODY * (1 + 2 * len(flat.structure.dyads)))
    work[ground + C : ground + C + BLOCK] = 1.0
    work[crank + DW : crank + DW + BLOCK] = 1.0
    return work


@entry
def derived(tables: Tables, design: Array, sources: int = SOURCES) -> None:
    """Fill in a design's constants behind its numbers."""
    derive(tables, design)


@entry
def equation_rows(tables: Tables, design: Array, n: int, work: Array, sources: int = SOURCES) -> float:
    """Terms of the equation of motion at ``n`` angles; see the head of this file."""
    cosines_and_sines(n, work[ANGLE : ANGLE + BLOCK], work[COSINE : COSINE + BLOCK], work[SINE : SINE + BLOCK])
    solve(tables, design, n, tables.levels, work)
    tabled_laws(tables, n, work)
    constant_laws(tables, design, n, work)
    sum_inertia(tables, design, n, work)
    sum_half_derivative(tables, design, n, work)
    sum_forces(tables, design, n, work)
    return faults(n, work[FAULT : FAULT + BLOCK])
