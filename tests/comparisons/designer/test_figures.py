"""Instants of a motion, and key figures against a piston engine's formulas in 50 digits and against brute force."""

import json
import math

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import cumulative_simpson, simpson
from scipy.optimize import brentq

from analytic.description.crank_motion import RPM, CrankMotion, Segment, crank_motion, swing
from analytic.description.loading import load
from analytic.dynamics.reduced import generalised_force, reduced_inertia
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import signal
from comparisons.designer.curves import Instants
from comparisons.designer.figures import BRAKING, MEAN, flywheel
from comparisons.motion.case import Case
from linkproof import sweep
from tests.analytic.linkages import FOLDER, FULL_TURN, PENDULUM, from_text, mechanism
from tests.commands import linkproof
from tests.reports.designs.samples import CRANK, MASS, ROD, SPEED, TURN, curves, engine, piston, piston_text, results

RUN_UP = crank_motion("run-up", speed=600 * RPM, ramp_time=0.1, hold_time=0.1, start_angle=math.radians(20))

CLOSE = 1e-11  # of the value: a refined peak of the closed form
PLACE = 1e-6  # rad
EACH_KIND = (("near-toggle", None), ("two-crank-takeup", mechanism("two-crank-takeup").linkage.variant))


def at(motion, *angles):
    return Instants(motion).times_of_angles(np.array(angles, dtype=float), "°", math.radians(1.0))


def test_both_sides_of_a_jump_are_instants_of_the_grid():
    grid = Instants(RUN_UP).grid
    (place,) = np.flatnonzero(grid == 0.1)
    assert grid[place - 1] == np.nextafter(0.1, 0.0)
    assert RUN_UP.acceleration(grid[place - 1 : place + 1]) == pytest.approx([600 * RPM / 0.1, 0.0])


def test_angles_are_taken_modulo_a_turn_and_under_a_run_up_at_their_first_passing():
    assert at(TURN, 0, 30, 390, -30) * SPEED == pytest.approx(np.radians([0, 30, 30, 330]))
    # φ = 20° + ½ ε t² up to 200° at 0.1 s, then 3600°/s: 90° is passed on the ramp, 10° a turn later.
    on_ramp = math.sqrt(2 * math.radians(90 - 20) / (600 * RPM / 0.1))
    assert at(RUN_UP, 90, 10, 20) == pytest.approx([on_ramp, 0.1 + 170 / 3600, 0.0], rel=1e-12)


def test_a_crank_that_turns_back_passes_an_angle_where_it_first_gets_there():
    back = swing("constant-speed", math.radians(80), math.radians(20), speed=math.radians(60))
    assert at(back, 80, 50, 20) == pytest.approx([0.0, 0.5, 1.0], abs=1e-9)


def test_what_the_motion_does_not_pass_is_refused_with_its_range():
    with pytest.raises(LinkproofError, match=r"--at: expected values that the motion passes, from 20° to 80°.*got 90°"):
        at(swing("cycloidal", math.radians(20), math.radians(80), speed=1.0), 30, 90)
    with pytest.raises(LinkproofError, match=r"--time: expected instants from 0 to 0.2 s, the motion's, got 0.3"):
        Instants(RUN_UP).checked_times(np.array([0.1, 0.3]))
    assert Instants(RUN_UP).checked_times(np.array([0.2])) == [0.2]


def test_a_travel_has_no_period():
    there = Instants(swing("constant-speed", 0.0, 0.01, speed=0.02), turns=False)
    assert len(there.grid) == 721
    assert there.times_of_angles(np.array([0.0, 5.0, 10.0]), " mm", 1e-3) == pytest.approx([0.0, 0.25, 0.5])
    with pytest.raises(LinkproofError, match=r"from 0 mm to 10 mm, got 11 mm"):
        there.times_of_angles(np.array([11.0]), " mm", 1e-3)


