"""A fault: one thing that may be wrong with a simulation, what it does, its sentence and its cure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from comparisons.faults.simulation import Simulation

Array = NDArray[np.float64]
Numbers = tuple[float, ...]


class Kind(IntEnum):
    """Where a fault lies, in the order in which an engineer looks: of causes that fit alike the first is named."""

    COLUMN = 0  # sign, unit or meaning of a column of the file
    SETTING = 1  # one setting of the tool: gravity, direction, start, units, what is left out
    NUMBER = 2  # one number of the description
    SEVERAL = 3  # several numbers at once
    FREE = 4  # a factor of a column that no unit explains


@dataclass(frozen=True)
class Correction:
    """A correction that a mapping may accept: ``sign * factor * value + offset`` at the time + ``time_shift``; SI."""

    sign: int = 1
    factor: float = 1.0
    time_shift: float = 0.0
    offset: float = 0.0

    def compose(self, first: Correction) -> Correction:
        """The correction that applies ``first``, then this one."""
        return Correction(
            self.sign * first.sign,
            self.factor * first.factor,
            self.time_shift + first.time_shift,
            self.sign * self.factor * first.offset + self.offset,
        )


Cure = Callable[[Array], dict[str, Correction]]


@dataclass(frozen=True)
class Fault:
    """One thing that may be wrong: ``apply(simulation, numbers)`` is the simulation with it.

    Raises LinkproofError where the linkage cannot be so. ``start`` (k,) are the numbers with which nothing is wrong,
    ``sizes`` what counts as a change of each; fits begin at the ``guesses``, and ``usual`` numbers are tried as they
    are. ``unit`` is that in which a single number is written, as SI value: round ones are likelier. ``words(numbers)``
    is its sentence, ``cure(numbers)`` gives corrections by the names of signals, "*" for all.
    One that ``reshapes`` the linkage makes it move otherwise.
    """

    name: str
    kind: Kind
    apply: Callable[[Simulation, Array], Simulation]
    words: Callable[[Array], str]
    start: Numbers = ()
    sizes: Numbers = ()
    guesses: tuple[Numbers, ...] = ()
    usual: tuple[Numbers, ...] = ()
    unit: float = 0.0
    cure: Cure = lambda _: {}
    reshapes: bool = False

    def plant(self, simulation: Simulation, *numbers: float) -> Simulation:
        """The simulation with this fault, at these numbers."""
        return self.apply(simulation, np.array(numbers, dtype=float))
