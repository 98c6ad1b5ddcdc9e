"""A released crank as the report tells of it: its motion, where it could rest, how it settles."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import RPM
from analytic.description.linkage import ReleasedRegime
from analytic.description.loading import parse
from analytic.dynamics import reduced
from analytic.dynamics.equilibrium import Equilibrium, equilibria
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.motion.released import FreeMotion
from analytic.motion.rkfixed import PUBLISHED_STEPS, FixedStepMotion, fixed_step
from analytic.motion.steady_rotation import Rotation, last_turns, steady_state
from analytic.numerics.extremes import grid, periodic_mean
from comparisons.datasheet.released import released as saved
from comparisons.reference.case import own_motion
from reports.document.templates import lines
from reports.records.views import Regime, View

Array = NDArray[np.float64]

STEPS = f"{PUBLISHED_STEPS} Runge-Kutta steps"


@dataclass(frozen=True)
class Released:
    """A regime of the linkage's own: the crank is released to a torque and the loads."""

    mechanism: Mechanism
    own: ReleasedRegime

    @property
    def is_steady(self) -> bool:
        """Whether the torque is constant, as the articles' and that of an angle of rest is."""
        return self.own.over_angle is None and self.own.over_time is None

    @cached_property
    def motion(self) -> FreeMotion:
        """The closed form's motion."""
        return own_motion(self.mechanism, self.own)

    @cached_property
    def coarse(self) -> FixedStepMotion | None:
        """The motion as articles 000 and 001 integrate it; None where that breaks down or has no such torque."""
        own = self.own
        if not self.is_steady:
            return None
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
    def rests(self) -> list[Equilibrium]:
        """Where the crank can rest under its torque and the loads."""
        return list(equilibria(self.mechanism, self.own.torque))

    @cached_property
    def damping(self) -> float:
        """Mean of the reduced damping coefficient over a turn, N m s/rad."""
        return periodic_mean(reduced.damping_coefficient(self.mechanism.sweep(grid())))

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
    if regime.motion is not None or regime.name not in view.linkage.released:
        return None
    linkage = view.linkage
    return _released(linkage.text, linkage.name, linkage.variant, linkage.gravity, regime.name)


@lru_cache(maxsize=32)
def _released(text: str, name: str, variant: str, gravity: tuple[float, float], regime: str) -> Released:
    """Kept by what decides it, since the page and the summary both tell of the same seconds of integration."""
    linkage = replace(parse(text, name, name, variant), gravity=gravity)
    own = linkage.released[regime]
    return Released(Mechanism(linkage), own)


def sentences(found: Released) -> list[str]:
    """What there is to say of a released crank, in this order: rest, rotation, own error, the articles' integrator."""
    return lines("released_crank", one=saved(found.mechanism, found.own), rpm=RPM)
