"""Data sheets hold what the closed form says, of every kind of linkage and of a released crank, and are read back."""

import json
import re
from dataclasses import replace
from itertools import chain
from pathlib import Path

import numpy as np
import pytest

from analytic.description.crank_motion import RPM, crank_motion, swing
from analytic.description.loading import catalogue, load, parse
from analytic.errors import DescriptionError
from analytic.kinematics import frames
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.building import describe_release, range_motion, sheet, usual_case, usual_sheet
from comparisons.motion.case import Case, case_of_file_regime, motion_of_file_regime
from comparisons.trials.campaign.results import load_cases, save_case
from tests.analytic.linkages import DOUBLE_ROCKER, FOLDER, PENDULUM, ROTOR, from_text
from tests.commands import linkproof

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


# Extremes at an end of a motion beside a dead position are marked, and a sentence says how to keep away from it.


DESIGNER = Path(__file__).parents[2] / "linkages" / "designer"
FILES = [*catalogue(), *map(str, sorted(DESIGNER.glob("*.toml")))]
OPEN = [(name, variant) for name in FILES for variant in load(name).variants
        if not Mechanism(load(name, variant)).crank_range().is_full_turn]  # fmt: skip
MARK = re.compile(r"\d\*\s")
SUGGESTED = re.compile(r"--from (\S+) --to (\S+) keeps")


def of_command(*words):
    done = linkproof(*words, "--json")
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize(
    ("name", "variant", "backwards"), [*((*one, False) for one in OPEN), (str(DESIGNER / "e11.toml"), "base", True)]
)
def test_no_extreme_at_an_open_end_is_unmarked(name, variant, backwards):
    """Of the motion over a range less 2 %: where the greatest value of a signal is its first or its last."""
    mechanism = Mechanism(load(name, variant))
    found = sheet(Case(mechanism, range_motion(mechanism.crank_range(), backwards=backwards)))
    assert found.open_end_warning
    for signal, peak in found.peaks.items():
        if signal in ("phi", "omega", "epsilon"):
            continue
        values = np.abs(found.values[signal])
        sign = -1.0 if signal.startswith("transmission_angle") else 1.0
        assert peak.at_open_end == bool(np.max(sign * values) in sign * values[[0, -1]] and np.ptp(values)), signal
    peaks = [row for table in ("forces", "moment", "transmission") for row in found.figures[table] if row.unit != "rad"]
    assert all(row.at_open_end == found.peaks[row.signal].at_open_end for row in peaks)


@pytest.mark.parametrize(
    ("name", "limits", "peak", "inside"),
    [
        ("e11", ["11.7159°", "145.168°"], 1364.0, 60.0),
        pytest.param("bucket", ["508.6 mm", "1409 mm"], 2.556e6, 61e3, marks=pytest.mark.nightly),
    ],
)
def test_the_sentence_names_the_limits_and_a_part_whose_extremes_count(name, limits, peak, inside):
    file = DESIGNER / f"{name}.toml"
    whole = of_command("results", file)
    assert abs(whole["peaks"]["Mkr"]["value"]) == pytest.approx(peak, rel=1e-3)
    assert whole["peaks"]["Mkr"]["at_open_end"] is True
    [text] = [text for text in whole["warnings"] if "without bound" in text]
    assert all(limit in text for limit in limits)
    first, last = SUGGESTED.search(text).groups()
    part = of_command("results", file, "--from", first, "--to", last)
    assert not any("without bound" in text for text in part["warnings"])
    assert not any(one["at_open_end"] for one in [*part["peaks"].values(), *chain(*part["figures"].values())])
    assert all(
        np.degrees(one["value"]) >= 40.0
        for signal, one in part["peaks"].items()
        if signal.startswith("transmission_angle")
    )
    assert abs(part["peaks"]["Mkr"]["value"]) < 2.0 * inside


def test_tables_mark_extremes_at_open_ends_alone():
    file = DESIGNER / "e11.toml"
    assert MARK.search(linkproof("results", file).stdout)
    assert not MARK.search(linkproof("results", file, "--from", "40", "--to", "127").stdout)


def test_a_crank_that_turns_fully_and_a_motion_clear_of_the_limits_have_no_open_ends():
    mechanism = Mechanism(load("juki-mf7923d"))
    assert not sheet(Case(mechanism, range_motion(mechanism.crank_range()))).open_end_warning


def test_sweep_optimise_and_tolerance_say_it(tmp_path):
    file, range_ = DESIGNER / "e11.toml", "coupler.mass=0.1:0.2"
    tolerances = tmp_path / "tolerances.toml"
    tolerances.write_text('results = ["Mkr.peak"]\n[tolerances]\n"coupler.mass" = 0.001\n', encoding="utf-8")
    for words in (
        ("sweep", file, "--vary", f"{range_}:3", "--quantity", "Mkr.peak"),
        ("optimise", file, "--over", range_, "--minimise", "Mkr.peak"),
        ("tolerance", file, tolerances, "--samples", "10"),
    ):
        done = linkproof(*words, "--json")
        [text] = json.loads(done.stdout)["warnings"]
        assert re.match(r"Mkr\.peak.* at an open end of the motion: .*--from 40 --to 127", text)
        assert text in done.stderr
        inside = of_command(*words, "--from", "40", "--to", "120")
        assert inside["warnings"] == []


BOUNDED = (
    DESIGNER.joinpath("bucket.toml")
    .read_text(encoding="utf-8")
    .replace('"idler"] }', '"idler"], min = 600, max = 1100 }')
)


def test_a_cylinder_moves_to_its_very_ends_and_no_farther(tmp_path):
    file = tmp_path / "bucket.toml"
    file.write_text(BOUNDED, encoding="utf-8")
    mechanism = Mechanism(load(file))
    reach = mechanism.crank_range()
    motion = range_motion(reach)
    assert (motion.angle(0.0), motion.angle(motion.duration)) == pytest.approx((0.6, 1.1), rel=1e-15)
    assert not sheet(Case(mechanism, motion)).open_end_warning
    assert (reach.low.sentence, reach.high.sentence) == ("the cylinder is retracted", "the cylinder is extended")
    done = linkproof("results", file, "--from", "550", "--to", "1000")
    assert done.returncode == 2
    assert "its drive reaches 600 mm to 1100 mm (at 600 mm the cylinder is retracted)" in done.stderr


@pytest.mark.parametrize(
    ("old", "new"), [("max = 1100", "max = 500"), ("max = 1100", "max = 940"), ("min = 600", "min = 960")]
)
def test_a_cylinder_drawn_beyond_its_ends_is_refused(old, new):
    with pytest.raises(
        DescriptionError, match=r"expected a length between min and max in the sketch, got min \d+, max"
    ):
        parse(BOUNDED.replace(old, new), "bucket", "bucket.toml")
