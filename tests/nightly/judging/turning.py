"""Motions of the crank that tools offer, in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

RPM, DEGREE = np.pi / 30.0, np.pi / 180.0
LAWS = ("run-up", "run-up-cubic", "run-up-quintic")


@dataclass(frozen=True)
class Turning:
    """The crank from a start angle to a speed in a ramp's time, or at once: rad, s."""

    law: str
    speed: float
    start: float
    ramp: float
    duration: float

    def __call__(self, time):
        """Angle, speed and acceleration (n,), rad, s."""
        if self.law == "constant-speed":
            return self.start + self.speed * time, np.full(len(time), self.speed), np.zeros(len(time))
        x, late = np.clip(time / self.ramp, 0.0, 1.0), np.maximum(time - self.ramp, 0.0)
        angle, speed, acceleration = {
            "run-up": (x**2 / 2, x, np.where((x < 1.0) & (time >= 0.0), 1.0, 0.0)),
            "run-up-cubic": (x**3 - x**4 / 2, 3 * x**2 - 2 * x**3, 6 * x - 6 * x**2),
            "run-up-quintic": (2.5 * x**4 - 3 * x**5 + x**6, 10 * x**3 - 15 * x**4 + 6 * x**5, 30 * (x - x**2) ** 2),
        }[self.law]
        turned = self.start + self.speed * (self.ramp * angle + late)
        return turned, self.speed * speed, self.speed * acceleration / self.ramp
