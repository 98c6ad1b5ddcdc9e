"""An engine that is right but for short rods, for tests of what is said of engines over a space of designs."""

from __future__ import annotations

import math
from dataclasses import replace

from engines.contract import Outcome, Run
from engines.direct_adapter.adapter import DirectEngine

SHORT, SHORTEST = 0.172, 0.168  # m: shorter rods get heavier, and the shortest give nothing


class ShortSighted(DirectEngine):
    """Parts are heavier where the rod is short; no control, as it stands for a stranger's engine."""

    name, is_control = "short-sighted", False

    def run(self, scene, setting):
        pairs = [{pin.first: pin.first_anchor, pin.second: pin.second_anchor} for pin in scene.pins]
        ends = [pair["rod"] for pair in pairs if "rod" in pair]
        length = math.dist(*ends)
        if length < SHORTEST:
            return Run(Outcome.DIVERGED, "the rod is too short")
        if length < SHORT:
            bodies = tuple(replace(body, mass=1.5 * body.mass) for body in scene.bodies)
            scene = replace(scene, bodies=bodies)
        return super().run(scene, setting)
