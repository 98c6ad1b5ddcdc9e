"""Signals of many designs of one linkage at crank angles: by a list of operations, or design by design.

Designs of a linkage of dyads have one list (``analytic.machine_code``), which NumPy computes, or machine code where
that saves time. With groups of class III, a cylinder or change points the configuration is followed for every linkage
anew, design by design.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.description.changes import with_numbers
from analytic.errors import AssemblyError, StructureError
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.sweep import Sweep
from analytic.machine_code.compiling import StraightFunction, is_worthwhile
from analytic.machine_code.linkage_trace import LinkageTrace, is_traceable, linkage_trace
from analytic.machine_code.printing import Result
from analytic.moving import MovingSweep
from analytic.signals import is_wrapped, signal

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Booleans = NDArray[np.bool_]

# Designs times crank angles computed at once. Measured on the six-bar: from 6144 to 18 432 the cost is the same within
# a tenth, 3072 cost half as much again.
BLOCK: Final = 9216
ONE_ROW: Final = np.empty((1, 0))


class Samples(NamedTuple):
    """Signals of designs at crank angles, (signals, designs, angles).

    ``moves`` (designs, angles) tells where a design can be assembled and moved; elsewhere the signals are nan or
    meaningless. ``determinants`` (dyads, designs, angles) are magnitudes, zero in dead positions.
    """

    signals: Array
    moves: Booleans
    determinants: Array


@dataclass(frozen=True)
class Designs:
    """Designs that differ in ``arrays`` (designs,) of numbers by name, SI, in the assembly modes as described.

    The crank has a ``speed``, rad/s, and an ``acceleration``, rad/s², numbers or (angles,). ``poses`` is how many of
    them are wanted in all, by which the ``path`` "auto" decides whether to compile.
    """

    mechanism: Mechanism
    arrays: Mapping[str, Array]
    signals: tuple[str, ...]
    speed: Any
    acceleration: Any = 0.0
    all_groups: bool = True
    path: str = "auto"
    poses: float = 0.0

    @cached_property
    def list(self) -> LinkageTrace | None:
        """The signals as a list of operations, None where the designs have none."""
        if not is_traceable(self.mechanism):
            return None
        return linkage_trace(
            self.mechanism,
            [name for name, values in self.arrays.items() if np.any(values)],
            self.signals,
            zero=[name for name, values in self.arrays.items() if not np.any(values)],
            accelerates=bool(np.any(self.acceleration)),
            all_groups=self.all_groups,
        )

    def at(self, rows: Integers, phi: Array) -> Samples:
        """Samples of the designs of some rows (n,), at crank angles, rad, (n, m)."""
        if self.list is None:
            parts = [self._by_sweep(row, own) for row, own in zip(rows, phi, strict=True)]
            return Samples(*(np.stack(arrays, axis=-2) for arrays in zip(*parts, strict=True)))
        places = phi[:1] if phi.strides[0] == 0 else phi  # every design's own
        numbers = {name: values[rows, None] for name, values in self.arrays.items()}
        known, lines = self.list.values(numbers, places, self.speed, self.acceleration), self.list.lines
        if self._function is None:
            found = self.list.trace.computed(lines, known)
        else:
            given = self.list.trace.computed(self._function.lanes, known)
            lanes = [np.broadcast_to(values, phi.shape).reshape(-1) for values in given]
            found = list(self._function(lanes, ONE_ROW, phi.size).reshape(len(lines), *phi.shape))
        count = len(self.signals)
        values = np.stack([np.broadcast_to(value, phi.shape) for value in found[:count]])
        for row, name in enumerate(self.signals):
            if is_wrapped(name, self.mechanism.linkage):
                values[row] = np.unwrap(values[row])
        determinants = [np.broadcast_to(value, phi.shape) for value in found[count + 1 :]]
        moves = np.broadcast_to(np.asarray(found[count], dtype=bool), phi.shape)
        return Samples(values, moves, np.reshape(determinants, (len(determinants), *phi.shape)))

    @cached_property
    def _function(self) -> StraightFunction | None:
        """The list as machine code, None where NumPy serves."""
        assert self.list is not None
        lines, trace = self.list.lines, self.list.trace
        if not is_worthwhile(self.path, len(trace.leading_to(lines)), self.poses):
            return None
        given = sorted(line for border in self.list.borders(lines) for line in border)
        return StraightFunction(trace, given, (), [Result(line) for line in lines])

    def _by_sweep(self, row: int, phi: Array) -> Samples:
        """Samples of one design at crank angles (m,): a group that is followed cannot be assembled in all of them."""
        design = with_numbers(
            self.mechanism.linkage, {name: float(values[row]) for name, values in self.arrays.items()}
        )
        faults = np.zeros(phi.shape, dtype=bool)
        try:
            own = self.mechanism.redesigned(design)
            sweep = Sweep(own.linkage, own.structure, phi, faults)
            with np.errstate(all="ignore"):
                for body in own.structure.bodies if self.all_groups else ():
                    sweep.rates(body)
                at = MovingSweep(own, sweep, np.asarray(self.speed), np.asarray(self.acceleration))
                values = np.stack([signal(at, name) for name in self.signals])
                dyads = own.structure.dyads if self.all_groups else ()
                sizes = [np.broadcast_to(abs(sweep.determinant(dyad)), phi.shape) for dyad in dyads]
        except (AssemblyError, StructureError):
            none = np.full((len(self.signals), *phi.shape), np.nan)
            return Samples(none, np.zeros(phi.shape, dtype=bool), np.ones((0, *phi.shape)))
        return Samples(values, ~faults, np.reshape(sizes, (len(sizes), *phi.shape)))
