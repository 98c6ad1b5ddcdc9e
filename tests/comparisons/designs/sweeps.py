"""Small sweeps of the six-bar, and a four-bar without masses and output."""

from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.designs.parameters import named_figures, steady_motion
from comparisons.designs.sweep import DesignSpace, SweepRequest, parameter_range

SIX_BAR = load("rimoldi-164")
GRID = ("rod.B.x=160:180:5", "rod.mass=100g:0.2:3", "rod.centre.x=50:6cm:2")
FIGURES = ("Mkr.peak", "transmission_angle:rocker + rod (RRR).peak", "stroke")
BARE = """
title = "bare"
units = { length = "mm", mass = "kg", inertia = "kg*m^2", angle = "deg" }
crank = "crank"
[ground]
O1 = [0, 0]
O2 = [60, 0]
[links.crank]
points = { O1 = [0, 0], A = [20, 0] }
[links.coupler]
points = { A = [0, 0], B = [60, 0] }
[links.rocker]
points = { O2 = [0, 0], B = [45, 0] }
[sketch]
angle = 60
points = { B = [60, 45] }
"""


def grid(*texts):
    return DesignSpace(*zip(*(parameter_range(SIX_BAR, text) for text in texts), strict=True))


def request(space=None, figures=FIGURES, samples=8, speed=100.0):
    mechanism = Mechanism(SIX_BAR)
    motion = steady_motion(mechanism, speed, samples=samples)
    return SweepRequest(SIX_BAR, space or grid(*GRID), named_figures(mechanism, figures), motion)
