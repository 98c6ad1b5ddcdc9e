"""Figures that sources print of a signal or a difference of signals: at a crank angle, at a time, over a turn.

``link:K2:angle - phi@30``     of a difference of signals; the crank turns at the figure's own speed
``omega@0.03s:squeezing``      at a time of one of the linkage's own regimes

All others are those of ``analytic.designs.figure_names``.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from analytic.description.crank_motion import crank_motion
from analytic.designs.figure_names import figures_named, place
from analytic.designs.results import turn_figures
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import signal, unit
from comparisons.reference.case import Case, Truth, own_case


def signal_figure(mechanism: Mechanism, quantity: str, speed: float) -> tuple[str, float]:
    """SI unit and value of a figure by name, the crank turning at ``speed``, rad/s, where it is at an angle.

    Raises UnknownNameError for a signal or regime that the linkage does not have, LinkproofError for another figure.
    """
    names, _, where = quantity.rpartition("@")
    if names:
        truth = _at(mechanism, where, speed)
        first, *others = names.split(" - ")
        less = sum(float(signal(truth, name)[0]) for name in others)
        return unit(first, mechanism.linkage), float(signal(truth, first)[0]) - less
    figure, *more = figures_named(mechanism, quantity).values()
    if more:
        raise LinkproofError(f"published quantity: expected one figure, got '{quantity}', which is several; name one")
    return unit(figure.signal, mechanism.linkage), float(turn_figures(mechanism, [figure], speed)[0])


def _at(mechanism: Mechanism, where: str, speed: float) -> Truth:
    """The closed form at one instant."""
    number, regime = place(mechanism.linkage, where)
    if regime is None:
        motion = crank_motion("constant-speed", speed=abs(speed), clockwise=speed < 0.0, start_angle=number)
        return Truth(mechanism, motion, np.array([0.0]))
    case = case_of(mechanism, regime)
    return Truth(case.mechanism, case.motion, np.array([number]))


@lru_cache(maxsize=4)
def case_of(mechanism: Mechanism, name: str) -> Case:
    """The case of one of the linkage's own regimes: many figures are printed of one motion."""
    own = {regime.name: regime for regime in mechanism.linkage.regimes}
    if name not in own:
        raise UnknownNameError(f"regime of '{mechanism.linkage.name}'", name, own)
    return own_case(mechanism, own[name])
