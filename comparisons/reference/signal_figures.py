"""Figures that sources print of a signal: its value at a crank angle or a time, its extremes over a turn.

``point:D:x@30``               at a crank angle, degrees, or ``@0.5rad``; the crank turns at the figure's own speed
``omega@0.03s:squeezing``      at a time of one of the linkage's own regimes
``point:D:y.max`` ``.min`` ``.range``  over a turn of the crank
``link:K2:angle - phi@30``     of a difference of signals

The signals are those of ``analytic.signals``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Final

import numpy as np

from analytic.description.crank_motion import crank_motion
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from analytic.numerics.extremes import Array, Extremes, extremes
from analytic.signals import signal, unit
from comparisons.reference.case import Case, Truth, own_case

PLACE: Final = re.compile(r"(?P<number>[-+]?\d+\.?\d*(?:e[-+]?\d+)?)(?:(?P<angle>deg|rad)?|s:(?P<regime>.+))")
REDUCTIONS: Final[Mapping[str, Callable[[Extremes], float]]] = {
    ".max": lambda found: found.maximum,
    ".min": lambda found: found.minimum,
    ".range": lambda found: found.maximum - found.minimum,
}


def is_of_a_signal(quantity: str) -> bool:
    """Whether a figure's name is one of this file's."""
    return "@" in quantity or (":" in quantity and quantity.endswith(tuple(REDUCTIONS)))


def signal_figure(mechanism: Mechanism, quantity: str, speed: float) -> tuple[str, float]:
    """SI unit and value of a figure by name, the crank turning at ``speed``, rad/s, where it is at an angle.

    Raises UnknownNameError for a signal or regime that the linkage does not have, LinkproofError for another place.
    """
    names, _, place = quantity.rpartition("@")
    if names:
        truth = _at(mechanism, place, speed)
        return _difference(names, lambda name: float(signal(truth, name)[0]), mechanism)
    names, _, reduction = quantity.rpartition(".")
    return unit(names, mechanism.linkage), REDUCTIONS[f".{reduction}"](_over_a_turn(mechanism, names, speed))


def _difference(names: str, value: Callable[[str], float], mechanism: Mechanism) -> tuple[str, float]:
    """The first of the signals less the others, and its unit."""
    first, *others = names.split(" - ")
    result = value(first) - sum(map(value, others))
    return unit(first, mechanism.linkage), result


def instant(place: str) -> tuple[float, str | None]:
    """What stands behind the '@': a crank angle, rad, or a time, s, and the regime whose time it is.

    Raises LinkproofError for anything else.
    """
    read = PLACE.fullmatch(place)
    if read is None:
        raise LinkproofError(
            f"published quantity: expected a crank angle or a time with its regime after '@', got '{place}'; "
            "write 30, 0.5rad or 0.03s:REGIME"
        )
    number = float(read["number"])
    if read["regime"] is not None or read["angle"] == "rad":
        return number, read["regime"]
    return math.radians(number), None


def _at(mechanism: Mechanism, place: str, speed: float) -> Truth:
    """The closed form at one instant."""
    number, regime = instant(place)
    if regime is None:
        return _turning(mechanism, np.array([0.0]), speed, number)
    case = case_of(mechanism, regime)
    return Truth(case.mechanism, case.motion, np.array([number]))


@lru_cache(maxsize=4)
def case_of(mechanism: Mechanism, name: str) -> Case:
    """The case of one of the linkage's own regimes: many figures are printed of one motion."""
    own = {regime.name: regime for regime in mechanism.linkage.regimes}
    if name not in own:
        raise UnknownNameError(f"regime of '{mechanism.linkage.name}'", name, own)
    return own_case(mechanism, own[name])


def _turning(mechanism: Mechanism, time: Array, speed: float, angle: float = 0.0) -> Truth:
    """The closed form at instants of a crank that turns steadily from an angle."""
    motion = crank_motion("constant-speed", speed=abs(speed), clockwise=speed < 0.0, start_angle=angle)
    return Truth(mechanism, motion, time)


def _over_a_turn(mechanism: Mechanism, name: str, speed: float) -> Extremes:
    """Mean and extremes of a signal over one turn."""

    def over(angle: Array) -> Array:
        return signal(_turning(mechanism, angle.ravel() / speed, speed), name).reshape(angle.shape)

    return extremes(over)
