"""A released crank for its page: where it could rest, how it settles, its motion, and what printed models say of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage, ReleasedRegime
from analytic.dynamics import reduced
from analytic.dynamics.equilibrium import equilibria
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.motion.energy import energy_imbalance
from analytic.motion.released import FreeMotion
from analytic.motion.rkfixed import PUBLISHED_STEPS, fixed_step
from analytic.motion.steady_rotation import Rotation, last_turns, steady_state
from analytic.numerics.extremes import grid, in_turn, periodic_mean
from comparisons.datasheet.plain_data import finite
from comparisons.datasheet.sheet import Coarse, Printed, Released, Speeds
from comparisons.reference.printed_models import printed_motion

Array = NDArray[np.float64]
T = TypeVar("T")

STRETCHES: Final = 70  # of a long curve that is shown by the extremes of each
EVEN: Final = 121  # instants that are shown besides
PER_TURN, FEWEST, MOST = 60, 2000, 100_000  # instants at which a motion is looked at
LAST_TURN: Final = 361


def released(mechanism: Mechanism, own: ReleasedRegime, motion: FreeMotion) -> Released:
    """What there is to say of a regime of a linkage's own in which the crank is released, and of its motion."""
    ending = _attempt(lambda: last_turns(motion)) if own.torque else None
    settled = _attempt(lambda: steady_state(mechanism, own.torque)) if own.torque else None
    time = _instants(motion)
    curves = np.array([time, motion.angle(time), motion.speed(time), motion.acceleration(time)])
    return Released(
        torque=own.torque,
        over="angle" if own.over_angle is not None else "time" if own.over_time is not None else "",
        rests=[{"angle": rest.angle, "stable": bool(rest.stable)} for rest in equilibria(mechanism, own.torque)],
        damping=periodic_mean(reduced.damping_coefficient(mechanism.sweep(grid()))),
        error_bound=finite(motion.error_bound),
        balance=finite(energy_imbalance(motion)),
        ending=_speeds(ending),
        settled=_speeds(settled),
        coarse=_coarse(mechanism, own, motion),
        end=float(in_turn(float(motion.angle(motion.duration)))),
        motion=dict(zip(("time", "phi", "omega", "epsilon"), curves[:, shown(curves[1:])], strict=True)),
        last_turn=_last_turn(motion, ending) if ending else {},
    )


def printed(linkage: Linkage, motions: Mapping[str, FreeMotion]) -> dict[str, Printed]:
    """The motions of models as printed, by erratum, of those that ``motions``, by regime, show to be wrong.

    They hold for the file's own values alone.
    """
    found = {}
    errata = linkage.errata if linkage.variant == linkage.variants[0] else ()
    for erratum in (one for one in errata if one.regime in motions):
        motion, theirs = motions[erratum.regime], printed_motion(linkage, erratum)
        time = _instants(motion)
        corrected, as_printed = motion.speed(time), theirs.speed(time)
        kept = shown(np.stack([corrected, as_printed, np.abs(as_printed - corrected)]))
        found[erratum.name] = Printed(time[kept], corrected[kept], as_printed[kept])
    return found


def shown(curves: Array) -> NDArray[np.intp]:
    """Which samples show long curves (k, n): the extremes of each stretch of each, others evenly, both ends."""
    count = curves.shape[1]
    edges = np.unique(np.linspace(0, count, min(STRETCHES, count) + 1).astype(int))
    kept = [np.linspace(0, count - 1, min(EVEN, count)).astype(int)]
    for curve in np.nan_to_num(curves):
        for low, high in pairwise(edges):
            kept.append(low + np.array([np.argmin(curve[low:high]), np.argmax(curve[low:high])]))
    return np.unique(np.concatenate(kept))


def _attempt(make: Callable[[], T]) -> T | None:
    """What there may not be: a last whole turn, a rotation that repeats itself."""
    try:
        return make()
    except LinkproofError:
        return None


def _speeds(found: Rotation | None) -> Speeds | None:
    if found is None:
        return None
    return Speeds(
        mean_speed=found.mean_speed, mean_speed_over_angle=found.mean_speed_over_angle, fluctuation=found.fluctuation
    )


def _instants(motion: FreeMotion) -> Array:
    """Instants, s, close enough to see every turn."""
    turns = abs(float(motion.angle(motion.duration)) - motion.start[0]) / FULL_TURN
    return np.linspace(0.0, motion.duration, int(np.clip(PER_TURN * turns, FEWEST, MOST)))


def _last_turn(motion: FreeMotion, ending: Rotation) -> dict[str, Array]:
    """Speed and acceleration over the last turn, φ ascending within a turn."""
    start = motion.duration - FULL_TURN / abs(ending.mean_speed)
    time = np.linspace(start, motion.duration, LAST_TURN)[1:]
    angle = motion.angle(time) % FULL_TURN
    order = np.argsort(angle)
    curves = (angle, motion.speed(time), motion.acceleration(time))
    return {name: curve[order] for name, curve in zip(("phi", "omega", "epsilon"), curves, strict=True)}


def _coarse(mechanism: Mechanism, own: ReleasedRegime, motion: FreeMotion) -> Coarse | None:
    """How far the articles' integrator is off; None under a torque that they have not."""
    if own.over_angle is not None or own.over_time is not None:
        return None
    found = _attempt(
        lambda: fixed_step(
            mechanism,
            torque=own.torque,
            start_angle=own.start_angle,
            start_speed=own.start_speed,
            duration=own.duration,
        )
    )
    if found is None:
        return Coarse(steps=PUBLISHED_STEPS, phi=None, omega=None, errors={})
    errors = {
        "phi": np.abs(found.angle - motion.angle(found.time)),
        "omega": np.abs(found.speed - motion.speed(found.time)),
    }
    kept = shown(np.array(list(errors.values())))
    curves = {"time": found.time[kept], **{name: error[kept] for name, error in errors.items()}}
    phi, omega = (float(np.max(error)) for error in errors.values())
    return Coarse(steps=PUBLISHED_STEPS, phi=phi, omega=omega, errors=curves)