def test_a_short_stroke_between_long_dwells_is_seen():
    pieces = [(0.0, 5.0, (0.0,)), (5.0, 5.01, (0.0, 0.0, 3e4, -2e6)), (5.01, 20.0, (1.0,))]
    grid = Instants(CrankMotion("index", tuple(Segment(*piece) for piece in pieces))).grid
    assert np.count_nonzero((grid > 5.0) & (grid < 5.01)) > 100
    assert len(grid) < 400


def place(angle):
    """Of the piston, in 50 digits."""
    return CRANK * mp.cos(angle) + mp.sqrt(mp.mpf(ROD) ** 2 - (CRANK * mp.sin(angle)) ** 2)


def torque(angle):
    """Of the drive: the power of the piston's inertia over ω, for the crank turns evenly and the rod has no mass."""
    return MASS * SPEED**2 * mp.diff(place, angle, 2) * mp.diff(place, angle)


def rows(sheet, table):
    """Key figures of a table by what they are and their signal."""
    return {(one.what, one.signal): one for one in sheet.figures[table]}


def test_torque_power_rms_and_means_of_a_piston_engine_are_those_of_its_formula():
    found = rows(piston(), "drive")
    peak_power = found["peak power", "Peq"]
    with mp.workdps(25):
        top = mp.findroot(lambda x: mp.diff(torque, x), peak_power.time * SPEED)
        peak = float(torque(top))
        mean_square = mp.quad(lambda x: torque(x) ** 2, mp.linspace(0, mp.pi, 4)) / mp.pi  # it is symmetric
        rms = float(mp.sqrt(mean_square))
    assert found["peak power", "Mkr"].value == pytest.approx(peak, rel=CLOSE)
    assert peak_power.value == pytest.approx(peak * SPEED, rel=CLOSE)
    assert (peak_power.time * SPEED, peak_power.phi) == pytest.approx((float(top), float(top)), abs=PLACE)
    assert abs(found["peak torque", "Mkr"].value) == pytest.approx(peak, rel=CLOSE)
    assert found["peak braking power", "Peq"].value == pytest.approx(-peak * SPEED, rel=CLOSE)  # it is symmetric
    assert (found["RMS torque", "Mkr"].value, found["RMS torque", "Mkr"].time) == (pytest.approx(rms, rel=CLOSE), None)
    assert [found[MEAN, name].value for name in ("Mkr", "Peq")] == [0.0, 0.0]  # not 1e-8
    assert found[MEAN, "omega"].value == pytest.approx(SPEED, rel=CLOSE)
    assert ("peak speed", "omega") not in found


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_mean_has_its_sign(sign):
    """A crank of its own weight on a damper: the mean torque is the damper's, against the motion's sense."""
    text = piston_text() + '[[dampers]]\nbetween = ["crank", "ground"]\ncoefficient = 0.01\n'
    motion = CrankMotion("constant-speed", (Segment(0.0, 2.0 * math.pi / SPEED, (0.0, sign * SPEED)),))
    found = rows(results(from_text(text), motion), "drive")
    assert found[MEAN, "Mkr"].value == pytest.approx(0.01 * sign * SPEED, rel=1e-9)
    assert found[MEAN, "omega"].value == pytest.approx(sign * SPEED)
    assert found[MEAN, "Peq"].value == pytest.approx(0.01 * SPEED**2, rel=1e-9)
    assert found["RMS torque", "Mkr"].value > 0.01 * SPEED


def test_bearing_forces_of_a_piston_engine_peak_at_the_dead_centre_along_the_stroke():
    """There the rod lies along the stroke and the piston's acceleration is r ω² (1 + r / l)."""
    peak = MASS * SPEED**2 * CRANK * (1 + CRANK / ROD)
    found = {(one.what, one.unit): one for one in piston().figures["forces"]}
    for joint, link, direction in (("B", "rod", 0.0), ("A", "rod", math.pi), ("O", "crank", math.pi)):
        force = found[joint, "N"]
        assert force.value == pytest.approx(peak, rel=CLOSE)
        assert force.on == link
        assert abs(found[joint, "rad"].value) == pytest.approx(direction, abs=PLACE)
        assert math.sin(force.time * SPEED) == pytest.approx(0.0, abs=PLACE)
    assert found["shaking force", "N"].value == pytest.approx(peak, rel=CLOSE)
    assert found["piston on ground", "N"].on == "piston"


