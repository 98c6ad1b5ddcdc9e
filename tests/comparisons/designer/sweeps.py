"""Small sweeps of the six-bar, and a four-bar without masses and output."""

from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.parameters import case_at_speed, named_figures
from comparisons.designer.sweep import DesignSpace, SweepRequest, parameter_range
from tests.analytic.linkages import file_text

SIX_BAR = load("rimoldi-164")
CASE = case_at_speed(Mechanism(SIX_BAR), 100.0, samples=8)
GRID = ("rod.B.x=160:180:5", "rod.mass=100g:0.2:3", "rod.centre.x=50:6cm:2")
FIGURES = ("Mkr.peak", "transmission_angle:rocker + rod (RRR).peak", "stroke")
BARE = file_text("four-bar-without-masses")


def grid(*texts):
    return DesignSpace(*zip(*(parameter_range(CASE, text) for text in texts), strict=True))


def request(space=None, figures=FIGURES):
    return SweepRequest(CASE, space or grid(*GRID), named_figures(CASE.mechanism, figures))
