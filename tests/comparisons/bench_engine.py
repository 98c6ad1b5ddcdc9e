"""An engine that returns the true torque with an error of known order, floor and rounding, to benchmark in tests."""

import numpy as np

from analytic.dynamics.reduced import drive_torque
from engines.contract import Abilities, History, Method, Outcome, ReadOut, Run, Setting, Signal
from engines.scene import Channel

FIRST = Method("first", "first order")
SECOND = Method("second", "second order down to a floor")
FOURTH = Method("fourth", "fourth order until rounding grows", runs=2)
WRONG = Method("wrong", "a read-out that no step mends")
BROKEN = Method("broken", "raises")
METHODS = (FIRST, SECOND, FOURTH, WRONG, BROKEN)
SIZE = 0.2


class KnownEngine:
    """Errors over the peak: c h, c h² + a floor, c h⁴ + r/h, a constant; h over the step at 12 a turn."""

    name = "known"
    work_unit = "iterations"
    is_control = False
    abilities = Abilities({Channel.TORQUE: ReadOut("the truth")}, frozenset(), frozenset(), frozenset())

    def __init__(self, mechanism, motion):
        self.mechanism, self.motion = mechanism, motion
        self.runs = []

    def version(self):
        return "1.0"

    def methods(self, scene):
        return METHODS

    def run(self, scene, setting):
        self.runs.append(setting)
        error = {Setting.NAIVE: 0.1, Setting.TUNED: 1e-5, Setting.BEST: 1e-9}[setting]
        return self._finished(1e-3, error, {"scheme": "known"}, 4 if setting is Setting.BEST else 1)

    def run_method(self, scene, method, step):
        self.runs.append((method.name, step))
        if method.name == "broken":
            raise RuntimeError("matrix is singular")
        return self._finished(step, self.error(method, step), {"step": step}, method.runs)

    def error(self, method, step):
        """The error a method has at a step, over the peak."""
        h = step * 12.0 * self.motion.peak_speed / (2.0 * np.pi)
        return {
            "first": SIZE * h,
            "second": SIZE * h**2 + 3e-5,
            "fourth": SIZE * h**4 + 1e-8 / h,
            "wrong": 0.05,
        }[method.name]

    def _finished(self, step, error, details, runs):
        time = np.arange(0.0, self.motion.duration, step)
        speed, acceleration = self.motion.speed(time), self.motion.acceleration(time)
        torque = drive_torque(self.mechanism.sweep(self.motion.angle(time)), speed, acceleration)
        values = torque + error * np.max(np.abs(torque))
        steps = len(time)
        passes = tuple(step / (1 + number) for number in range(runs))
        return Run(Outcome.FINISHED, "", History(torque=Signal(time, values)), steps * 1e-6, 1e-4, steps, steps * 5,
                   passes, details)  # fmt: skip
