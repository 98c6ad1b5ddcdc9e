"""Key figures of a piston engine against its formulas in 50 digits, and of other linkages against brute force."""

import math

import mpmath as mp
import numpy as np
import pytest

from analytic.description.crank_motion import RPM, crank_motion, swing
from analytic.signals import signal
from comparisons.datasheet.figures import BRAKING, drive_points, force_peaks, output_extremes, stroke, transmission
from comparisons.reference.case import Case, own_case
from reports.command_line.commands.files import TEMPLATE
from tests.analytic.linkages import EVERY, from_text, mechanism
from tests.reports.designs.results.samples import CRANK, MASS, ROD, SPEED, piston, results

CLOSE = 1e-11  # of the value: a refined peak of the closed form
PLACE = 1e-6  # rad


def place(angle):
    """Of the piston, in 50 digits."""
    return CRANK * mp.cos(angle) + mp.sqrt(mp.mpf(ROD) ** 2 - (CRANK * mp.sin(angle)) ** 2)


def torque(angle):
    """Of the drive: the power of the piston's inertia over ω, for the crank turns evenly and the rod has no mass."""
    return MASS * SPEED**2 * mp.diff(place, angle, 2) * mp.diff(place, angle)


def test_torque_power_and_rms_of_a_piston_engine_are_those_of_its_formula():
    points = {point.what: point for point in drive_points(piston().curves)}
    with mp.workdps(40):
        top = mp.findroot(lambda x: mp.diff(torque, x), points["peak power"].time * SPEED)
        peak = float(torque(top))
        mean_square = mp.quad(lambda x: torque(x) ** 2, mp.linspace(0, 2 * mp.pi, 9)) / (2 * mp.pi)
        rms = float(mp.sqrt(mean_square))
    assert points["peak power"].torque == pytest.approx(peak, rel=CLOSE)
    assert points["peak power"].power == pytest.approx(peak * SPEED, rel=CLOSE)
    assert points["peak power"].time * SPEED == pytest.approx(float(top), abs=PLACE)
    assert abs(points["peak torque"].torque) == pytest.approx(peak, rel=CLOSE)
    assert points["peak braking power"].power == pytest.approx(-peak * SPEED, rel=CLOSE)  # the engine is symmetric
    mean = points["RMS torque, means"]
    assert (mean.torque, mean.speed) == pytest.approx((rms, SPEED), rel=CLOSE)
    assert mean.power == pytest.approx(0.0, abs=CLOSE * peak * SPEED)
    assert mean.time is None
    assert "peak speed" not in points


def test_bearing_forces_of_a_piston_engine_peak_at_the_dead_centre_along_the_stroke():
    """There the rod lies along the stroke and the piston's acceleration is r ω² (1 + r / l)."""
    peak = MASS * SPEED**2 * CRANK * (1 + CRANK / ROD)
    found = {one.joint: one for one in force_peaks(piston().curves)}
    for joint, link, direction in (("B", "rod", 0.0), ("A", "rod", math.pi), ("O", "crank", math.pi)):
        assert found[joint].force == pytest.approx(peak, rel=CLOSE)
        assert found[joint].link == link
        assert abs(found[joint].direction) == pytest.approx(direction, abs=PLACE)
        assert math.sin(found[joint].time * SPEED) == pytest.approx(0.0, abs=PLACE)
    assert found["shaking force"].force == pytest.approx(peak, rel=CLOSE)
    assert found["piston on ground"].link == "piston"


def test_output_and_transmission_angle_of_a_piston_engine():
    engine = piston().curves
    ends = output_extremes(engine)
    assert stroke(ends) == pytest.approx(2 * CRANK, rel=CLOSE)
    assert [end.value for end in ends[:2]] == pytest.approx([0.0, 2 * CRANK], abs=1e-15)
    peaks = {end.what: end for end in ends}
    assert peaks["peak a"].value == pytest.approx(CRANK * SPEED**2 * (1 + CRANK / ROD), rel=CLOSE)
    (worst,) = transmission(engine)
    assert worst.value == pytest.approx(math.acos(CRANK / ROD), rel=CLOSE)
    assert abs(math.sin(worst.time * SPEED)) == pytest.approx(1.0, abs=PLACE)


@pytest.mark.parametrize(("name", "variant"), [one for one in EVERY if one[0] != "parallelogram"])
def test_no_instant_of_a_dense_search_beats_a_peak(name, variant):
    sample = mechanism(name, variant)
    motion = crank_motion("run-up", speed=300 * RPM, ramp_time=0.2, hold_time=0.05, start_angle=0.3)
    found = results(sample, motion)
    time = np.sort(np.append(np.linspace(0.0, 0.25, 20_001), np.nextafter(0.2, 0.0)))
    dense = Case(sample, motion).at(time)
    names = [name for name in found.curves.names if not name.endswith(":angle")]
    for what, peak in found.curves.peaks(names).items():
        zero = np.pi / 2 if what.startswith("transmission") else 0.0
        most, rounding = np.max(np.abs(found.curves.of(dense, what) - zero)), 1e-12 * found.scale(what)
        assert most - rounding <= abs(peak.value - zero) <= most * (1 + 1e-2) + rounding, what


def test_a_peak_at_a_jump_of_the_acceleration_is_that_of_the_higher_side():
    """The linear ramp ends at 0.02 s; just before, the crank is still accelerated and the torque is largest."""
    motion = crank_motion("run-up", speed=500 * RPM, ramp_time=0.02, hold_time=0.02)
    sample = mechanism("centric-slider-crank")
    (peak,) = results(sample, motion).curves.peaks(["epsilon"]).values()
    assert peak.value == pytest.approx(500 * RPM / 0.02)
    before = Case(sample, motion).at(np.array([np.nextafter(0.02, 0.0), 0.02]))
    torques = signal(before, "Mkr")
    assert torques[0] != pytest.approx(torques[1], rel=1e-3)
    assert abs(results(sample, motion).curves.peaks(["Mkr"])["Mkr"].value) >= np.max(np.abs(torques))


def test_peak_speed_comes_with_the_largest_torque_at_that_speed():
    motion = crank_motion("run-up", speed=500 * RPM, ramp_time=0.02, hold_time=0.12)
    points = {one.what: one for one in drive_points(piston(motion=motion).curves)}
    assert points["peak speed"].speed == pytest.approx(500 * RPM)
    held = Case(piston().case.mechanism, motion).at(np.append(np.nextafter(0.02, 0.0), np.linspace(0.02, 0.14, 20_001)))
    assert abs(points["peak speed"].torque) == pytest.approx(np.max(np.abs(signal(held, "Mkr"))), rel=1e-6)


def test_the_angle_of_a_link_is_unwrapped_along_the_motion_whatever_instants_are_asked_for():
    motion = swing("constant-speed", 0.0, 30.0, speed=10.0)
    curves = results(mechanism("double-crank"), motion).curves
    link = next(name for name in curves.names if name.endswith("angle") and "crank" not in name.partition(":")[2][:5])
    whole = curves.of(curves.on_grid, link)
    places = [len(whole) - 1, 3, len(whole) // 2]
    assert curves.of(curves.at(curves.grid[places]), link) == pytest.approx(whole[places], abs=1e-12)


def test_a_drive_that_never_brakes_has_no_braking_power():
    sample = from_text(TEMPLATE.read_text() + "[regimes.free]\ntorque = 0.02\nstart_angle = 60\nduration = 0.5\n")
    points = drive_points(results(sample, own_case(sample, sample.linkage.regimes[0]).motion).curves)
    assert "peak power" in {point.what for point in points}
    assert BRAKING not in {point.what for point in points}