def test_output_and_transmission_angle_of_a_piston_engine():
    sheet = piston()
    output = rows(sheet, "output")
    assert output["stroke", "S"].value == pytest.approx(2 * CRANK, rel=CLOSE)
    ends = [output[what, "S"].value for what in ("least S", "largest S")]
    assert ends == pytest.approx([0.0, 2 * CRANK], abs=1e-15)
    assert output["peak a", "a"].value == pytest.approx(CRANK * SPEED**2 * (1 + CRANK / ROD), rel=CLOSE)
    (worst,) = sheet.figures["transmission"]
    assert worst.value == pytest.approx(math.acos(CRANK / ROD), rel=CLOSE)
    assert abs(math.sin(worst.time * SPEED)) == pytest.approx(1.0, abs=PLACE)


OTHERS = [pytest.param(*sample, marks=pytest.mark.nightly) for sample in FULL_TURN if sample not in EACH_KIND]


@pytest.mark.parametrize(("name", "variant"), [*EACH_KIND, *OTHERS])
def test_no_instant_of_a_dense_search_beats_a_peak(name, variant):
    sample = mechanism(name, variant)
    motion = crank_motion("run-up", speed=300 * RPM, ramp_time=0.2, hold_time=0.05, start_angle=0.3)
    found = curves(sample, motion)
    sheet = results(sample, motion)
    time = np.sort(np.append(np.linspace(0.0, 0.25, 20_001), np.nextafter(0.2, 0.0)))
    dense = Case(sample, motion).at(time)
    names = [name for name in found.names if not name.endswith(":angle")]
    for what, peak in found.peaks(names).items():
        zero = np.pi / 2 if what.startswith("transmission") else 0.0
        most, rounding = np.max(np.abs(found.signal_values(dense, what) - zero)), 1e-12 * sheet.scale(what)
        assert most - rounding <= abs(peak.value - zero) <= most * (1 + 1e-2) + rounding, what


def test_a_peak_at_a_jump_of_the_acceleration_is_that_of_the_higher_side():
    """The linear ramp ends at 0.02 s; just before, the crank is still accelerated and the torque is largest."""
    motion = crank_motion("run-up", speed=500 * RPM, ramp_time=0.02, hold_time=0.02)
    sample = mechanism("centric-slider-crank")
    (peak,) = curves(sample, motion).peaks(["epsilon"]).values()
    assert peak.value == pytest.approx(500 * RPM / 0.02)
    before = Case(sample, motion).at(np.array([np.nextafter(0.02, 0.0), 0.02]))
    torques = signal(before, "Mkr")
    assert torques[0] != pytest.approx(torques[1], rel=1e-3)
    assert abs(curves(sample, motion).peaks(["Mkr"])["Mkr"].value) >= np.max(np.abs(torques))


def test_peak_speed_comes_with_the_largest_torque_at_that_speed():
    motion = crank_motion("run-up", speed=500 * RPM, ramp_time=0.02, hold_time=0.12)
    found = rows(piston(motion=motion), "drive")
    assert found["peak speed", "omega"].value == pytest.approx(500 * RPM)
    held = Case(engine(), motion).at(np.append(np.nextafter(0.02, 0.0), np.linspace(0.02, 0.14, 10_001)))
    largest = np.max(np.abs(signal(held, "Mkr")))
    assert abs(found["peak speed", "Mkr"].value) == pytest.approx(largest, rel=1e-6)


