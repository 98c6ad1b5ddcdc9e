"""Linkages that can only swing, written as a user writes them."""

from analytic.description.loading import parse

DOUBLE_ROCKER = """
title   = "A double rocker, swung"
source  = "made up"
units   = {{ length = "mm", mass = "kg", inertia = "kg*m^2", angle = "deg" }}
crank   = "crank"
gravity = [0, -9.81]
output  = {{ point = "C", along = [{0}, {1}] }}

[ground]
O1 = [0, 0]
O2 = [100, 0]

[links.crank]
points = {{ O1 = [0, 0], B = [80, 0] }}
mass = 0.4
centre = [40, 0]
inertia = 3e-4

[links.coupler]
points = {{ B = [0, 0], C = [50, 0] }}
mass = 0.2
centre = [25, 0]
inertia = 1e-4

[links.rocker]
points = {{ O2 = [0, 0], C = [60, 0] }}
mass = 0.3
centre = [30, 0]
inertia = 2e-4

[sketch]
angle = 60
points = {{ C = [95, 60] }}
"""


def double_rocker_text(along=(1.0, 0.0), regimes=""):
    """Its file; the crank reaches -74.4° to 74.4°."""
    return DOUBLE_ROCKER.format(*along) + regimes


def double_rocker(along=(1.0, 0.0), regimes=""):
    """The linkage."""
    return parse(double_rocker_text(along, regimes), "double-rocker", "double-rocker.toml", None)
