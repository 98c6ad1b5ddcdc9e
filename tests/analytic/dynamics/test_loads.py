"""Loads over the stroke, in one direction, fixed in a link, between two bodies and over two turns of the crank."""

import math
from dataclasses import replace

import numpy as np
import pytest

from analytic.description.changes import with_numbers
from analytic.description.crank_motion import crank_motion
from analytic.description.law import FULL_TURN, Law
from analytic.description.loading import parse
from analytic.designs.derivatives import differences, figure_gradients, signal_gradients
from analytic.designs.figures import Figure, Reduction
from analytic.designs.results import design_figures
from analytic.dynamics.reduced import equation_of_motion, potential_energy
from analytic.errors import DescriptionError, LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.numerics.refine import grid
from analytic.numerics.roots import root
from analytic.signals import evaluate
from comparisons.motion.case import Case
from engines.contract import Setting
from engines.direct_adapter.adapter import DirectEngine
from engines.mechanics.start_check import ability_obstacle
from engines.registry import engine
from engines.scene import Channel
from tests.analytic.fifty_digits import errors_at
from tests.analytic.linkages import four_bar, from_text, text_of

PHI = np.linspace(0.1, 0.1 + 4.0 * np.pi, 101)  # of two turns
SPEED = 7.0

PRESS, _, _LOADS = text_of("laden-press").partition("[[")
EVERY_LOAD = f"[[{_LOADS}"


def mechanism(loads):
    return Mechanism(parse(PRESS + loads, "press", "press.toml"))


@pytest.mark.parametrize("when", ["advance", "return"])
def test_torque_and_forces_are_those_of_fifty_digits(when):
    for speed, number in ((SPEED, 12), (-SPEED, 70)):
        sample = mechanism(EVERY_LOAD.replace('"advance"', f'"{when}"'))
        assert max(errors_at(sample, PHI, number, speed).values()) < 1e-13


def test_a_load_over_the_stroke_is_that_over_the_crank_angle_which_describes_the_same():
    """A table over S that is smooth over the whole stroke, sampled over φ."""
    over_s = mechanism(EVERY_LOAD.replace("when", "#").replace("95", "120").partition('[[forces]]\npoint = "A"')[0])
    knots = np.arange(20_000) * (2.0 * np.pi / 20_000)
    load = over_s.linkage.forces[0]
    values = load.force(evaluate(over_s, knots, ["S"])["S"]).T
    over_phi = Mechanism(replace(over_s.linkage, forces=(replace(load, force=Law(values, knots)),)))
    places = knots[::57] + 1e-4
    names = ["Mkr", "joint_force:O:x", "shaking_force:x"]
    found, same = (evaluate(each, places, names, speed=SPEED) for each in (over_s, over_phi))
    for name in names:
        assert found[name] == pytest.approx(same[name], rel=0.0, abs=1e-13 * np.max(np.abs(same[name])))


def test_an_inner_load_shakes_no_frame_and_does_the_same_work():
    """A cylinder's pressure on piston and head: the frame holds the bearings' forces against that of the pressure."""
    load = "[[forces]]\npoint = 'D'\nlink = 'ram'\nforce = [-900, 0]\n"
    outside, inside, bare = map(mechanism, (load, load.replace("link = 'ram'", "between = ['ram', 'ground']"), ""))
    names = ["Mkr", "joint_force:O:x", "shaking_force:x"]
    found, same, none = (evaluate(each, PHI, names, speed=SPEED) for each in (inside, outside, bare))
    assert all(np.array_equal(found[name], same[name]) for name in names[:2])
    assert found["shaking_force:x"] == pytest.approx(none["shaking_force:x"], rel=1e-12)
    assert same["shaking_force:x"] == pytest.approx(none["shaking_force:x"] - 900.0, rel=1e-12)


@pytest.mark.parametrize("path", ["numpy", pytest.param("compiled", marks=pytest.mark.nightly)])
def test_figures_of_designs_are_those_of_each_design(path):
    sample, places = mechanism(EVERY_LOAD), np.linspace(0.0, 4.0 * np.pi, 720, endpoint=False)
    numbers = {"rod.D.x": [0.2, 0.21], "crank.A.x": [0.05, 0.055]}
    peak = Figure("Mkr", Reduction.PEAK)
    found = design_figures(sample, numbers, [peak], places, speed=SPEED, period=2.0 * FULL_TURN, path=path)[0]
    for number, value in enumerate(found):
        design = sample.redesigned(with_numbers(sample.linkage, {n: v[number] for n, v in numbers.items()}))
        torque = evaluate(design, places, ["Mkr"], speed=SPEED)["Mkr"]
        assert value == pytest.approx(np.max(np.abs(torque)), rel=1e-13)


