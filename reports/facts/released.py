"""A released crank as the report tells of it: its motion, where it could rest, how it settles."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import RPM
from analytic.description.linkage import ReleasedRegime
from analytic.description.loading import parse
from analytic.dynamics import reduced
from analytic.dynamics.equilibrium import equilibria
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.motion.released import FreeMotion
from analytic.motion.rkfixed import PUBLISHED_STEPS, FixedStepMotion, fixed_step
from analytic.motion.steady_rotation import Rotation, last_turns, steady_state
from analytic.numerics.extremes import grid, periodic_mean
from comparisons.reference.case import own_motion
from reports.facts.views import Regime, View
from reports.text.numbers import decade, error, figure

Array = NDArray[np.float64]

STEPS = f"{PUBLISHED_STEPS} Runge-Kutta steps"


@dataclass(frozen=True)
class Released:
    """A regime of the linkage's own: the crank is released to a constant torque and the loads."""

    mechanism: Mechanism
    own: ReleasedRegime

    @cached_property
    def motion(self) -> FreeMotion:
        """The closed form's motion."""
        return own_motion(self.mechanism, self.own)

    @cached_property
    def coarse(self) -> FixedStepMotion | None:
        """The motion as articles 000 and 001 integrate it; None where that integration breaks down."""
        own = self.own
        try:
            return fixed_step(
                self.mechanism,
                torque=own.torque,
                start_angle=own.start_angle,
                start_speed=own.start_speed,
                duration=own.duration,
            )
        except LinkproofError:
            return None

    def coarse_error(self, quantity: str) -> tuple[Array, Array] | None:
        """Time, s, and |error| of the fixed-step motion's ``phi``, ``omega`` or ``epsilon``, SI."""
        found = self.coarse
        if found is None:
            return None
        theirs = {"phi": found.angle, "omega": found.speed, "epsilon": found.acceleration}[quantity]
        ours = {"phi": self.motion.angle, "omega": self.motion.speed, "epsilon": self.motion.acceleration}[quantity]
        return found.time, np.abs(theirs - ours(found.time))

    @cached_property
    def ending(self) -> Rotation | None:
        """Rotation in the last whole turn under a torque; None where there is no torque or no such turn."""
        try:
            return last_turns(self.motion) if self.own.torque else None
        except LinkproofError:
            return None

    @cached_property
    def settled(self) -> Rotation | None:
        """The rotation that would repeat itself; None where there is none."""
        try:
            return steady_state(self.mechanism, self.own.torque) if self.own.torque else None
        except LinkproofError:
            return None


def released(view: View, regime: Regime) -> Released | None:
    """The released crank of a regime; None where the motion is prescribed or the linkage has no such regime."""
    if regime.motion is not None or all(own.name != regime.name for own in view.linkage.regimes):
        return None
    linkage = view.linkage
    return _released(view.text, linkage.name, linkage.variant, linkage.gravity, regime.name)


@lru_cache(maxsize=32)
def _released(text: str, name: str, variant: str, gravity: tuple[float, float], regime: str) -> Released:
    """Kept by what decides it, since the page and the summary both tell of the same seconds of integration."""
    linkage = replace(parse(text, name, name, variant), gravity=gravity)
    own = next(own for own in linkage.regimes if own.name == regime)
    return Released(Mechanism(linkage), own)


def sentences(found: Released) -> list[str]:
    """What there is to say of a released crank, in this order: rest, rotation, own error, the articles' integrator."""
    return [_rest(found), *_rotation(found), _own_error(found), _published_integrator(found)]


def _rest(found: Released) -> str:
    places = equilibria(found.mechanism, found.own.torque)
    load = f"the crank torque of {found.own.torque:g} N m and the loads" if found.own.torque else "its loads"
    if not places:
        return f"Under {load} the crank can rest at no angle."
    words = [f"{math.degrees(one.angle):.2f}° ({'stable' if one.stable else 'unstable'})" for one in places]
    return f"Under {load} the crank can rest at {' and '.join(words)}."


def _rotation(found: Released) -> list[str]:
    """Mean speed and coefficient of fluctuation, at the end and when settled, against M1/b."""
    lines = []
    if found.ending is not None:
        one = found.ending
        lines.append(
            f"In its last turn it runs at {figure(one.mean_speed, 6)} rad/s ({figure(one.mean_speed / RPM, 6)} rpm) in "
            f"the mean over time, {figure(one.mean_speed_over_angle, 6)} over φ, coefficient of fluctuation "
            f"{figure(one.fluctuation, 3)}."
        )
    if found.settled is not None:
        one = found.settled
        damping = periodic_mean(reduced.damping_coefficient(found.mechanism.sweep(grid())))
        lines.append(
            f"Left alone it settles at {figure(one.mean_speed, 6)} rad/s over time and "
            f"{figure(one.mean_speed_over_angle, 6)} over φ, where M1/b is {figure(found.own.torque / damping, 6)}, "
            f"with a fluctuation of {figure(one.fluctuation, 3)}."
        )
    return lines


def _own_error(found: Released) -> str:
    motion = found.motion
    return (
        f"By its own bound the closed form's φ is within {decade(motion.error_bound)} rad of the exact solution; "
        f"energy and work balance to {decade(motion.energy_imbalance)} of the energy at play."
    )


def _published_integrator(found: Released) -> str:
    steps = f"The fixed step of articles 000 and 001, {PUBLISHED_STEPS} Runge-Kutta steps for the whole time,"
    angle, speed = found.coarse_error("phi"), found.coarse_error("omega")
    if angle is None or speed is None:
        return f"{steps} gives no finite motion here."
    return f"{steps} is off by up to {error(float(angle[1].max()))} rad and {error(float(speed[1].max()))} rad/s."
