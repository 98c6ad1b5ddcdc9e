"""The best designs against optima known from formulas, and against dense grids that no optimiser has seen."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from analytic.description.changes import changed
from analytic.description.loading import load
from analytic.designs.figures import Figure, Reduction
from analytic.designs.results import design_figures
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.building import sheet, usual_case
from comparisons.designer.optimisation import optimise
from comparisons.designer.parameters import case_at_speed
from comparisons.designer.searches import AGREEING
from tests.analytic.linkages import from_text
from tests.comparisons.designer.sweeps import BARE

SPEED = 100.0
TURN = np.linspace(0.0, 2.0 * np.pi, 360, endpoint=False)
PEAK, STROKE = Figure("Mkr", Reduction.PEAK), Figure("S", Reduction.RANGE)
CRANK, GROUND, ROCKER = 0.02, 0.06, 0.045  # m, of the four-bar


def best(mechanism, *over, **wish):
    chosen = mechanism if isinstance(mechanism, Mechanism) else Mechanism(load(mechanism))
    return optimise(case_at_speed(chosen, SPEED), over=over, **wish)


def moved(name, value):
    """The four-bar with one number changed."""
    return Mechanism(changed(from_text(BARE).linkage, lambda one, _, old: value if one == name else old))


def figures(mechanism, numbers, *wanted):
    return design_figures(mechanism, numbers, wanted, TURN, speed=SPEED, period=2.0 * np.pi, refine=True)


def test_the_least_transmission_angle_is_that_of_results_on_either_side_of_a_right_angle():
    """By the cosine rule at both ends of the diagonal, g - a and g + a; the least of both is largest where they tie."""
    figure = "transmission_angle:coupler + rocker (RRR).min"

    def least(coupler):
        cosines = [
            (coupler**2 + ROCKER**2 - gap**2) / (2.0 * coupler * ROCKER) for gap in (GROUND - CRANK, GROUND + CRANK)
        ]
        return math.acos(max(map(abs, cosines)))

    dense = np.linspace(0.036, 0.075, 30_001)
    expected = max(map(least, dense))
    found = best(moved("", 0.0), "coupler.B.x=36:75", figure=figure, is_least=False)
    assert found.values[1, 0] == pytest.approx(expected, abs=1e-5)
    assert found.values[1, 0] == pytest.approx(least(found.after["coupler.B.x"]), rel=1e-12)
    assert found.search.residual < 1e-7
    case = usual_case(moved("coupler.B.x", found.after["coupler.B.x"]))
    (shown,) = sheet(case).figures["transmission"]
    assert shown.value == pytest.approx(found.values[1, 0], rel=1e-9)


def test_where_two_tops_tie_the_optimum_is_the_kink():
    # y of the crank's end is e + a sin φ: its largest magnitude, |e| + a, has a kink at its least, e = 0.
    found = best(moved("ground.O1.y", 0.006), "ground.O1.y=-8:10", figure="point:A:y.peak")
    assert found.after["ground.O1.y"] == pytest.approx(0.0, abs=1e-13)
    assert abs(found.values[1, 0]) == pytest.approx(CRANK, rel=1e-12)
    assert found.search.residual < 1e-9


def test_the_largest_of_all_joints_is_lower_than_a_grid_finds():
    found = best("rimoldi-164", "rod.B.x=±6%", "crank.centre.x=-4:8", figure="joint_force.peak")
    mechanism, names = found.problem.case.mechanism, list(found.after)
    rod, centre = (
        side.ravel() for side in np.meshgrid(np.linspace(0.94, 1.06, 21) * 0.175, np.linspace(-4, 8, 21) * 1e-3)
    )
    joints = [one.figure for one in found.problem.aims]
    grid = np.max(np.abs(figures(mechanism, dict(zip(names, (rod, centre), strict=True)), *joints)), axis=0)
    least = np.max(np.abs(found.values[1, : len(joints)]))
    assert least <= np.nanmin(grid) * (1.0 + 1e-12)
    assert np.nanmin(grid) < 1.02 * least
    assert found.search.residual < 1e-6


def test_a_kept_stroke_is_kept_and_no_design_that_keeps_it_is_lower():
    over = ("rod.B.x=172:178", "rocker.B.x=±10%")
    found = best("rimoldi-164", *over, figure="Mkr.peak", keep=["stroke"])
    own, after = found.values[:, 1]
    assert after == pytest.approx(own, rel=1e-9)
    mechanism = found.problem.case.mechanism

    def peak(rod):
        def miss(rocker):
            return float(figures(mechanism, {"rod.B.x": [rod], "rocker.B.x": [rocker]}, STROKE)[0, 0]) - own

        rocker = brentq(miss, 0.9 * 0.0213, 1.1 * 0.0213, xtol=1e-15)
        return abs(float(figures(mechanism, {"rod.B.x": [rod], "rocker.B.x": [rocker]}, PEAK)[0, 0]))

    least, place = abs(found.values[1, 0]), found.after["rod.B.x"]
    others = [peak(rod) for rod in (*np.linspace(0.172, 0.178, 3), place - 1e-6, place + 1e-6)]
    assert least <= min(others) + 1e-10
    assert peak(place) == pytest.approx(least, rel=1e-8)


def test_kept_figures_that_nothing_moves_or_that_say_the_same_do_not_hinder():
    over, keep = ("rod.mass=±20%", "rocker.B.x=±5%"), ["stroke", "S.max", "point:A:x.max"]
    found = best("rimoldi-164", *over, figure="Mkr.rms", keep=keep)
    assert found.search.residual < 1e-6
    assert found.values[1, 0] < 0.99 * found.values[0, 0]
    assert found.values[1, 1:4] == pytest.approx(found.values[0, 1:4], rel=1e-9)


@pytest.mark.nightly
def test_searching_everywhere_does_not_miss_the_least():
    # The stroke has a least value near 172.7 mm, where the file's design leads, and a lower one at the bound.
    alone, several = (
        best("rimoldi-164", "rod.B.x=170:180", figure="stroke", everywhere=everywhere) for everywhere in (False, True)
    )
    assert len(alone.search.ends) == 1
    assert several.search.elsewhere
    assert len(several.search.ends) > AGREEING  # none is left out where they differ
    assert several.values[1, 0] < 0.995 * alone.values[1, 0]
    assert several.bound(several.problem.variables[0]) == "upper"


def test_a_start_that_cannot_be_assembled_leaves_the_search_to_others():
    far = best("rimoldi-164", "rod.B.x=185:230", "ground.O2.y=175:230", figure="Mkr.peak")
    assert far.search.ends[-1] is not None
    assert np.isfinite(far.values[1, 0])


def test_where_no_design_meets_a_constraint_the_nearest_of_all_is_named():
    over = ("rod.B.x=170:180", "rocker.B.x=20:23")
    rods, rockers = (values.ravel() for values in np.meshgrid(np.linspace(0.17, 0.18, 21), np.linspace(0.02, 0.023, 7)))
    numbers = {"rod.B.x": rods, "rocker.B.x": rockers}
    longest = np.nanmax(figures(Mechanism(load("rimoldi-164")), numbers, STROKE))
    with pytest.raises(LinkproofError, match=f"nearest found has {1e3 * longest:.6g} mm"):
        best("rimoldi-164", *over, figure="Mkr.peak", keep=["stroke=50:51"])


@pytest.mark.parametrize(
    ("wish", "over"),
    [
        ({"figure": "Mkr.range"}, "rod.B.x=±3%"),
        pytest.param({"figure": "Mkr.rms"}, "rocker.mass=±50%", marks=pytest.mark.nightly),
        pytest.param({"figure": "Mkr@30", "is_least": False}, "rocker.B.x=±5%", marks=pytest.mark.nightly),
        pytest.param(
            {"figure": "Mkr.peak", "keep": ["stroke=3.09cm:31", "Mkr.min=-0.26:"]},
            "rocker.B.x=±5%",
            marks=pytest.mark.nightly,
        ),
    ],
)
def test_over_one_number_every_kind_of_figure_is_as_good_as_on_a_fine_grid(wish, over):
    found = best("rimoldi-164", over, **wish)
    problem = found.problem
    values = np.linspace(0.0, 1.0, 101)[:, None]
    named = dict.fromkeys(found.after, problem.low[0] + problem.width[0] * values[:, 0])
    grid = figures(problem.case.mechanism, named, *(one.figure for one in problem.figures))
    for one, row in zip(problem.constraints, grid[1:], strict=True):
        grid[0, one.violation(row) > 0.0] = np.nan
    sided, least = problem.sign * grid[0], problem.sign * found.values[1, 0]
    assert least <= np.nanmin(sided) + 1e-9 * abs(least)
    assert least == pytest.approx(np.nanmin(sided), rel=1e-2)
