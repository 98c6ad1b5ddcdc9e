"""Forward dynamics: the driven slotted take-up over its 10 s."""

from __future__ import annotations

import math

from . import lacking

DRIVEN = {"torque": 0.025, "start_angle": math.radians(269.18), "duration": 10.0}


class FreeMotion:
    """The motion to its usual tolerance, without the bound on its error."""

    def setup(self):
        loading, mechanism = (
            lacking.module("analytic.description.loading"),
            lacking.module("analytic.kinematics.mechanism"),
        )
        self.free_motion = lacking.module("analytic.motion.released").free_motion
        self.mechanism = mechanism.Mechanism(loading.load("slotted-takeup"))
        self.options = {"path": "numpy"} if "path" in self.free_motion.__kwdefaults__ else {}
        self.free_motion(self.mechanism, **{**DRIVEN, "duration": 0.1}, **self.options)

    def time_driven(self):
        return self.free_motion(self.mechanism, **DRIVEN, **self.options).angle(1.0)
