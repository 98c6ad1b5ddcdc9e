"""A released crank for its page: rest positions, steady rotation, and its motion."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from analytic.description.linkage import ReleasedRegime
from analytic.description.written import finite
from analytic.dynamics import reduced
from analytic.dynamics.equation_of_motion import equilibria
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.motion.released import FreeMotion, energy_imbalance
from analytic.motion.steady_rotation import Rotation, last_turns, steady_state
from analytic.numerics.refine import grid, in_turn, periodic_mean
from comparisons.datasheet.instants import extreme_samples
from comparisons.datasheet.sheet import Released

Array = NDArray[np.float64]
T = TypeVar("T")

STRETCHES: Final = 70  # of a long curve that is shown by the extremes of each
EVEN_SAMPLES: Final = 121  # instants that are shown besides
PER_TURN, FEWEST, MOST = 60, 2000, 100_000  # instants at which a motion is looked at
LAST_TURN_SAMPLES: Final = 361


def describe_release(mechanism: Mechanism, regime: ReleasedRegime, motion: FreeMotion) -> Released:
    """Facts and curves of a regime of the linkage's file in which the crank is released.

    The facts are its ``torque``, N m, which besides changes ``over`` the "angle" or the "time", or does not (""); the
    angles, rad, at which it can rest; the mean reduced ``damping``, N m s/rad; the ``error_bound`` of φ, rad, and
    ``balance`` of energy of the closed form; speeds, rad/s, and coefficient of fluctuation of its last whole turn
    (``ending``) and of the rotation that would repeat itself (``settled``), where there are such; φ at the ``end``
    within a turn.
    """
    ending = _attempt(lambda: last_turns(motion)) if regime.torque else None
    settled = _attempt(lambda: steady_state(mechanism, regime.torque)) if regime.torque else None
    facts: dict[str, Any] = {
        "torque": regime.torque,
        "over": "angle" if regime.over_angle is not None else "time" if regime.over_time is not None else "",
        "rests": [{"angle": rest.angle, "stable": bool(rest.stable)} for rest in equilibria(mechanism, regime.torque)],
        "damping": periodic_mean(reduced.damping_coefficient(mechanism.sweep(grid()))),
        "error_bound": finite(motion.error_bound),
        "balance": finite(energy_imbalance(motion)),
        "ending": _rotation_speeds(ending),
        "settled": _rotation_speeds(settled),
        "end": float(in_turn(float(motion.angle(motion.duration)))),
    }
    time = _dense_times(motion)
    curves = (time, motion.angle(time), motion.speed(time), motion.acceleration(time))
    return Released(facts, _thin_curves(("time", "phi", "omega", "epsilon"), curves), _last_turn(motion, ending))


def _thin_curves(names: tuple[str, ...], curves: tuple[Array, ...]) -> dict[str, Array]:
    """Curves (n,) by name, the first their axis, at the instants that show them: extremes, and others evenly."""
    even = np.linspace(0, len(curves[0]) - 1, EVEN_SAMPLES).astype(int)
    places = np.unique(
        np.concatenate([even, *(extreme_samples(np.nan_to_num(curve), STRETCHES) for curve in curves[1:])])
    )
    return {name: curve[places] for name, curve in zip(names, curves, strict=True)}


def _attempt(make: Callable[[], T]) -> T | None:
    """The result, or None on LinkproofError: there may be no whole turn, or no periodic rotation."""
    try:
        return make()
    except LinkproofError:
        return None


def _rotation_speeds(rotation: Rotation | None) -> dict[str, float] | None:
    names = ("mean_speed", "mean_speed_over_angle", "fluctuation")
    return None if rotation is None else {name: getattr(rotation, name) for name in names}


def _dense_times(motion: FreeMotion) -> Array:
    """Instants, s, so close that every turn is seen."""
    turns = abs(float(motion.angle(motion.duration)) - motion.start[0]) / FULL_TURN
    return np.linspace(0.0, motion.duration, int(np.clip(PER_TURN * turns, FEWEST, MOST)))


def _last_turn(motion: FreeMotion, ending: Rotation | None) -> dict[str, Array]:
    """Speed and acceleration over the last whole turn, φ ascending within a turn; {} without one."""
    if ending is None:
        return {}
    start = motion.duration - FULL_TURN / abs(ending.mean_speed)
    time = np.linspace(start, motion.duration, LAST_TURN_SAMPLES)[1:]
    angle = motion.angle(time) % FULL_TURN
    order = np.argsort(angle)
    curves = (angle, motion.speed(time), motion.acceleration(time))
    return {name: curve[order] for name, curve in zip(("phi", "omega", "epsilon"), curves, strict=True)}
