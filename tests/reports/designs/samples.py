"""Results of linkages of the tests, ready to be looked at."""

import math
from dataclasses import replace
from functools import cache

from analytic.description.crank_motion import RPM, CrankMotion, Segment
from analytic.description.loading import load
from comparisons.designer.building import page_sheet, sheet, usual_sheet
from comparisons.designer.curves import Curves
from comparisons.motion.case import Case
from tests.analytic.linkages import from_text

SPEED = 1000.0 * RPM
TURN = CrankMotion("constant-speed", (Segment(0.0, 2.0 * math.pi / SPEED, (0.0, SPEED)),))

# Every figure of it is a formula: a massless rod, so that the piston's force goes along it.
CRANK, ROD, MASS = 0.05, 0.2, 0.8  # m, m, kg
IMPERIAL = ("in", 0.0254, "deg", "kN", "N*mm")  # units that ``piston`` takes
PISTON = """
title = "piston engine"
units = { length = "LENGTH", mass = "kg", inertia = "kg*m^2", angle = "ANGLE", force = "FORCE", torque = "TORQUE" }
crank = "crank"
ground = { O = [0, 0] }
output = { point = "B" }
[links.crank]
points = { O = [0, 0], A = [@0.05, 0] }
inertia = 1e-3
[links.rod]
points = { A = [0, 0], B = [@0.2, 0] }
[links.piston]
slides = { point = "B", through = [0, 0], along = [1, 0] }
mass = 0.8
[sketch]
angle = 0
points = { B = [@0.25, 0] }
"""


def piston_text(length="m", metres=1.0, angle="rad", force="N", torque="N*m"):
    text = PISTON.replace("LENGTH", length).replace("ANGLE", angle).replace("FORCE", force).replace("TORQUE", torque)
    for number in ("0.05", "0.25", "0.2"):
        text = text.replace(f"@{number}", repr(float(number) / metres))
    return text


def curves(mechanism, motion=TURN):
    return Curves(Case(mechanism, motion))


def results(mechanism, motion=TURN, chosen=None):
    return sheet(Case(mechanism, motion), chosen, every_peak=True)


def shown(mechanism, motion=TURN):
    """As a page and pictures have it."""
    return page_sheet(Case(mechanism, motion))


@cache
def released_sheet():
    """Of a linkage whose crank is released, with a thread."""
    return usual_sheet(replace(load("two-crank-takeup"), published=()), regimes=("driven",))


def engine(*units):
    return from_text(piston_text(*units))


@cache
def piston(*units, motion=TURN):
    return results(engine(*units), motion)


@cache
def shown_piston(*units):
    return shown(engine(*units))
