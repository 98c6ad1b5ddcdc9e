"""The take-up linkages of articles 000, 001 and 002 as the tests of forward dynamics and thread need them."""

from __future__ import annotations

from functools import cache

from analytic.description.loading import parse
from analytic.kinematics.mechanism import Mechanism

SLOTTED = """
title = "slotted-rocker take-up"
source = "article 000"
units = { length = "mm", mass = "g", inertia = "kg*m^2", angle = "deg" }
crank = "crank"
gravity = [0, -9.81]
ground = { P1 = [0, 0], P5 = [11.7, 35.69] }
dampers = [{ between = ["crank", "ground"], coefficient = 2e-4 }]

[links.crank]
points = { P1 = [0, 0], P2 = [16.3, 0] }
mass = 200
centre = { radius = 5, angle = 180 }
inertia = 325e-6

[links.coupler]
points = { P2 = [0, 0], P3 = [44.2, 0], P4 = { radius = 10, angle = -90 } }
mass = 55
centre = { radius = 10, angle = 30 }
inertia = 70e-6

[links.needle_bar]
slides = { point = "P3", through = [0, 0], along = [0, 1] }
mass = 100
centre = [10, 0]

[links.slot_slider]
slides = { point = "P4", on = "rocker", through = [0, 0], along = [1, 0] }
mass = 20
inertia = 25e-6

[links.rocker]
points = { P5 = [0, 0], P7 = [55, 0] }
mass = 60
centre = { radius = 15, angle = 45 }
inertia = 50e-6

[sketch]
angle = 0
points = { P3 = [0, -41], P7 = [0, -20] }
"""

TWO_CRANK = """
title = "double-crank take-up"
source = "article 001"
units = { length = "mm", mass = "g", inertia = "kg*m^2", angle = "deg" }
crank = "crank"
gravity = [0, -9.81]
ground = { P1 = [0, 0], P4 = [9.66, 2.59] }
dampers = [{ between = ["crank", "ground"], coefficient = 10e-6 }]

[links.crank]
points = { P1 = [0, 0], P2 = [30, 0] }
mass = 10
centre = { radius = 5, angle = 180 }
inertia = 35e-6

[links.coupler]
points = { P2 = [0, 0], P3 = [22, 0], P5 = [26.096319908, 46.821150795] }
mass = 6.5
centre = { radius = 5, angle = -30 }
inertia = 25e-6

[links.rocker]
points = { P4 = [0, 0], P3 = [19, 0] }
mass = 8.5
centre = [15, 0]
inertia = 8.5e-6

[sketch]
angle = 0
points = { P3 = [18.7, -14.1] }
"""

FORK = """
title = "fork take-up"
source = "article 002, representative dimensions"
units = { length = "mm", mass = "g", inertia = "g*mm^2", angle = "deg" }
crank = "crank"
ground = { P1 = [0, 0], P4 = [-18, 14] }

[links.crank]
points = { P1 = [0, 0], P2 = [10, 0] }
mass = 10
inertia = 300

[links.coupler]
points = { P2 = [0, 0], P3 = [26, 0], P5 = [85.088465180732, -10.418890660016] }
mass = 10
inertia = 300

[links.rocker]
points = { P4 = [0, 0], P3 = [22, 0], P6 = [78.023697920762, 15.011504614] }
mass = 10
inertia = 300

[sketch]
angle = 0
points = { P3 = [2, 24] }
"""


@cache
def takeup(text: str) -> Mechanism:
    """A take-up ready to be evaluated."""
    return Mechanism(parse(text, "take-up", "take-up.toml"))
