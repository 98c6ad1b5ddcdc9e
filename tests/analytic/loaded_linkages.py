"""Linkages on trial in force analysis: those of the tests, each bare and laden with every load, and some odd joints."""

import dataclasses
import itertools
from functools import cache

import numpy as np

from analytic.description.law import Law
from analytic.description.linkage import GROUND, Linkage, LinkTorque, PointForce, RotaryDamper, Spring
from analytic.kinematics.mechanism import Mechanism
from tests.analytic.linkages import EVERY, from_text, mechanism

HEADER = """
title = "odd joints"
source = "made up"
units = { length = "mm", mass = "g", inertia = "g*mm^2", angle = "deg" }
gravity = [1.5, -9.81]
crank = "crank"
"""

CRANK = """
[links.crank]
points = { O = [3, -2], A = [23, -2] }
mass = 90
centre = [8, 1]
inertia = 9000
"""

ODD = {
    # A die that acts as a mass at its pin: the engines' scene gives its inertia to its host.
    "die in a slot": """
[ground]
O = [0, 0]
Q = [15, 44]
[links.coupler]
points = { A = [0, 0], D = [0, -55], P = [13, -1] }
mass = 55
centre = [4, -20]
inertia = 25000
[links.bar]
slides = { point = "D", through = [4, 7], along = [0.2, -1] }
points = { T = [-20, 9] }
mass = 100
centre = [-6, 11]
[links.die]
slides = { point = "P", on = "rocker", through = [0, 2], along = [-1, 0.1] }
mass = 20
inertia = 2500
[links.rocker]
points = { Q = [0, 0], E = [60, 8] }
mass = 60
centre = [15, 12]
inertia = 50000
[sketch]
points = { D = [0, -50], E = [40, 90] }
[[forces]]
point = "P"
link = "die"
force = [-3, 2]
""",
    # The rod, placed first, slides on its sleeve (RRP seen from the slider), the tongue on its barrel (RPR, likewise).
    "slider before its host": """
[ground]
O = [0, 0]
Q = [90, 6]
R = [62, 74]
U = [-55, 20]
[links.rod]
slides = { point = "K", on = "sleeve", through = [3, -5], along = [1, 0.1] }
points = { A = [2, 1], K = [90, 10] }
mass = 45
centre = [40, 5]
inertia = 30000
[links.rocker]
points = { Q = [4, 2], K = [10, 44] }
mass = 31
centre = [7, 19]
inertia = 8000
[links.sleeve]
points = { S = [6, 9] }
mass = 21
centre = [2, 3]
inertia = 4000
[links.pendulum]
points = { R = [0, 0], S = [0, -45] }
mass = 33
centre = [2, -30]
inertia = 14000
[links.tongue]
slides = { point = "V", on = "barrel", through = [5, 2], along = [0.1, 1] }
points = { A = [5, 4], V = [-3, 21] }
mass = 24
centre = [2, 9]
inertia = 7000
[links.barrel]
points = { U = [3, -4] }
mass = 29
centre = [6, 8]
inertia = 6000
[sketch]
points = { K = [95, 50], S = [60, 28], V = [5, 3] }
""",
    # One pin in the slots of a yoke and of a rocker, and the pin of a rod: slides of three bodies without mass between.
    "pin in two slots": """
slots = [
  { point = "A", on = "yoke", through = [2, 5], along = [0.3, 1] },
  { point = "A", on = "rocker", through = [0, 2], along = [1, 0.1] },
]
[ground]
O = [0, 0]
Q = [-50, 10]
R = [64, 31]
[links.yoke]
slides = { point = "Y", through = [0, 30], along = [1, 0.3] }
points = { Y = [4, 3] }
mass = 70
centre = [12, -7]
[links.rocker]
points = { Q = [0, 0], E = [90, 5] }
mass = 30
centre = [3, 20]
inertia = 9000
[links.rod]
points = { A = [0, 0], B = [60, 5] }
mass = 25
centre = [25, 3]
inertia = 8000
[links.swing]
points = { R = [1, 1], B = [3, 42] }
mass = 28
centre = [2, 20]
inertia = 7000
[sketch]
points = { E = [40, 15], B = [50, 70] }
""",
    # Blocks that share a pin, one in the crank and one in the ground (PRP), and a die on a carriage on a rocker (RPP).
    "carriage and crossed blocks": """
[ground]
O = [0, 0]
Q = [90, 10]
[links.coupler]
points = { A = [0, 0], B = [80, 0] }
mass = 40
centre = [35, 3]
inertia = 21000
[links.rocker]
points = { Q = [0, 0], B = [5, 45], N = [30, 6] }
mass = 30
centre = [3, 20]
inertia = 9000
[links.carriage]
slides = { point = "V", on = "rocker", through = [10, 3], along = [2, -1] }
points = { V = [2, -1] }
mass = 26
centre = [7, 3]
inertia = 3500
[links.die]
slides = { point = "A", on = "carriage", through = [4, 4], along = [1, 2] }
points = { W = [-5, 4] }
mass = 15
centre = [2, 2]
inertia = 1500
[links.block]
slides = { point = "L", through = [40, 60], along = [0.2, 1] }
points = { L = [3, 1] }
mass = 44
centre = [6, 2]
[links.shoe]
slides = { point = "L", on = "coupler", through = [5, 24], along = [1, -0.2] }
mass = 16
centre = [1, 3]
inertia = 1200
[sketch]
points = { B = [80, 55] }
""",
}
ALL = tuple(itertools.product((*((name, None) for name in ODD), *EVERY), (False, True)))


@cache
def on_trial(name: str, variant: str | None, is_laden: bool) -> Mechanism:
    """A linkage by name, as it is or laden."""
    sample = from_text(HEADER + ODD[name] + CRANK, name) if name in ODD else mechanism(name, variant)
    return Mechanism(laden(sample.linkage)) if is_laden else sample


def laden(linkage: Linkage) -> Linkage:
    """A linkage under forces at all points, torques on all links, and springs, dashpots and dampers between bodies."""
    draw = np.random.default_rng(5)
    scale = sum(link.mass for link in linkage.links.values()) * 20.0  # N, some weights
    length = linkage.extent()

    def law(size: float, parts: int) -> Law:
        values = size * draw.uniform(-1.0, 1.0, (4, parts))
        return Law(values, np.array([0.1, 1.5, 3.0, 4.9])) if draw.random() < 0.5 else Law(values[0])

    points = [(point, name) for name, link in linkage.links.items() for point in link.points]
    ends = [(point, GROUND) for point in linkage.ground] + points
    pairs = [(a, b) for a, b in itertools.combinations(ends, 2) if a[1] != b[1] and a[0] != b[0]]
    bodies = itertools.pairwise([GROUND, *linkage.links])
    return dataclasses.replace(
        linkage,
        gravity=(3.0, -9.0),
        forces=tuple(PointForce(*place, law(scale, 2)) for place in points),
        torques=tuple(LinkTorque(name, law(scale * length, 1)) for name in linkage.links if _turns(linkage, name)),
        springs=tuple(
            Spring((a[0], b[0]), (a[1], b[1]), scale / length, 0.7 * length, 0.01 * scale / length)
            for a, b in pairs[:: max(1, len(pairs) // 6)]
        ),
        dampers=tuple(RotaryDamper(pair, 0.002 * scale * length) for pair in bodies),
    )


def _turns(linkage: Linkage, name: str) -> bool:
    return linkage.links[name].inertia is not None
