"""How the crank or the drive is to move: from options to motions and back, of one design or many; what cannot be."""

import json
import math

import numpy as np
import pytest

import linkproof as package
from analytic.description.crank_motion import LAWS, REGIMES, RPM
from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.designer.open_ends import MARGIN
from reports.api.campaign import request
from reports.api.motions import requested_motions
from reports.api.options import Motion
from tests.analytic.linkages import driven, path_of
from tests.commands import linkproof

SWING = {"from_angle": 20.0, "to_angle": 110.0}
MOTOR = driven("linear-motor")


def motions(**options):
    return requested_motions(Motion(**options), [])[0]


def linear(**options):
    """The motion of a drive along a line, and its conditions."""
    (motion,), conditions, _ = requested_motions(Motion(**options), [MOTOR.linkage])
    return motion, conditions


def ends(motion):
    return [float(motion.angle(np.array(time))) for time in (0.0, motion.duration)]


def test_two_angles_alone_are_constant_speed_between_them():
    (motion,) = motions(from_angle=110.0, to_angle=20.0, speed=60.0)
    assert motion.regime == "constant-speed"
    assert motion.speed(0.0) == pytest.approx(-60.0 * RPM)
    assert motion.duration == pytest.approx(0.25)
    assert ends(motion) == pytest.approx([math.radians(110.0), math.radians(20.0)])


def test_the_speed_of_a_swing_is_its_largest():
    found = motions(regime=("all",), speed=120.0, **SWING)
    assert [motion.regime for motion in found] == list(LAWS)
    assert [motion.peak_speed for motion in found] == pytest.approx([120.0 * RPM] * len(LAWS))
    assert [motion.regime for motion in motions(regime=("all",))] == list(REGIMES)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"from_angle": 20.0}, "got only --from: add --to"),
        ({"from_angle": 20.0, "to_angle": 20.0}, "got 20° twice"),
        ({"from_angle": math.nan, "to_angle": 20.0}, "--from: expected a finite number of degrees, got nan"),
        ({**SWING, "speed": -60.0}, "is counter-clockwise, and --speed -60 is not: leave out its sign"),
        ({**SWING, "start_angle": 5.0}, "--start-angle does not apply to a swing"),
        ({**SWING, "regime": ("run-up",)}, "--regime run-up does not end at an angle"),
        ({**SWING, "regime": ("own",)}, "--regime own is defined in its file"),
        ({"regime": ("cycloidal",)}, "--regime cycloidal .* add --from and --to"),
        ({"speed": 0.0}, "--speed: expected a finite number of rpm other than 0, got 0"),
        ({"speed": 1e14}, "--speed: expected a finite number of rpm other than 0 up to 9.55e\\+12, got 1e\\+14"),
        ({"ramp_time": 0.0}, "--ramp-time: expected a positive finite number of s, got 0"),
        ({"regime": ("constant-speed",), "ramp_time": 0.0, "hold_time": 0.0}, "--hold-time: expected a positive"),
        ({"start_angle": math.inf}, "--start-angle: expected a finite number of degrees, got inf"),
    ],
)
def test_a_motion_that_cannot_be_is_one_sentence_in_the_units_of_its_option(options, words):
    with pytest.raises(LinkproofError, match=words):
        request([load("slotted-takeup")], Motion(**options))


def test_travels_and_speeds_of_a_drive_along_a_line_are_in_the_unit_of_its_file():
    motion, conditions = linear(from_angle=10.0, to_angle=60.0, speed=25.0)
    assert ends(motion) == pytest.approx([0.010, 0.060])
    assert (motion.peak_speed, motion.duration) == pytest.approx((0.025, 2.0))
    assert conditions == "from 10 mm to 60 mm, at most 25 mm/s"
    campaign = request([MOTOR.linkage], Motion(regime="cycloidal", from_angle=0.0, to_angle=50.0))
    assert ends(campaign.motions[0]) == pytest.approx([0.0, 0.05])
    assert campaign.conditions.startswith("from 0 mm to 50 mm")


@pytest.mark.parametrize(("speed", "duration"), [({}, 1.0), ({"speed": -50.0}, 0.0)])
def test_by_default_a_drive_along_a_line_goes_over_its_range_in_a_second(speed, duration):
    low, high = MOTOR.crank_range().limits
    motion, _ = linear(**speed)
    inside = [low + MARGIN * (high - low), high - MARGIN * (high - low)]
    assert ends(motion) == pytest.approx(inside[::-1] if speed else inside)
    assert motion.duration == pytest.approx(duration or (inside[1] - inside[0]) / 0.05)


def test_options_of_a_turning_crank_are_refused_for_a_drive_along_a_line():
    with pytest.raises(LinkproofError, match="--regime run-up turns a crank"):
        linear(regime=("run-up",))
    with pytest.raises(LinkproofError, match=r"--start-angle turns a crank, but 'linear-motor' is driven along a line"):
        linear(start_angle=90.0)
    with pytest.raises(LinkproofError, match="cannot share a motion with other linkages"):
        requested_motions(Motion(), [load("juki-mf7923d"), MOTOR.linkage])


def test_a_regime_of_a_file_is_requested_by_its_name_or_with_all_of_them():
    linkages = [load("slotted-takeup")]
    assert requested_motions(Motion(regime=("free",)), linkages)[2] == ("free",)
    assert requested_motions(Motion(regime=("own",)), linkages)[2] == ("driven", "free")
    with pytest.raises(LinkproofError, match="unknown regime 'fre'"):
        requested_motions(Motion(regime=("fre",)), linkages)


@pytest.mark.parametrize(
    ("name", "motion"),
    [
        pytest.param("juki-mf7923d", {"from_angle": 200.0, "to_angle": 30.0}, marks=pytest.mark.nightly),
        (path_of("linear-motor"), {"from_angle": 20.0, "to_angle": 100.0, "speed": 50.0}),
    ],
)
def test_swings_and_drives_along_a_line_have_the_figures_of_results(name, motion):
    words = [word for key, value in motion.items() for word in (f"--{key.removesuffix('_angle')}", str(value))]
    figures = json.loads(linkproof("results", name, *words, "--json").stdout)["figures"]
    force = next(row for row in figures["forces"] if row["what"] == "A")["value"]
    peaks, number = ["Mkr.peak", "joint_force:A.peak"], f"{next(iter(load(name).links))}.mass"
    expected = pytest.approx([abs(figures["drive"][0]["value"]), force], rel=1e-9)
    asked = package.SteadyMotion(**motion)
    mass = load(name).links[number.partition(".")[0]].mass
    found = package.tolerance(name, {number: 1e-6 * mass}, peaks, motion=asked, samples=2).dataset
    assert found["nominal"].values.tolist() == expected
    swept = package.sweep(name, {number: [mass]}, peaks, motion=asked, refine=True).dataset
    assert [float(swept[peak].squeeze()) for peak in peaks] == expected
    over = {number: (0.9 * mass, 1.1 * mass)}
    best = package.optimise(
        name, minimise=peaks[0], keep={peaks[1]: (0.0, 2.0 * force)}, over=over, motion=asked
    ).dataset
    assert [float(best[peak].sel(design="before")) for peak in peaks] == expected
    assert float(best[peaks[0]].sel(design="after")) < expected.expected[0]