def test_gradients_are_exact():
    """Lengths move the dead centre from which S counts, and so the load."""
    sample, speed = mechanism(EVERY_LOAD), SPEED
    point = {"rod.D.x": 0.2, "crank.A.x": 0.05, "ram.through.y": 0.01, "forces.D.2.x": 400.0}

    def torque(numbers):
        design = sample.redesigned(with_numbers(sample.linkage, numbers))
        return evaluate(design, PHI[::9], ["Mkr"], speed=speed)["Mkr"][None]

    values, slopes = signal_gradients(sample, point, ["Mkr"], PHI[::9], speed=speed)
    known, near, _ = differences(torque, point, {name: 1e-3 * value for name, value in point.items()})
    assert values == pytest.approx(known, rel=1e-12)
    for k in range(len(point)):
        assert slopes[0, k] == pytest.approx(near[0, k], rel=0.0, abs=1e-6 * np.max(np.abs(near[0, k])))


def test_a_peak_at_a_corner_of_a_load_over_the_stroke_moves_with_the_corner():
    """The peak in the first half of a turn is where S is 50 mm, whatever the lengths."""
    table = "travel = [0, 40, 50, 120]\nforce = [[0, 0], [0, 0], [9000, 0], [0, 0]]\ninterpolation = 'linear'\n"
    sample = mechanism(f"[[forces]]\npoint = 'D'\nlink = 'ram'\nover = 'S'\nwhen = 'advance'\n{table}")
    point = {"rod.D.x": 0.21, "crank.A.x": 0.055, "ram.through.y": 0.02}

    def torque_at_corner(numbers):
        design = sample.redesigned(with_numbers(sample.linkage, numbers))
        corner = root(lambda phi: design.zero_of_s() - float(design.sweep(np.asarray(phi)).output()) - 0.05, 0.5, 2.5)
        return evaluate(design, np.array([corner]), ["Mkr"], speed=SPEED)["Mkr"]

    figures = [Figure("Mkr", Reduction.PEAK)]
    values, slopes = figure_gradients(sample, point, figures, grid(360), speed=SPEED, period=FULL_TURN)
    known, near, _ = differences(torque_at_corner, point, {name: 1e-3 * value for name, value in point.items()})
    assert values == pytest.approx(np.abs(known), rel=1e-9)
    assert slopes[0] == pytest.approx(np.sign(known) * near[0], rel=1e-7)


@pytest.mark.parametrize(
    ("name", "limit"), [("direct", 1e-13), pytest.param("mujoco", 1e-8, marks=pytest.mark.nightly)]
)
def test_an_engine_finds_the_torque_of_every_load(name, limit):
    if engine(name).version() is None:
        pytest.skip(f"{name} is not installed")
    motion = crank_motion("run-up-quintic", ramp_time=0.3, hold_time=0.6, start_angle=0.1)
    case = Case(mechanism(EVERY_LOAD), motion)
    torque = engine(name).run(case.scene(frozenset(Channel)), Setting.TUNED).history.torque
    time = torque.time
    true = evaluate(case.mechanism, motion.angle(time), ["Mkr"], speed=motion.speed(time),
                    acceleration=motion.acceleration(time))["Mkr"]  # fmt: skip
    assert np.max(np.abs(torque.values - true)) <= limit * np.max(np.abs(true))


def test_an_engine_without_such_loads_says_so():
    case = Case(mechanism(EVERY_LOAD.partition("[[torques]]")[0]), crank_motion("constant-speed"))
    model = case.scene(frozenset(Channel))
    able = replace(engine("direct").abilities, load_states=False)
    words = {
        "travel": "it takes no load that depends on the output's travel or direction, as applied force on 'ram' does",
        "rod": "it takes no force that turns with a body, as applied force on 'rod' does with 'rod'",
        "crank": "it takes no force between two bodies, as applied force on 'rod' has from 'crank'",
    }
    for key, sentence in words.items():
        load = next(f for f in model.forces if key in (f.frame, f.reaction, "travel" if f.force.over == "S" else ""))
        assert ability_obstacle(replace(model, forces=(load,)), able) == sentence
    assert ability_obstacle(model, engine("direct").abilities) is None


