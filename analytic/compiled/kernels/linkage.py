"""A linkage over blocks of crank angles, compiled once for all linkages.

For callers in compiled code, an integrator above all:

``equation_terms(tables, design, angle, work) -> (moment, damping, inertia, half_slope, is_moving)``
    The terms of the equation of motion at one crank angle φ, rad: Q, N m, without the crank torque M1; b, N m s;
    Jeq, kg m²; ½ Jeq', kg m²; and whether the linkage can be assembled and moves there (if not, the rest is rubbish).

``equation_rows(tables, design, n, work) -> faults``
    The same at ``n <= BLOCK`` crank angles, many times cheaper per angle: put them into ``work[ANGLE : ANGLE + n]``,
    and find the terms from ``work[SUMS + FORCE]``, ``work[SUMS + DAMPING]``, ``work[SUMS + JEQ]`` and
    ``work[SUMS + HALF_SLOPE]`` on; ``faults`` counts the angles at which there is no motion.

``tables`` are those of ``analytic.compiled.flat_linkage.program(mechanism)``; ``design`` and ``work`` are made once by
``design_of(program)`` and ``scratch(program)``. A ``work`` belongs to one thread. Nothing is allocated.

An entry of another file that calls these must be compiled by ``kernels_jit.entry`` and end in the parameter
``sources: int = SOURCES``, see there.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.flat_linkage import CRANK_BODY, Program, Tables
from analytic.compiled.kernels.constants import derive
from analytic.compiled.kernels.jit import SOURCES, entry
from analytic.compiled.kernels.layout import (
    ANGLE,
    BLOCK,
    BODY,
    COSINE,
    CRANK_CONSTANTS,
    DAMPING,
    DW,
    DYAD_CONSTANTS,
    FAULT,
    FORCE,
    HALF_SLOPE,
    JEQ,
    LAW,
    LAWS,
    SINE,
    SUMS,
    C,
)
from analytic.compiled.kernels.solution import faults, solve
from analytic.compiled.kernels.sums import constant_laws, sum_forces, sum_half_slope, sum_inertia, tabled_laws
from analytic.compiled.kernels.trigonometry import cosines_and_sines

Array = NDArray[np.float64]


def design_of(program: Program) -> Array:
    """The linkage as it is described, with the constants derived from it."""
    design = np.zeros(design_size(program))
    design[: len(program.numbers)] = program.numbers
    derived(program.tables, design)
    return design


def design_size(program: Program) -> int:
    """Floats of a design."""
    return len(program.numbers) + CRANK_CONSTANTS + DYAD_CONSTANTS * len(program.structure.dyads)


def scratch(program: Program) -> Array:
    """Scratch memory for one thread."""
    ground = LAWS + LAW * len(program.tables.laws)
    crank = ground + BODY * CRANK_BODY
    work = np.zeros(ground + BODY * len(program.bodies))
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
    sum_half_slope(tables, design, n, work)
    sum_forces(tables, design, n, work)
    return faults(n, work[FAULT : FAULT + BLOCK])


@entry
def equation_terms(
    tables: Tables, design: Array, angle: float, work: Array, sources: int = SOURCES
) -> tuple[float, float, float, float, bool]:
    """Terms of the equation of motion at one angle; see the head of this file."""
    work[ANGLE] = angle
    n = min(len(work), 1)  # a literal 1 would be compiled apart, with everything inside
    missing = equation_rows(tables, design, n, work)
    return (
        work[SUMS + FORCE],
        work[SUMS + DAMPING],
        work[SUMS + JEQ],
        work[SUMS + HALF_SLOPE],
        missing == 0.0,
    )
