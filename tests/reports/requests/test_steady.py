"""The motion of many designs is that of ``results``: a turn, a range, or from one angle to another, at one speed."""

import json
import math

import numpy as np
import pytest

import linkproof as package
from analytic.description.loading import load
from reports.requests.designs import steady_case
from reports.requests.options import SweepOptions
from tests.analytic.linkages import path_of
from tests.commands import linkproof


def steady(name="rimoldi-164", **options):
    return steady_case(load(name), SweepOptions(mechanism=name, **options))


def test_a_crank_that_turns_is_sampled_over_a_turn_in_either_direction():
    for options, sign in (({}, 1.0), ({"clockwise": True}, -1.0), ({"speed": -1000.0}, -1.0)):
        found = steady(**options)
        np.testing.assert_allclose(found.motion.places, np.radians(np.arange(0.0, 360.0, 2.0)), atol=1e-14)
        assert found.motion.is_full_turn
        assert found.motion.speed == pytest.approx(sign * 1000.0 * math.pi / 30.0)
        assert found.conditions.endswith("gravity on, sampled at 180 crank angles")


def test_the_ends_of_a_swing_are_sampled():
    found = steady(from_angle=40.0, to_angle=10.0, gravity=False, refine=True)
    np.testing.assert_allclose(np.degrees(found.motion.places[[0, -1]]), [10.0, 40.0])
    assert not found.motion.is_full_turn
    assert found.motion.speed < 0.0
    assert found.conditions.endswith("gravity off, refined between 180 crank angles")
    assert not any(found.mechanism.linkage.gravity)


def test_a_drive_along_a_line_goes_over_its_range_in_a_second():
    found = steady(path_of("linear-motor"))
    assert found.motion.speed == pytest.approx(found.motion.places[-1] - found.motion.places[0])
    assert "sampled at 180 places" in found.conditions


MOTOR = path_of("linear-motor")


@pytest.mark.parametrize(
    ("name", "motion"),
    [
        ("juki-mf7923d", {"from_angle": 200.0, "to_angle": 30.0}),
        (MOTOR, {"from_angle": 20.0, "to_angle": 100.0, "speed": 50.0}),
    ],
)
def test_swings_and_drives_along_a_line_have_the_figures_of_results(name, motion):
    words = [word for key, value in motion.items() for word in (f"--{key.removesuffix('_angle')}", str(value))]
    figures = json.loads(linkproof("results", name, *words, "--json").stdout)["figures"]
    force = next(row for row in figures["forces"] if row["what"] == "A")["value"]
    peaks, number = ["Mkr.peak", "joint_force:A.peak"], f"{next(iter(load(name).links))}.mass"
    expected = pytest.approx([abs(figures["drive"][0]["value"]), force], rel=1e-9)
    mass = load(name).links[number.partition(".")[0]].mass
    found = package.tolerance(name, {number: 1e-6 * mass}, peaks, samples=2, **motion)
    assert found["nominal"].values.tolist() == expected
    swept = package.sweep(name, {number: [mass]}, peaks, refine=True, **motion)
    assert [float(swept[peak].squeeze()) for peak in peaks] == expected
    over = {number: (0.9 * mass, 1.1 * mass)}
    best = package.optimise(name, minimise=peaks[0], keep={peaks[1]: (0.0, 2.0 * force)}, over=over, **motion)
    assert [float(best[peak].sel(design="before")) for peak in peaks] == expected
    assert float(best[peaks[0]].sel(design="after")) < expected.expected[0]
