"""Forward dynamics: the driven slotted take-up over its 10 s."""

from __future__ import annotations

import math

from . import lacking

DURATION = 10.0
DRIVEN = {"torque": 0.025, "start_angle": math.radians(269.18)}


class FreeMotion:
    """The motion to its usual tolerance, without the bound on its error."""

    def setup(self):
        self.free_motion = lacking.module("analytic.dynamics.released").free_motion
        self.mechanism = lacking.mechanism("slotted-takeup")
        self.options = {"path": "numpy"} if "path" in self.free_motion.__kwdefaults__ else {}
        self.free_motion(self.mechanism, **DRIVEN, duration=0.1, **self.options)

    def time_driven(self):
        return self.free_motion(self.mechanism, **DRIVEN, duration=DURATION, **self.options).angle(1.0)
