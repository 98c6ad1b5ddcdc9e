"""From a dyad to the closed form that solves it."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from analytic.closure import Group
from analytic.sliding_groups import PinnedOnSlider, TwoSliders
from analytic.structure import Dyad
from analytic.turning_groups import ArmAndSlider, SwingingSlide, TwoTurningArms

SOLVERS: Mapping[str, Callable[[Dyad], Group]] = {
    "RRR": TwoTurningArms,
    "RRP": ArmAndSlider,
    "RPR": SwingingSlide,
    "RPP": PinnedOnSlider,
    "PRP": TwoSliders,
}


def group(dyad: Dyad) -> Group:
    """The solver of a dyad."""
    return SOLVERS[dyad.kind](dyad)