def test_the_angle_of_a_link_is_unwrapped_along_the_motion_whatever_instants_are_asked_for():
    motion = swing("constant-speed", 0.0, 30.0, speed=10.0)
    found = curves(mechanism("double-crank"), motion)
    link = next(name for name in found.names if name.endswith("angle") and "crank" not in name.partition(":")[2][:5])
    whole = found.signal_values(found.on_grid, link)
    places = [len(whole) - 1, 3, len(whole) // 2]
    assert found.signal_values(found.truth_at(found.grid[places]), link) == pytest.approx(whole[places], abs=1e-12)


def test_peaks_and_means_of_a_load_of_straight_lines_are_exact():
    """Its corners are the peaks; between them the torque of a massless linkage is linear, and so is its integral."""
    file = FOLDER / "designer" / "kink.toml"
    angle = np.radians([10.3, 100.123, 200.0, 300.0, 370.3])
    torque = np.array([0.0, 1.0, 0.0, -0.2, 0.0])
    first, two = torque[:-1], torque[1:]
    mean = np.diff(angle) @ (0.5 * (first + two)) / (2.0 * np.pi)
    rms = math.sqrt(np.diff(angle) @ ((first**2 + first * two + two**2) / 3.0) / (2.0 * np.pi))
    found = rows(results(Mechanism(load(str(file)))), "drive")
    exact = {"peak torque": 1.0, "peak power": 1.0, BRAKING: -0.2, "RMS torque": rms, MEAN: mean}
    assert {what: found[what, "Mkr"].value for what in exact} == pytest.approx(exact, rel=1e-14)
    swept = sweep(file, {"crank.A.x": [19.0, 21.0]}, ("Mkr.max", "Mkr.min", "Mkr.rms", "Mkr.mean"), refine=True).dataset
    for name, value in zip(swept, (1.0, -0.2, rms, mean), strict=True):
        assert swept[name].to_numpy() == pytest.approx(np.full(2, value), rel=1e-14), name


def test_a_crank_that_stands_still_takes_the_torque_that_holds_the_weights(tmp_path):
    """Of a pendulum 2 kg · 9.81 m/s² · 0.5 m · cos φ, whatever its speed would be; a released crank is not held."""
    file = tmp_path / "pendulum.toml"
    file.write_text(PENDULUM + "[regimes.go]\nstart_angle = 0\nduration = 1\n", encoding="utf-8")
    found = json.loads(linkproof("results", file, "--speed", "0", "--json").stdout)
    phi, torque = (np.array(found["values"][name]) for name in ("phi", "Mkr"))
    assert torque == pytest.approx(9.81 * np.cos(phi), abs=1e-13)
    assert np.ptp(phi) == pytest.approx(2.0 * np.pi)
    assert not np.any([found["values"][name] for name in ("omega", "epsilon", "Peq")])
    released = linkproof("results", file, "--speed", "0", "--regime", "go")
    assert (released.returncode, "holds the crank, and the regime releases it" in released.stderr) == (2, True)


def test_a_flywheel_holds_the_fluctuation_of_a_crank_under_a_constant_torque():
    """Of a pendulum ΔW/(δ ω²) less its own inertia; a piston engine under a load is followed by energies."""
    from_pendulum = flywheel(Case(from_text(PENDULUM), TURN), 10.0, 0.05)
    assert from_pendulum == pytest.approx(2.0 * 9.81 / (0.05 * 10.0**2) - (0.1 + 2.0 * 0.25), rel=1e-12)
    load = 'forces = [{ point = "B", link = "piston", force = [-300, 0] }]\n[links.crank]'
    machine, wanted = from_text(piston_text().replace("[links.crank]", load)), 0.3
    needed = flywheel(Case(machine, TURN), -SPEED, wanted)
    phi = np.linspace(0.0, 2.0 * np.pi, 20001)
    sweep = machine.sweep(phi)
    moment, inertia = generalised_force(sweep), reduced_inertia(sweep) + needed
    work = cumulative_simpson(moment - simpson(moment, x=phi) / (2.0 * np.pi), x=phi, initial=0.0)

    def speeds(start):
        return np.sqrt(2.0 * (start + work) / inertia)

    middle = brentq(lambda start: np.max(speeds(start)) + np.min(speeds(start)) - 2.0 * SPEED, -np.min(work), 1e6)
    assert np.ptp(speeds(middle)) / SPEED == pytest.approx(wanted, rel=1e-7)
