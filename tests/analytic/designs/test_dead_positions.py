"""Designs that fail between two crank angles only, against the condition of Grashof."""

import math

import numpy as np
import pytest

from analytic.description.law import FULL_TURN
from analytic.designs.figures import Figure, Reduction
from analytic.designs.results import design_figures
from analytic.machine_code import compiling
from tests.analytic.linkages import from_text

# The ground leans, so that no dead position lies at a sample.
PIVOT = (0.1 * math.cos(0.1), 0.1 * math.sin(0.1))
TEXT = f"""
title = "four-bar"
source = "drawn"
crank = "crank"
units = {{ length = "m", mass = "kg", inertia = "kg*m^2", angle = "rad" }}
ground = {{ O = [0, 0], C = [{PIVOT[0]!r}, {PIVOT[1]!r}] }}
links.crank = {{ points = {{ O = [0, 0], A = [0.03, 0] }}, mass = 1, inertia = 1e-3 }}
links.coupler = {{ points = {{ A = [0, 0], B = [0.11, 0] }}, mass = 1, inertia = 1e-3 }}
links.rocker = {{ points = {{ C = [0, 0], B = [0.06, 0] }}, mass = 1, inertia = 1e-3 }}
sketch = {{ angle = 1, points = {{ B = [0.1, 0.06] }} }}
"""
FIGURES = [Figure("Mkr", Reduction.PEAK), Figure("point:B:y", Reduction.MEAN)]
PATHS = ["numpy", *(["compiled"] if compiling.is_installed() else [])]


def designs():
    """Lengths at and on both sides of both limits, near and far, and of every kind of motion."""
    draw = np.random.default_rng(2)
    beyond = np.concatenate([sign * 10.0 ** np.arange(-9.0, -2.9, 0.5) for sign in (1.0, -1.0)]) * 0.1
    crank, rocker = 0.1 * draw.uniform(0.2, 1.6, (2, 400))
    limits = np.stack([0.1 + crank - rocker, rocker + np.abs(0.1 - crank), rocker - np.abs(0.1 - crank)])
    coupler = limits[draw.integers(0, 3, 400), np.arange(400)] + draw.choice([*beyond, 0.0], 400)
    fine = coupler > 0.01
    exact = np.array([[0.03, 0.1, 0.03], [0.1, 0.05, 0.05], [0.03, 0.0995, 0.0305], [0.03, 0.1005, 0.0305]])
    return np.concatenate([np.stack([crank, coupler, rocker], axis=1)[fine], exact]).T


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize(("count", "refine"), [(12, False), (72, False), (129, False), (40, True)])
def test_a_crank_that_makes_no_turn_is_told_however_narrow_the_gap(path, count, refine):
    crank, coupler, rocker = designs()
    gap = np.minimum(coupler + rocker - (0.1 + crank), np.abs(0.1 - crank) - np.abs(coupler - rocker))
    found = design_figures(
        from_text(TEXT),
        {"crank.A.x": crank, "coupler.B.x": coupler, "rocker.B.x": rocker},
        FIGURES,
        np.arange(count) * (FULL_TURN / count),
        speed=7.0,
        path=path,
        refine=refine,
    )
    turns = gap > 1e-15
    assert 50 < np.count_nonzero(turns) < len(turns) - 50
    np.testing.assert_array_equal(np.isfinite(found), [turns, turns])


def test_over_a_range_only_the_dead_positions_in_it_count():
    """One of the designs fails about half a turn, the other from 0.03 to 0.17 rad, between two samples."""
    designs = {"coupler.B.x": [0.0999, 0.1001], "rocker.B.x": [0.03, 0.03]}
    for start, fails in ((0.2, [False, False]), (-0.6, [False, True])):
        found = design_figures(from_text(TEXT), designs, FIGURES, np.linspace(start, 1.2, 10), speed=7.0)
        np.testing.assert_array_equal(np.isnan(found), [fails, fails])
