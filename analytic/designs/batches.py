"""Many designs in one sweep: a linkage whose numbers are arrays, one row for each design.

A linkage with a group of class III, a cylinder or change points goes design by design, for the configuration of such a
group is followed for every linkage anew.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import changed
from analytic.description.linkage import Linkage
from analytic.kinematics.decomposition import find_structure
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
# Sweeps that note their faults, of the designs of some rows (n,), at crank angles, rad, of a shape (n, ...).
Sweeps = Callable[[Integers, Array], Sweep]


def goes_together(mechanism: Mechanism) -> bool:
    """Whether all designs of a linkage can be put into one sweep."""
    return not mechanism.is_numerical and not any(dyad.changes for dyad in mechanism.structure.dyads)


def together(mechanism: Mechanism, arrays: Mapping[str, Array]) -> Sweeps:
    """Sweeps of designs that differ in ``arrays`` (designs,) of numbers by name, in the assembly modes as described."""
    signs = tuple(dyad.sign for dyad in mechanism.structure.dyads)

    def sweep(rows: Integers, phi: Array) -> Sweep:
        own = {name: values[rows, None] for name, values in arrays.items()}
        linkage = _with(mechanism.linkage, own)
        return Sweep(linkage, find_structure(linkage).with_signs(signs), phi, np.zeros(phi.shape, dtype=bool))

    return sweep


def alone(mechanism: Mechanism, arrays: Mapping[str, Array], design: int) -> Sweeps:
    """Sweeps of one of these designs; raises AssemblyError where it cannot be assembled as its sketch shows it."""
    own = mechanism.redesigned(_with(mechanism.linkage, {name: float(a[design]) for name, a in arrays.items()}))
    return lambda _, phi: Sweep(own.linkage, own.structure, phi, np.zeros(phi.shape, dtype=bool))


def _with(linkage: Linkage, numbers: Mapping[str, Any]) -> Linkage:
    return changed(linkage, lambda name, _, value: numbers.get(name, value))
