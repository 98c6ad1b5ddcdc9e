"""Many designs in one sweep: a linkage whose numbers are arrays, one row for each design.

A linkage with a group of class III, a cylinder or change points goes design by design, for the configuration of such a
group is followed for every linkage anew.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.compiled.evaluation import in_threads
from analytic.description.changes import with_numbers
from analytic.errors import AssemblyError, StructureError
from analytic.kinematics.decomposition import find_structure
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Booleans = NDArray[np.bool_]
# Designs times crank angles of one sweep. Measured on the six-bar: from 6144 to 18 432 the cost is the same within a
# tenth, 3072 cost half as much again.
BLOCK: Final = 9216
# Sweeps that note their faults, of the designs of some rows (n,), at crank angles, rad, of a shape (n, ...).
Sweeps = Callable[[Integers, Array], Sweep]


def in_blocks(
    mechanism: Mechanism,
    arrays: Mapping[str, Array],
    size: int,
    work: Callable[[Integers, Sweeps], None],
    cores: int | None,
) -> None:
    """Call ``work`` with the rows of up to ``size`` designs at a time and their sweeps, on so many threads.

    Designs differ in ``arrays`` (designs,) of numbers by name and are in the assembly modes as described. Those of
    which nothing can be said, as a group that is followed cannot be assembled as its sketch shows it, are left out.
    """
    count = len(next(iter(arrays.values())))
    jointly = goes_together(mechanism)
    jointly_swept = _together(mechanism, arrays)

    def part(rows: range) -> None:
        with np.errstate(all="ignore"):
            try:
                work(np.asarray(rows), jointly_swept if jointly else _alone(mechanism, arrays, rows.start))
            except (AssemblyError, StructureError):
                return

    step = size if jointly else 1
    in_threads(part, [range(first, min(first + step, count)) for first in range(0, count, step)], cores)


def goes_together(mechanism: Mechanism) -> bool:
    """Whether all designs of a linkage can be put into one sweep."""
    return not mechanism.is_numerical and not any(dyad.changes for dyad in mechanism.structure.dyads)


def faults_of(sweep: Sweep) -> Booleans:
    """Where a sweep that notes its faults has any, a copy."""
    assert sweep.faults is not None
    return sweep.faults.copy()


def _together(mechanism: Mechanism, arrays: Mapping[str, Array]) -> Sweeps:
    """Sweeps of many designs. What is zero in all of them is a plain zero, which takes no work."""
    signs = tuple(dyad.sign for dyad in mechanism.structure.dyads)
    zeros = {name: 0.0 for name, values in arrays.items() if not np.any(values)}

    def sweep(rows: Integers, phi: Array) -> Sweep:
        linkage = with_numbers(mechanism.linkage, {name: values[rows, None] for name, values in arrays.items()} | zeros)
        return Sweep(linkage, find_structure(linkage).with_signs(signs), phi, np.zeros(phi.shape, dtype=bool))

    return sweep


def _alone(mechanism: Mechanism, arrays: Mapping[str, Array], design: int) -> Sweeps:
    """Sweeps of one of these designs; raises AssemblyError where it cannot be assembled as its sketch shows it."""
    own = mechanism.redesigned(with_numbers(mechanism.linkage, {name: float(a[design]) for name, a in arrays.items()}))
    return lambda _, phi: Sweep(own.linkage, own.structure, phi, np.zeros(phi.shape, dtype=bool))
