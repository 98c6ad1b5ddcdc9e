"""From a dyad to the closed form that solves it."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from analytic.kinematics.dyad_solver import Group
from analytic.kinematics.sliding_dyads import PinnedOnSlider, TwoSliders
from analytic.kinematics.structure import Dyad
from analytic.kinematics.turning_dyads import ArmAndSlider, SwingingSlide, TwoTurningArms

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
