"""Data sheets hold what the closed form says, of every kind of linkage and of a released crank, and are read back."""

from dataclasses import replace

import numpy as np
import pytest

from analytic.description.crank_motion import RPM, crank_motion, swing
from analytic.description.loading import load
from analytic.errors import LinkproofError
from analytic.kinematics import frames
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.building import (
    describe_release,
    usual_case,
    usual_sheet,
)
from comparisons.motion.case import Case, case_of_file_regime, motion_of_file_regime
from comparisons.trials.campaign.saved_linkages import load_cases, save_case
from comparisons.trials.runs.files import STORE
from tests.analytic.linkages import FOLDER, from_text
from tests.analytic.textbook import DOUBLE_ROCKER, PENDULUM, ROTOR

LAW = "\n[regimes.go]\ntorque = {torque}\nstart_angle = {angle}\nstart_speed = {speed}\nduration = 2\n"


def released_of(text, **law):
    mechanism = from_text(text + LAW.format(**law))
    own = mechanism.linkage.released["go"]
    motion = motion_of_file_regime(mechanism, own)
    return describe_release(mechanism, own, motion), motion


def test_a_pendulum_rests_where_it_hangs_and_where_it_stands():
    found, motion = released_of(PENDULUM, torque=0, angle=-1.2, speed=0)
    assert [(round(rest["angle"] % (2 * np.pi), 9), rest["stable"]) for rest in found.facts["rests"]] == [
        (round(np.pi / 2, 9), False),
        (round(3 * np.pi / 2, 9), True),
    ]
    assert [found.facts[name] for name in ("ending", "settled", "over")] == [None, None, ""]
    assert not found.last_turn
    assert found.motion["phi"].min() == pytest.approx(float(np.min(motion.angle(np.linspace(0, 2, 9999)))), abs=1e-5)


def test_a_damped_rotor_settles_at_torque_over_damping():
    found, _ = released_of(ROTOR, torque=5, angle=0, speed=99)
    assert found.facts["damping"] == pytest.approx(0.05)
    assert found.facts["settled"]["mean_speed_over_angle"] == pytest.approx(5 / 0.05)
    assert found.facts["ending"]["mean_speed"] == pytest.approx(100.0, rel=0.01)
    assert np.all(np.diff(found.last_turn["phi"]) >= 0.0)


def test_a_sheet_has_the_requested_regimes_alone():
    sheet = usual_sheet(load("slotted-takeup"), regimes=("free", "run-up"))
    assert list(sheet.released) == ["free"]
    assert not usual_sheet(load("slotted-takeup")).released


def test_cases_come_back_and_a_later_one_of_a_linkage_replaces_the_first(tmp_path):
    juki = replace(load("juki-mf7923d", "as-printed"), gravity=(0.0, 0.0))
    takeup = load("slotted-takeup")
    released = replace(case_of_file_regime(Mechanism(takeup), takeup.released["free"]), mechanism=Mechanism(takeup))
    swing = Case(Mechanism(juki), crank_motion("run-up", clockwise=True, start_angle=0.3), conditions="as asked")
    assert load_cases(tmp_path) == []
    for case in (Case(Mechanism(juki), crank_motion("constant-speed")), released, swing):
        save_case(tmp_path, case)
    free, run_up = load_cases(tmp_path)
    assert (run_up.mechanism.linkage, run_up.motion, run_up.conditions) == (juki, swing.motion, "as asked")
    assert (free.mechanism.linkage, free.conditions) == (takeup, released.conditions)
    assert free.motion.angle(0.1) == pytest.approx(released.motion.angle(0.1), rel=1e-12)


def test_a_damaged_file_is_refused_with_the_cure(tmp_path):
    save_case(tmp_path, Case(Mechanism(load("juki-mf7923d")), crank_motion("run-up")))
    store = tmp_path / STORE
    store.write_bytes(store.read_bytes().replace(b'"motion"', b'"motive"'))
    with pytest.raises(LinkproofError, match="run results with --out again"):
        load_cases(tmp_path)


@pytest.mark.parametrize("name", ["slotted-takeup", str(FOLDER / "drives" / "linear-motor.toml")])
def test_the_positions_put_every_point_where_the_linkage_has_it(name):
    found, mechanism = usual_sheet(load(name)), Mechanism(load(name))
    positions = found.positions
    sweep = mechanism.sweep(np.interp(positions.axis, found.values[positions.over], found.values["phi"]))
    for link in found.linkage.links.values():
        x, y, turned = found.positions.bodies[link.name]
        for point, local in link.points.items():
            there = frames.point((x, y, np.cos(turned), np.sin(turned)), local)
            assert np.allclose(there, sweep.point(point), atol=1e-12), (link.name, point)


def test_straight_lines_between_the_instants_show_every_peak():
    found = usual_sheet(load(str(FOLDER / "near-toggle.toml")))
    assert len(found.values["phi"]) <= 721
    for signal, peak in found.peaks.items():
        if not signal.startswith("transmission"):
            largest = np.max(np.abs(found.values[signal]))
            assert largest == pytest.approx(abs(peak.value), rel=1e-9, abs=1e-9), signal


def test_the_crank_turns_as_fast_as_the_first_motion_ends():
    mechanism = Mechanism(load("juki-mf7923d"))
    assert usual_case(mechanism).motion.peak_speed == pytest.approx(1000 * RPM)
    slow = crank_motion("run-up", speed=7.0, clockwise=True)
    case = usual_case(mechanism, (slow, crank_motion("run-up", speed=9.0)))
    assert (case.motion.peak_speed, float(case.motion.speed(0.0))) == (pytest.approx(7.0), pytest.approx(-7.0))
    found = usual_sheet(mechanism.linkage, (slow,))
    assert found.values["phi"][[0, -1]] == pytest.approx([0.0, 2 * np.pi])
    assert np.all(np.diff(found.values["phi"]) > 0.0)


def test_a_crank_that_makes_no_turn_swings_over_its_range():
    found = usual_sheet(from_text(DOUBLE_ROCKER).linkage)
    assert (found.axis, found.positions.over, found.positions.closed) == ("phi", "time", False)
    low, high = (found.facts["range"][end] for end in ("low", "high"))
    assert low < found.values["phi"].min() < low + 0.03 * (high - low)
    mechanism = from_text(DOUBLE_ROCKER)
    stated = swing("cycloidal", low + 0.1, high - 0.1, speed=1.0)
    assert usual_case(mechanism, (stated,)).motion is stated


def test_a_rigid_pendulum_needs_its_torque_against_gravity_and_without_mass_none():
    found = usual_sheet(from_text(PENDULUM).linkage)
    assert np.allclose(found.values["Mkr"], 2 * 9.81 * 0.5 * np.cos(found.values["phi"]), atol=1e-9)
    assert found.missing == {}
    assert (found.thread, found.figures["output"]) == (None, ())
    light = usual_sheet(from_text(PENDULUM.replace("mass = 2\n", "").replace("inertia = 0.1\n", "")).linkage)
    assert (light.shares, light.figures["drive"], "Mkr" in light.values) == ({}, (), False)


def test_what_cannot_be_assembled_has_a_sheet_with_the_reason():
    linkage = load("juki-mf7923d")
    rod = linkage.links["coupler"]
    points = {name: (4.0 * x, y) for name, (x, y) in rod.points.items()}
    broken = replace(linkage, links={**linkage.links, "coupler": replace(rod, points=points)})
    far = usual_sheet(replace(broken, ground=dict.fromkeys(linkage.ground, (9.0, 9.0))))
    assert "values" in far.missing
    assert far.facts["links"].keys() == linkage.links.keys()
