"""Signals by name: their units, and their values against textbook formulas and a second Newton-Euler balance."""

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest

from analytic import signals
from analytic.description.changes import without
from analytic.description.crank_motion import CrankMotion, Segment, crank_motion
from analytic.dynamics import reduced
from analytic.dynamics.joint_forces import shaking
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import evaluate, names, signal, unit
from comparisons.motion.case import Case
from tests.analytic.linkages import DOUBLE_ROCKER, EVERY, IN_LINE, angles, from_text, mechanism
from tests.analytic.tolerances import FIFTY_DIGITS, SAME_FIGURES

MOTION = CrankMotion("test", (Segment(0.0, 0.3, (0.4, 21.0, 35.0)),))
TIMES = np.linspace(0.0, 0.3, 7)

CRANK, ROD, SHIFT = 0.03, 0.11, 0.008  # m


def slider_crank(length="m", metres=1.0):
    """The slider-crank of the textbook with an offset, its lengths in a unit of so many metres."""
    text = IN_LINE.replace('length = "m"', f'length = "{length}"').replace(
        "through = [0, 0]", f"through = [0, {SHIFT}]"
    )
    for number in (CRANK, ROD, SHIFT, 0.04, 0.14):
        text = text.replace(f"[{number!r}, 0]", f"[{number / metres!r}, 0]").replace(
            f", {number!r}]", f", {number / metres!r}]"
        )
    return from_text(text)


def _textbook(time):
    """Place of the piston and angle of the rod, to 50 digits, by the law of sines."""
    phi = mp.mpf(0.4) + 21 * time + 35 * time**2
    angle = mp.asin((mp.mpf(SHIFT) - mp.mpf(CRANK) * mp.sin(phi)) / mp.mpf(ROD))
    return mp.mpf(CRANK) * mp.cos(phi) + mp.mpf(ROD) * mp.cos(angle), angle


def test_a_slider_crank_moves_as_the_textbook_says_whatever_the_unit_of_its_file():
    place = [lambda t: _textbook(t)[0], lambda t: _textbook(t)[1]]
    with mp.workdps(50):
        exact = [[[float(mp.diff(one, mp.mpf(float(t)), k)) for t in TIMES] for k in range(3)] for one in place]
        far = mp.sqrt(mp.mpf(CRANK + ROD) ** 2 - mp.mpf(SHIFT) ** 2)
    (x, vx, ax), (angle, omega, alpha) = exact
    expected = {
        **{"point:B:x": x, "point:B:vx": vx, "point:B:ax": ax, "point:B:y": [SHIFT] * len(TIMES)},
        **{"S": float(far) - np.array(x), "v": -np.array(vx), "a": -np.array(ax)},
        **{"link:rod:angle": angle, "link:rod:omega": omega, "link:rod:alpha": alpha},
        "phi": 0.4 + 21 * TIMES + 35 * TIMES**2,
        "transmission_angle:rod + piston (RRP)": np.pi / 2 - np.abs(angle),
    }
    for sample in (slider_crank(), slider_crank("in", 0.0254), slider_crank("mm", 1e-3)):
        truth = Case(sample, MOTION).at(TIMES)
        for name, values in expected.items():
            close = FIFTY_DIGITS * np.max(np.abs(values))
            assert signal(truth, name) == pytest.approx(np.asarray(values), rel=0.0, abs=close), name


def test_the_piston_pushes_on_its_guide_and_the_rod_as_newton_says():
    """The sign of a joint force: on the slider, not on the ground; on the rod, the second of 'piston' and 'rod'."""
    truth = Case(slider_crank(), MOTION).at(TIMES)
    thrust = 0.3 * signal(truth, "a")  # S counts against x, so this is -m x''
    assert signal(truth, "joint_force:B:x") == pytest.approx(thrust, rel=SAME_FIGURES)
    across = signal(truth, "joint_force:B:y")
    assert signal(truth, "joint_force:piston on ground:y") == pytest.approx(across, rel=SAME_FIGURES)


