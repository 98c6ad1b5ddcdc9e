"""The motion under which designs are compared: the driver at constant speed over a turn, or over a range."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from analytic.designs.derivatives import figure_gradients
from analytic.designs.figures import Figure
from analytic.designs.results import design_figures
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.datasheet.building import within

Array = NDArray[np.float64]

SAMPLES: Final = 180
FEWEST: Final = 8
MOST: Final = 10**6  # samples in memory at once, design by design


@dataclass(frozen=True)
class SteadyMotion:
    """Sampled places of the driver, rad or m, ascending, and its constant speed, rad/s or m/s, signed.

    The end of a full turn is not sampled twice.
    """

    places: Array
    speed: float
    is_full_turn: bool

    def figures(
        self,
        mechanism: Mechanism,
        numbers: Mapping[str, Array],
        figures: Sequence[Figure],
        *,
        refine: bool = True,
        cores: int | None = None,
        path: str = "auto",
    ) -> Array:
        """Figures of designs with these numbers (designs,), SI, by name: (figures, designs), as ``design_figures``.

        One of the numbers may be the ``speed``, turned as this motion's.
        """
        return design_figures(
            mechanism, numbers, figures, self.places, speed=self.speed, refine=refine,
            period=FULL_TURN if self.is_full_turn else None, cores=cores, path=path,
        )  # fmt: skip

    def gradients(
        self, mechanism: Mechanism, numbers: Mapping[str, float], figures: Sequence[Figure]
    ) -> tuple[Array, Array]:
        """Figures (figures,) of one design, refined, and their derivatives (figures, numbers), SI."""
        return figure_gradients(mechanism, numbers, figures, self.places, speed=self.speed)


def steady_motion(
    mechanism: Mechanism, speed: float, *, samples: int = SAMPLES, start: float | None = None, end: float | None = None
) -> SteadyMotion:
    """A turn at a ``speed``, rad/s; over the range of a driver that makes none, or from ``start`` to ``end``, rad or m.

    The range is that of the linkage as its file has it, short of its limits. Raises LinkproofError for a speed that is
    zero or not finite, and for too few samples.
    """
    if not math.isfinite(speed) or speed == 0.0:
        raise LinkproofError(f"--speed: expected a finite speed that is not zero, got {speed:g}; give another")
    if samples < FEWEST:
        raise LinkproofError(f"--angles: expected {FEWEST} crank angles or more, got {samples}; give more")
    if samples > MOST:
        raise LinkproofError(f"--angles: expected {MOST} crank angles or fewer, got {samples}; give fewer")
    if start is not None and end is not None:
        return SteadyMotion(np.linspace(min(start, end), max(start, end), samples), speed, is_full_turn=False)
    reach = mechanism.crank_range()
    if reach.is_full_turn:
        return SteadyMotion(np.linspace(0.0, FULL_TURN, samples, endpoint=False), speed, is_full_turn=True)
    low, high = within(reach)
    return SteadyMotion(np.linspace(low, high, samples), speed, is_full_turn=False)
