"""Time measured properly: without the garbage collector, beside the machine's noise by a fixed piece of work."""

from __future__ import annotations

import gc
import statistics
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

T = TypeVar("T")

# The fixed work: interpreted arithmetic, then array arithmetic in the first-level cache; a millisecond or two in all.
_TURNS, _PASSES, _SIZE = 16000, 120, 2000
WORK = f"{_TURNS} interpreted additions and {_PASSES} passes over {_SIZE} floats"


@dataclass(frozen=True)
class Noise:
    """Times of the same work, s, spread over a whole measurement; the figures are 0 without a sample."""

    samples: tuple[float, ...]

    @property
    def least(self) -> float:
        """The shortest, s: the machine left alone."""
        return min(self.samples, default=0.0)

    @property
    def median_excess(self) -> float:
        """Median over shortest time, less 1."""
        return statistics.median(self.samples) / self.least - 1.0 if self.samples else 0.0

    @property
    def spread(self) -> float:
        """Ninth decile over shortest time, less 1."""
        return float(np.quantile(self.samples, 0.9)) / self.least - 1.0 if self.samples else 0.0


def calibrate() -> float:
    """Do the fixed work once and say how long it took, s."""
    values = np.linspace(0.0, 1.0, _SIZE)
    begun = time.perf_counter()
    total = 0.0
    for turn in range(_TURNS):
        total += 0.5 * turn
    for _ in range(_PASSES):
        values = np.sqrt(values * values + 1e-12)
    return time.perf_counter() - begun


@contextmanager
def no_collection() -> Iterator[None]:
    """Switch the garbage collector off while timing, and back to its former state afterwards."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


def timed(work: Callable[[], T]) -> tuple[T, float]:
    """The return value of ``work`` and its wall time, s."""
    with no_collection():
        begun = time.perf_counter()
        result = work()
        return result, time.perf_counter() - begun
