"""Searches of an optimum everywhere, by seed: how far the least they find differs, and what it cost.

``python -m tests.targets.global_seeds [COUNT]`` prints the spread for each set of numbers.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analytic.description.crank_motion import RPM
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.designs.optimum.optimisation import OptimisationRequest, optimise
from comparisons.designs.steady_motion import steady_motion

MECHANISM, FIGURE, KEPT = "rimoldi-164", "Mkr.peak", "stroke"
SETS = (("rod.B.x", "rocker.B.x", "link.D.x"), ("rod.B.x", "rocker.B.x", "rocker.C.x"))
SEEDS = 20
SPREAD = 1e-6  # of the least, by which all seeds are to agree


@dataclass(frozen=True)
class Seeded:
    """What searches with seeds 0, 1, ... found: the least of each, searches downhill and designs with derivatives."""

    least: tuple[float, ...]
    ends: tuple[int, ...]
    gradients: tuple[int, ...]
    seconds: float

    @property
    def agreeing(self) -> int:
        """How many are as low as the lowest but for ``SPREAD``."""
        return int(np.count_nonzero(np.array(self.least) <= min(self.least) * (1.0 + SPREAD)))

    @property
    def spread(self) -> float:
        """Largest less least of them, as a share of the least."""
        return max(self.least) / min(self.least) - 1.0


def seeded(names: Sequence[str], count: int = SEEDS) -> Seeded:
    """The searches with ``count`` seeds over numbers within ±10 %, the stroke kept."""
    mechanism = Mechanism(load(MECHANISM))
    motion, over = steady_motion(mechanism, 1000.0 * RPM), [f"{name}=±10%" for name in names]
    start = time.perf_counter()
    found = [
        optimise(
            mechanism, motion, OptimisationRequest(FIGURE, over, [KEPT], seed=seed, everywhere=True), lambda *_: None
        )
        for seed in range(count)
    ]
    return Seeded(
        tuple(float(one.values[1, 0]) for one in found),
        tuple(len(one.search.ends) for one in found),
        tuple(one.search.counter.gradients for one in found),
        time.perf_counter() - start,
    )


def main(words: Sequence[str]) -> None:
    """Print what came of it."""
    count = int(words[0]) if words else SEEDS
    for names in SETS:
        found = seeded(names, count)
        print(  # noqa: T201
            f"{', '.join(names)}: {found.agreeing} of {count} seeds agree, spread {found.spread:.1e}; "
            f"{np.mean(found.ends):.1f} searches and {np.mean(found.gradients):.0f} designs with derivatives each, "
            f"{found.seconds / count:.1f} s"
        )


if __name__ == "__main__":
    main(sys.argv[1:])
