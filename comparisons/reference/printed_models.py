"""The motion of a crank by a model as its source prints it, in the integrator that it prints."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.linkage import Linkage
from analytic.description.loading import in_variant
from analytic.description.schema import Erratum
from analytic.kinematics.mechanism import Mechanism
from analytic.motion.released import fixed_step
from comparisons.observation.interpolation import resample
from comparisons.reference.case import motion_of_file_regime
from comparisons.reference.motion import Spin
from engines.contract import Signal

Array = NDArray[np.float64]


@dataclass(frozen=True)
class InterpolatedMotion:
    """A motion known at the fixed steps of an integrator, interpolated between them."""

    angles: Signal
    speeds: Signal

    def angle(self, time: ArrayLike) -> Array:
        """φ(t), rad."""
        return resample(self.angles, np.atleast_1d(np.asarray(time, dtype=float)))

    def speed(self, time: ArrayLike) -> Array:
        """ω(t), rad/s."""
        return resample(self.speeds, np.atleast_1d(np.asarray(time, dtype=float)))


def erratum_motion(linkage: Linkage, erratum: Erratum) -> Spin:
    """The crank's motion as the source computed it, with its error.

    Its wrong model, and its fixed-step integrator where the erratum names steps.
    """
    own = linkage.released[erratum.regime]
    mechanism = Mechanism(in_variant(linkage, erratum.variant) if erratum.variant else linkage)
    if erratum.steps is None:
        return motion_of_file_regime(mechanism, own, erratum.half_slope)
    stepped = fixed_step(
        mechanism,
        torque=own.torque,
        start_angle=own.start_angle,
        start_speed=own.start_speed,
        duration=own.duration,
        steps=erratum.steps,
        half_slope=erratum.half_slope,
    )
    return InterpolatedMotion(Signal(stepped.time, stepped.angle), Signal(stepped.time, stepped.speed))