def test_the_shaking_moment_is_about_the_pivot_of_the_crank():
    text = IN_LINE.replace("ground = { O = [0, 0] }", "ground = { O = [0.3, -0.2] }")
    text = text.replace("through = [0, 0]", "through = [0, -0.2]").replace("B = [0.14, 0]", "B = [0.44, -0.2]")
    truth = Case(from_text(text), MOTION).at(TIMES)
    moment = shaking(truth.sweep, truth.speed, truth.acceleration, (0.3, -0.2))[2]
    assert signal(truth, "shaking_moment") == pytest.approx(moment, rel=SAME_FIGURES)


def test_every_name_has_a_unit_and_a_value_at_every_instant():
    for name, variant in EVERY:
        case = Case(mechanism(name, variant), crank_motion("run-up", ramp_time=0.1, start_angle=0.3, speed=30.0))
        truth = case.at(np.array([0.0, 0.01]))
        assert len(set(names(case.mechanism))) == len(names(case.mechanism))
        for one in names(case.mechanism):
            assert unit(one, case.mechanism.linkage) in UNITS, one
            values = signal(truth, one)
            assert values.shape == (2,), one
            assert np.all(np.isfinite(values)), one


UNITS = {"rad", "rad/s", "rad/s²", "N m", "W", "J", "kg m²", "m", "m/s", "m/s²", "N"}


def test_without_an_output_there_is_no_s():
    assert not {"S", "v", "a"} & {*names(from_text(DOUBLE_ROCKER))}
    with_output = from_text('output = { point = "C", along = [1, 0] }\n' + DOUBLE_ROCKER)
    assert evaluate(with_output, [], ["S"])["S"].shape == (0,)


def test_a_linkage_without_mass_and_loads_has_no_torques_and_forces():
    linkage = without(slider_crank().linkage, "gravity")
    bare = {name: replace(link, mass=0.0, inertia=None) for name, link in linkage.links.items()}
    result = names(Mechanism(replace(linkage, links=bare)))
    assert not [n for n in result if n.startswith(("joint", "shaking")) or n in ("Mkr", "Peq", "Teq", "Jeq")]
    assert {"phi", "S", "point:A:x", "link:rod:alpha"} <= {*result}


def test_pieces_make_up_the_whole(monkeypatch):
    sample, angle = mechanism("rimoldi-164"), angles(17)
    motion = {"speed": angles(17, seed=2), "acceleration": angles(17, seed=3)}
    names = ("Jeq", "Mkr", "S", "a", "joint_force:A:x", "link:rod:angle")
    whole = evaluate(sample, angle, names, **motion)
    assert np.array_equal(whole["Mkr"], reduced.drive_torque(sample.sweep(angle), *motion.values()))
    monkeypatch.setattr(signals, "PIECE", 5)
    for name, values in evaluate(sample, angle, names, **motion).items():
        assert np.array_equal(values, whole[name]), name


def test_results_have_the_shape_of_the_angles_and_scalars_spread():
    result = evaluate(mechanism("juki-mf7923d"), angles(6).reshape(2, 3), ["Mkr", "S"], speed=10.0)
    assert {name: values.shape for name, values in result.items()} == {"Mkr": (2, 3), "S": (2, 3)}
    assert evaluate(mechanism("juki-mf7923d"), 0.3, ["Jeq"])["Jeq"].shape == ()


def test_an_unknown_quantity_a_missing_speed_and_a_speed_of_another_shape():
    sample = mechanism("juki-mf7923d")
    with pytest.raises(UnknownNameError, match="unknown quantity 'jeq': did you mean 'Jeq'"):
        evaluate(sample, 0.0, ["jeq"])
    with pytest.raises(LinkproofError, match="speed: expected the crank's speed in rad/s for Mkr, Teq, got none"):
        evaluate(sample, 0.0, ["Jeq", "Mkr", "Teq"])
    with pytest.raises(LinkproofError, match=r"expected a number or an array of the crank angles' shape \(3,\)"):
        evaluate(sample, angles(3), ["Teq"], speed=angles(4))
