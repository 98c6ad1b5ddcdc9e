"""The closed form: a sweep of the crank, and many designs at once."""

from __future__ import annotations

import numpy as np

from . import lacking

SWEEP = 100_000  # crank angles
DESIGNS, ANGLES = 1000, 100
QUANTITIES = ("S", "v", "a", "Jeq", "Mkr")


class Sweep:
    """S, v, a, Jeq and Mkr over the crank angles."""

    params = ("juki-mf7923d", "rimoldi-164", "slotted-takeup")
    param_names = ("mechanism",)

    def setup(self, name):
        self.evaluate = lacking.module("analytic.signals").evaluate
        self.mechanism = lacking.mechanism(name)
        self.angle = np.linspace(0.0, 100.0, SWEEP)

    def time_evaluate(self, _name):
        return self.evaluate(self.mechanism, self.angle, QUANTITIES, speed=100.0)


class Designs:
    """Jeq of six-bars of other rods, compiled."""

    timeout = 300.0

    def setup(self):
        lacking.module("numba")
        self.evaluate = lacking.module("analytic.designs.sampled_signals").evaluate_designs
        self.mechanism = lacking.mechanism("rimoldi-164")
        self.rods = {"rod.B.x": np.linspace(0.174, 0.176, DESIGNS)}
        self.angle = np.linspace(0.0, 6.0, ANGLES)
        self.time_inertia()

    def time_inertia(self):
        return self.evaluate(self.mechanism, self.rods, self.angle, ("Jeq",), path="compiled")


class DesignFigures:
    """Peaks of twice as many six-bars over 72 crank angles, compiled."""

    timeout = 300.0
    params = ("Mkr", "joint_force:A:magnitude")
    param_names = ("signal",)

    def setup(self, signal):
        lacking.module("numba")
        figures = lacking.module("analytic.designs.figures")
        self.figures = lacking.module("analytic.designs.results").design_figures
        self.mechanism = lacking.mechanism("rimoldi-164")
        self.rods = {"rod.B.x": np.linspace(0.174, 0.176, 2 * DESIGNS)}
        self.angle = np.arange(72) * (2.0 * np.pi / 72)
        self.requested = [figures.Figure(signal, figures.Reduction.PEAK)]
        self.time_peak(signal)

    def time_peak(self, _signal):
        return self.figures(self.mechanism, self.rods, self.requested, self.angle, speed=100.0, path="compiled")
