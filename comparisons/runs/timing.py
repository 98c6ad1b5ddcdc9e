"""Time measured properly: the machine's noise by a fixed piece of work, and what importing an engine costs."""

from __future__ import annotations

import gc
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

T = TypeVar("T")

# The fixed work: interpreted arithmetic, then array arithmetic in the first-level cache; a millisecond or two in all.
_TURNS, _PASSES, _SIZE = 16000, 120, 2000
WORK = f"{_TURNS} interpreted additions and {_PASSES} passes over {_SIZE} floats"

_FIRST_USE_LIMIT = 120.0  # s
# In a fresh interpreter that has loaded the adapter and a linkage: what the first scene costs more than the second.
_FIRST_USE = """
import time
from analytic.description.loading import catalogue, load
from analytic.kinematics.mechanism import Mechanism
from analytic.description.crank_motion import crank_motion
from comparisons.reference.case import Case
from engines.scene import Channel
from engines.registry import engine
scene = Case(Mechanism(load(catalogue()[0])), crank_motion("constant-speed")).scene([Channel.TORQUE])
spent = []
begun = time.perf_counter()
adapter = engine({name!r})
method = adapter.methods(scene)[0]
for _ in range(2):
    adapter.run_method(scene, method, 2e-3)
    spent.append(time.perf_counter() - begun)
    begun = time.perf_counter()
print(spent[0] - spent[1])
"""


@dataclass(frozen=True)
class Noise:
    """How long the same work took each time, s, spread over the whole of a measurement; all 0 if it never did."""

    samples: tuple[float, ...]

    @property
    def least(self) -> float:
        """The shortest, s: the machine left alone."""
        return min(self.samples, default=0.0)

    @property
    def median_excess(self) -> float:
        """How much longer the median is than the shortest, as a share of it."""
        return statistics.median(self.samples) / self.least - 1.0 if self.samples else 0.0

    @property
    def spread(self) -> float:
        """How much longer than the shortest nine in ten are at most, as a share of it."""
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
    """Keep the garbage collector out of what is timed; it is left as it was found."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


def timed(work: Callable[[], T]) -> tuple[T, float]:
    """What ``work`` returns and the wall time it took, s."""
    with no_collection():
        begun = time.perf_counter()
        result = work()
        return result, time.perf_counter() - begun


def first_use_seconds(engine: str, repeats: int = 3) -> tuple[float, ...]:
    """What an engine's first scene costs beyond its second, each in a fresh interpreter, s: import and first touch.

    An engine that cannot run a scene there costs nothing that could be told: an empty tuple.
    """
    command = [sys.executable, "-c", _FIRST_USE.format(name=engine)]
    found: list[float] = []
    for _ in range(repeats):
        with suppress(subprocess.TimeoutExpired, IndexError, ValueError):  # it may hang, and write anything
            done = subprocess.run(command, capture_output=True, timeout=_FIRST_USE_LIMIT, check=False)
            if done.returncode == 0:
                found.append(max(0.0, float(done.stdout.split()[-1])))
    return tuple(found)


def smallest_and_median(samples: Sequence[float]) -> tuple[float | None, float | None]:
    """Both, or None for each where nothing was measured."""
    return (min(samples), statistics.median(samples)) if samples else (None, None)