def test_a_load_that_nothing_decides_is_refused():
    with pytest.raises(DescriptionError, match="over: expected an output that a turning crank moves"):
        parse((PRESS + EVERY_LOAD).replace("output", "#"), "press", "press.toml")
    with pytest.raises(LinkproofError, match="expected loads that depend on the position alone, got one with when"):
        equation_of_motion(mechanism(EVERY_LOAD))
    swinging = mechanism(EVERY_LOAD).linkage
    longer = with_numbers(swinging, {"crank.A.x": 0.3})
    with pytest.raises(LinkproofError, match="a load over S counts from the top dead centre"):
        evaluate(Mechanism(longer), [0.0], ["Mkr"], speed=SPEED)


# A torsion spring between two bodies: by its energy, and its angles by the law of cosines.


GROUND, CRANK, COUPLER, ROCKER = LENGTHS = 0.06, 0.02, 0.06, 0.045  # m
STIFFNESS, FREE = 0.8, 0.3  # N m/rad, rad
STEP = 1e-4  # rad, of the differences


def sprung(stiffness, *between):
    table = f"[[torsion_springs]]\nbetween = {list(between)}\nstiffness = {stiffness}\nangle = {FREE}\n"
    return from_text(four_bar(*LENGTHS, 1.0) + table.replace("'", '"'))


def angles(phi):
    """Angles of the bodies of the four-bar, rad, by the law of cosines."""
    gap = np.hypot(GROUND - CRANK * np.cos(phi), CRANK * np.sin(phi))
    inward = np.arctan2(CRANK * np.sin(phi), GROUND - CRANK * np.cos(phi))
    near = np.arccos((gap**2 + COUPLER**2 - ROCKER**2) / (2 * gap * COUPLER))
    far = np.arccos((gap**2 + ROCKER**2 - COUPLER**2) / (2 * gap * ROCKER))
    return {"ground": 0.0 * phi, "coupler": near - inward, "rocker": math.pi - inward - far}


def energy(phi, first, second):
    turned = angles(phi)[first] - angles(phi)[second] - FREE
    return 0.5 * STIFFNESS * turned**2


@pytest.mark.parametrize("between", [("rocker", "ground"), ("ground", "coupler"), ("coupler", "rocker")])
def test_the_torque_of_a_torsion_spring_is_the_slope_of_its_energy(between):
    phi = np.linspace(0.1, 6.2, 25)
    bare, with_spring = sprung(0.0, *between), sprung(STIFFNESS, *between)
    stored = potential_energy(with_spring.sweep(phi)) - potential_energy(bare.sweep(phi))
    assert stored == pytest.approx(energy(phi, *between), rel=1e-12)
    near, far = (
        (energy(phi + step, *between) - energy(phi - step, *between)) / (2.0 * step) for step in (STEP, 2.0 * STEP)
    )
    torques = [evaluate(each, phi, ["Mkr"], speed=20.0)["Mkr"] for each in (with_spring, bare)]
    assert torques[0] - torques[1] == pytest.approx((4.0 * near - far) / 3.0, abs=1e-10)


def test_the_control_finds_the_torque_and_forces_of_a_torsion_spring():
    motion = crank_motion("run-up-quintic", speed=20.0, ramp_time=0.3, hold_time=0.3)
    case = Case(sprung(STIFFNESS, "coupler", "rocker"), motion)
    model = case.scene([Channel.TORQUE, Channel.JOINT_FORCE])
    history = DirectEngine().run(model, Setting.TUNED).history
    truth = case.at(history.torque.time)
    assert history.torque.values == pytest.approx(truth.torque, rel=1e-11, abs=1e-11 * np.max(np.abs(truth.torque)))
    for name, force in history.joint_force.items():
        expected = np.stack(truth.joint_forces[name], axis=-1)
        assert force.values == pytest.approx(expected, rel=1e-11, abs=1e-11 * np.max(np.abs(expected)))
