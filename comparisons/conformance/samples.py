"""The few linkages and motions in which the conformance test runs an engine."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Final

import numpy as np

from analytic.description.crank_motion import crank_motion
from analytic.description.law import Law
from analytic.description.linkage import GROUND, Linkage, LinkTorque, PointForce, ReleasedRegime, RotaryDamper, Spring
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.reference.case import Case, case_of_file_regime

LINKAGES = Path(__file__).with_name("linkages")
PLAIN: Final = "four-bar"  # what every engine has to take: pins, gravity and a prescribed crank
SPEED: Final = 20.0  # rad/s: the loads by inertia are a few times those by gravity
RAMP, HOLD = 0.3, 0.33  # s: half a turn to reach the speed, one full turn at it


@dataclass(frozen=True)
class Sample:
    """A linkage under one motion of its crank: how the crank turns, and what is added to the linkage of the file.

    A file with a regime has its motion in that.
    """

    linkage: str
    start: float = 0.0  # rad
    clockwise: bool = False
    added: Callable[[Linkage], Linkage] = lambda linkage: linkage
    released: bool = False

    @property
    def case(self) -> Case:
        """The case of it."""
        mechanism = Mechanism(self.added(load(str(LINKAGES / f"{self.linkage}.toml"))))
        if self.released:
            return case_of_file_regime(mechanism, ReleasedRegime("released", 1.5, self.start, 6.0, 0.8))
        if mechanism.linkage.regimes:
            return case_of_file_regime(mechanism, mechanism.linkage.regimes[0])
        return Case(mechanism, crank_motion(
            "run-up-quintic", speed=SPEED, ramp_time=RAMP, hold_time=HOLD, clockwise=self.clockwise,
            start_angle=self.start,
        ))  # fmt: skip


def _with_force(linkage: Linkage) -> Linkage:
    return replace(linkage, forces=(PointForce("P", "coupler", Law(np.array([-6.0, 11.0]))),))


def _with_force_over_angle(linkage: Linkage) -> Linkage:
    angles, values = np.radians([0.0, 80.0, 170.0, 260.0]), np.array([[8.0, 2.0], [-4.0, 9.0], [3.0, -7.0], [0.0, 5.0]])
    return replace(linkage, forces=(PointForce("P", "coupler", Law(values, angles)),))


def _with_torque(linkage: Linkage) -> Linkage:
    return replace(linkage, torques=(LinkTorque("rocker", Law(np.array([1.7]))),))


def _with_spring(linkage: Linkage) -> Linkage:
    return replace(linkage, springs=(Spring(("P", "F"), ("coupler", GROUND), 150.0, 0.1, 12.0),))


def _with_damper(linkage: Linkage) -> Linkage:
    return replace(linkage, dampers=(RotaryDamper(("coupler", "rocker"), 0.06),))


SAMPLES: Final[Mapping[str, Sample]] = {
    PLAIN: Sample("four-bar", math.radians(40.0)),
    "four-bar clockwise": Sample("four-bar", math.radians(-200.0), clockwise=True),
    "slider-crank": Sample("slider-crank", math.radians(20.0), clockwise=True),
    "quick return": Sample("quick-return", math.radians(75.0)),
    "force": Sample("four-bar", math.radians(40.0), added=_with_force),
    "force over the angle": Sample("four-bar", math.radians(40.0), added=_with_force_over_angle),
    "torque": Sample("four-bar", math.radians(40.0), added=_with_torque),
    "spring": Sample("four-bar", math.radians(40.0), added=_with_spring),
    "damper": Sample("four-bar", math.radians(40.0), added=_with_damper),
    "driven slider": Sample("driven-slider"),
    "cylinder": Sample("cylinder"),
    "released": Sample("four-bar", math.radians(40.0), released=True),
}


@cache
def case(name: str) -> Case:
    """The case of a sample, shared by all callers, so that its closed form is computed once."""
    return SAMPLES[name].case
