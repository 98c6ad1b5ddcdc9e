"""Every engine against the closed form, in tables: linkages, releases, methods, orders of convergence, ends of runs.

Drake, Pinocchio and MuJoCo's variants are not of ``all``: ``make nightly-engines`` runs them.
"""

import dataclasses
import gc
import math
import os
import re
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.linkage import GROUND
from comparisons.motion.case import Truth, scene
from comparisons.trials.runs.workers import LocalPool
from engines.contract import Outcome, Setting
from engines.registry import engine, own_names
from engines.scene import Channel, Free, PinJoint, Prescribed, SlotJoint
from tests.analytic.linkages import double_rocker_text, file_text, from_text, mechanism, text_of
from tests.engines.closed_form import (
    EVERYTHING,
    crank_number,
    driven,
    error_of,
    errors_of,
    history_of,
    installed,
    released,
    run_of,
    torque_error,
    true_motion,
    with_body,
)

# Of the peak, what one tuned run leaves: of torque, forces and accelerations; of places and velocities.
LIMITS = {
    "dart": (5e-5, 5e-6),
    "drake": (5e-4, 5e-4),  # rounding in slots at 6000 steps a turn; the rest is below 1e-4
    "exudyn": (1e-4, 5e-6),
    "mujoco": (1e-6, 1e-7),
    "ondsel": (1e-11, 1e-11),
    "pinocchio": (2e-6, 2e-6),  # all but carried-slider, near a toggle, is below 1e-7
    "pybullet": (1e-4, 2e-5),
    "pymunk": (5e-5, 5e-6),
    "simbody": (1e-9, 1e-9),
}
ENGINES = tuple(LIMITS)
LOADS = tuple(name for name in ENGINES if name not in ("dart", "drake", "ondsel", "pybullet"))
HOSTS = tuple(name for name in ENGINES if name != "drake")  # bodies may slide on others
KINDS = {
    "rimoldi-164": ENGINES,  # pins, and a guide on the ground
    "slotted-takeup": ENGINES,  # a mass on a pin in a slot that turns, and a damper on the crank
    "carried-slider": ("dart", "ondsel", "pinocchio", "pybullet"),  # a body that slides and turns with its host
    "moving-guides": HOSTS,  # guides on hosts that slide, turn and rest
    "ground-pin-in-slot": ENGINES,
    "scotch-yoke": ("dart", "exudyn", "pinocchio", "pybullet", "pymunk"),  # a slot in a body that does not turn
    "three-on-one-pin": ("dart", "drake", "exudyn", "pinocchio", "pybullet", "simbody"),
    "force-over-angle": LOADS,
    "spring-and-damper": tuple(name for name in LOADS if name != "pinocchio"),
}
RUN_UP = crank_motion("run-up", ramp_time=0.06, hold_time=0.02, start_angle=0.3)
QUINTIC = crank_motion("run-up-quintic", ramp_time=0.06, hold_time=0.01, start_angle=0.3)
STEADY = crank_motion("constant-speed", ramp_time=0.06, hold_time=0.0, start_angle=0.3)
USUAL = ("moving-guides", "ground-pin-in-slot", "force-over-angle")  # the catalogue's are in tests/test_limits_hold.py
LINEAR_ORDERS = ("position", "velocity", "angular position", "angular velocity")


@pytest.mark.parametrize(
    ("linkage", "name"),
    [
        pytest.param(linkage, name, marks=() if linkage in USUAL else pytest.mark.nightly)
        for linkage in KINDS
        for name in KINDS[linkage]
    ],
)
def test_motion_torque_and_every_joint_force_are_those_of_the_closed_form(linkage, name):
    motion = QUINTIC if name == "drake" else RUN_UP
    errors = errors_of(run_of(installed(name), mechanism(linkage), motion, Setting.TUNED), mechanism(linkage), motion)
    limits = {key: LIMITS[name][key in LINEAR_ORDERS] for key in errors}
    assert {key: error for key, error in errors.items() if not error < limits[key]} == {}


@pytest.mark.parametrize("name", ["dart", "exudyn", "pybullet", "pymunk"])
def test_best_is_better_than_tuned_in_a_run_up_turned_backwards(name):
    motion = crank_motion("run-up-quintic", ramp_time=0.06, hold_time=0.02, start_angle=0.3, clockwise=True)
    linkage = mechanism("juki-mf7923d")
    tuned, best = (errors_of(run_of(installed(name), linkage, motion, s), linkage, motion) for s in list(Setting)[1:])
    assert max(best.values()) < 1e-6
    assert max(best.values()) < 0.1 * max(tuned.values())


@pytest.mark.parametrize(
    ("name", "channel", "least", "most"),
    [
        ("dart", "torque", 0.1, math.inf),  # a hundredth of a gap is closed in a step
        ("drake", "torque", 0.1, math.inf),  # ports as shipped, and a drive a step late
        ("exudyn", "torque", 1e-4, 1e-2),
        ("pymunk", "acceleration", 1e-2, math.inf),
        ("pinocchio", "torque", 1e-2, math.inf),
        ("mujoco", "torque", 0.1, math.inf),  # its own stiffness gives way by more than a tenth
        ("pybullet", "torque", 0.1, math.inf),  # a step closes a fifth of what has opened, and of the drive's lag
    ],
)
def test_a_naive_run_is_as_rough_as_a_newcomers(name, channel, least, most):
    linkage = mechanism("juki-mf7923d")
    long = crank_motion("run-up-quintic", ramp_time=0.15, hold_time=0.03, start_angle=0.3)
    motion = {"drake": QUINTIC, "pinocchio": RUN_UP}.get(name, long)
    history = run_of(installed(name), linkage, motion, Setting.NAIVE)
    if channel == "torque":
        assert least < torque_error(history, linkage, motion) < most
    else:
        signal = history.acceleration
        assert least < error_of(signal.values, true_motion(linkage, motion, signal.time)[2]) < most


@pytest.mark.parametrize("name", ["dart", "drake", "mujoco", "ondsel", "pinocchio", "pybullet", "simbody"])
def test_a_joint_force_acts_on_the_body_that_the_scene_names_first(name):
    linkage, motion = mechanism("rimoldi-164"), crank_motion("constant-speed", ramp_time=0.02, hold_time=0.0)
    pins = driven(linkage, motion).pins
    swapped = tuple(PinJoint(p.name, p.second, p.first, p.second_anchor, p.first_anchor) for p in pins)
    given, other = (run_of(installed(name), linkage, motion, Setting.TUNED, pins=each) for each in (pins, swapped))
    same = 1e-5 if name == "drake" else 1e-6
    for pin in pins:
        assert error_of(other.joint_force[pin.name].values, -given.joint_force[pin.name].values) < same
    assert error_of(other.torque.values, given.torque.values) < same


# Numbers that are removed from a link of the double crank, and the cases that each engine supports.
TAKEN = {"coupler": ("mass", "inertia"), "crank": ("mass", "inertia"), "follower's inertia": ("inertia",)}
HELD = {
    **dict.fromkeys(("dart", "drake", "mujoco", "pinocchio", "pybullet", "pymunk"), ()),
    **dict.fromkeys(("direct", "exudyn", "ondsel"), TAKEN),
    "simbody": ("crank", "follower's inertia"),  # a mass off its pin has a moment about it
}


def lightened(case):
    """The four-bar without the masses or inertias of one link."""
    link, keys = case.partition("'")[0], "|".join(TAKEN[case])
    head, mark, tail = text_of("double-crank").partition(f"[links.{link}]")
    own, bracket, rest = tail.partition("\n[")
    to = "inertia = 0" if TAKEN[case] == ("inertia",) else ""
    return from_text(head + mark + re.sub(rf"(?m)^({keys}) .*$", to, own) + bracket + rest)


@pytest.mark.parametrize("case", TAKEN)
@pytest.mark.parametrize("name", HELD)
def test_an_engine_is_right_without_a_mass_or_says_which_it_cannot_hold(name, case):
    adapter, linkage = installed(name), lightened(case)
    motion = crank_motion("run-up-quintic", ramp_time=0.06, hold_time=0.02)
    if case in HELD[name]:
        history = run_of(adapter, linkage, motion, Setting.TUNED)
        assert max(errors_of(history, linkage, motion).values()) < 3e-5  # the coarsest engine's error with all masses
    else:
        run = adapter.run(driven(linkage, motion), Setting.TUNED)
        assert run.outcome is Outcome.UNSUPPORTED
        assert f"'{case.partition(chr(39))[0]}'" in run.reason


# -- a crank that is let go --------------------------------------------------------------------------------------------

RELEASES = {  # torque, N m, angle at the start, rad, and duration, s
    "juki-mf7923d": (0.01, 0.4, 0.4),
    "spring-and-damper": (0.0, 0.4, 0.03),
    "force-over-angle": (0.5, 0.4, 0.04),
    "slotted-takeup": (0.025, math.radians(269.18), 0.5),
}
FREE_ANGLE = {"direct": 1e-10, "exudyn": 3e-5, "mujoco": 1e-7, "pymunk": 1e-6, "simbody": 1e-6}  # rad at the end
FREE_BEST = {"exudyn": 2e-8, "pymunk": 2e-8}
SLOWLY_RELEASED = [("pymunk", "spring-and-damper"), ("pymunk", "force-over-angle")]  # each of many steps calls back
NOT_RELEASED = {("simbody", "force-over-angle"), *SLOWLY_RELEASED}


@pytest.mark.parametrize(
    ("name", "linkage", "setting"),
    [
        *((name, linkage, Setting.TUNED) for name in FREE_ANGLE for linkage in RELEASES
          if (name, linkage) not in NOT_RELEASED and (linkage != "slotted-takeup" or name == "exudyn")),
        *(pytest.param(*each, Setting.TUNED, marks=pytest.mark.nightly) for each in SLOWLY_RELEASED),
        *(pytest.param(name, "force-over-angle", Setting.BEST, marks=pytest.mark.nightly) for name in FREE_BEST),
    ],
)  # fmt: skip
def test_a_free_crank_moves_as_the_equation_of_motion_says(name, linkage, setting):
    model, motion = released(mechanism(linkage), *RELEASES[linkage])
    history = history_of(installed(name), model, setting)
    time, limit = history.position.time, FREE_ANGLE if setting is Setting.TUNED else FREE_BEST
    assert np.ptp(motion.angle(time)) > 0.1  # it does move
    assert np.abs(history.position.values[:, crank_number(model), 2] - motion.angle(time)).max() < limit[name]
    assert name == "direct" or history.torque is None  # it is given


# -- ways of stepping --------------------------------------------------------------------------------------------------

BRIEF = crank_motion("run-up", ramp_time=0.01, hold_time=0.005)
STEP = 2e-4


@pytest.mark.parametrize("name", ["direct", *ENGINES])
def test_every_method_gives_a_finite_history_in_steps_that_it_counts(name):
    adapter, model = installed(name), driven(mechanism("juki-mf7923d"), BRIEF)
    methods = adapter.methods(model)
    assert len({method.name for method in methods}) == len(methods)
    for method in methods:
        coarse, run = (adapter.run_method(model, method, step) for step in (2.0 * STEP, STEP))
        assert run.outcome is Outcome.FINISHED, run.reason
        assert run.details["method"] == method.name
        assert 0 < coarse.steps < run.steps
        assert len(run.passes) == (0 if name == "direct" else method.runs)
        assert max(run.passes, default=0.0) <= STEP * (1.0 + 1e-9)
        for key, signal in run.history.signals.items():
            assert np.all(np.isfinite(signal.values)), key
            assert 0.0 < np.diff(signal.time).min() < np.diff(signal.time).max() < 4.5 * STEP  # none near a jump
            assert abs(signal.time[-1] - BRIEF.duration) < 2.0 * STEP


@pytest.mark.parametrize(
    ("name", "method", "order", "steps", "effort"),
    [
        ("dart", "centred", 2, (5e-4, 2.5e-4), None),
        ("dart", "centred x2", 3, (5e-4, 2.5e-4), None),
        ("exudyn", "trapezoidal", 2, (1e-3, 5e-4), 1e-13),
        ("exudyn", "trapezoidal x2", 4, (1e-3, 5e-4), 1e-13),
        ("exudyn", "trapezoidal x3", 6, (2.4e-3, 1.2e-3), 1e-13),
        ("pybullet", "centred", 2, (1.2e-3, 6e-4), None),
        ("pybullet", "centred x2", 3, (1.2e-3, 6e-4), None),
        ("pymunk", "centred", 2, (1.2e-3, 6e-4), 200),
        ("pymunk", "centred x2", 3, (1.2e-3, 6e-4), 200),
    ],
)
def test_the_error_falls_by_the_order_of_the_method(name, method, order, steps, effort):
    adapter, linkage = installed(name), mechanism("rimoldi-164")
    motion = crank_motion("constant-speed", ramp_time=0.06, hold_time=0.0, start_angle=0.3)
    model = driven(linkage, motion, channels=frozenset({Channel.TORQUE}))
    chosen = next(each for each in adapter.methods(model) if each.name == method)
    runs = [adapter.run_method(model, dataclasses.replace(chosen, effort=effort), step) for step in steps]
    errors = [torque_error(run.history, linkage, motion, after=0.02) for run in runs]  # what the start leaves is gone
    assert order - 0.3 < math.log(errors[0] / errors[1]) / math.log(steps[0] / steps[1]) < order + 1.3


def _divided(*ratios):
    """Changes of a recipe that divide its step."""
    return [{"ratios": (ratio,)} for ratio in ratios]


@pytest.mark.parametrize(
    ("name", "linkage", "motion", "recipes", "factor"),
    [
        ("dart", "slotted-takeup", QUINTIC, _divided(10, 20), 4.0),
        ("dart", "carried-slider", QUINTIC, _divided(10, 20), 4.0),
        ("drake", "fork-takeup", QUINTIC, _divided(4, 8), 4.0),
        ("pinocchio", "fork-takeup", RUN_UP, _divided(2, 4), 16.0),
        ("pybullet", "fork-takeup", STEADY, _divided(3, 9), 9.0),
    ],
)
def test_every_read_out_belongs_to_its_instant(name, linkage, motion, recipes, factor):
    """The error falls by a power of the step; a torque, force or speed of half a step away would fall as the step."""
    adapter, linkage, errors = installed(name), mechanism(linkage), []
    recipe = adapter.settings[Prescribed][Setting.TUNED]
    for changes in recipes:
        adapter.settings = {Prescribed: {Setting.TUNED: dataclasses.replace(recipe, **changes)}}
        errors.append(errors_of(run_of(adapter, linkage, motion, Setting.TUNED), linkage, motion))
    falls = {key: errors[0][key] / errors[1][key] for key in errors[0]}
    assert falls == {key: pytest.approx(factor, rel=0.2 if name == "drake" else 0.1) for key in falls}


def test_mujocos_forces_are_read_at_the_state_and_not_a_step_away_from_it():
    """The error falls with the fourth power of the step; forces of another instant would make it the first."""
    adapter, linkage = installed("mujoco"), mechanism("fork-takeup")
    motion, errors = crank_motion("constant-speed", ramp_time=0.06, hold_time=0.0), []
    for ratio in (1, 2):
        recipe = dataclasses.replace(adapter.settings[Prescribed][Setting.TUNED], steps_per_turn=100, ratios=(ratio,))
        adapter.settings = {Prescribed: {Setting.TUNED: recipe}}
        errors.append(torque_error(run_of(adapter, linkage, motion, Setting.TUNED), linkage, motion))
    assert 12.0 < errors[0] / errors[1] < 20.0


@pytest.mark.nightly
@pytest.mark.parametrize(("name", "turns"), [("exudyn", 50), ("pymunk", 200)])
def test_the_last_of_many_turns_is_as_good_as_the_first(name, turns):
    linkage, motion = mechanism("juki-mf7923d"), crank_motion("constant-speed", ramp_time=0.06 * turns, hold_time=0.0)
    history = run_of(installed(name), linkage, motion, Setting.TUNED, channels=frozenset({Channel.TORQUE}))
    signal = history.torque
    errors = np.abs(signal.values - Truth(linkage, motion, signal.time).torque)
    first, *_, last = np.array_split(errors, turns)
    assert last.max() < 3.0 * first.max()


# -- how runs end ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("direct", "locks, or passes a change point, at a crank angle of 74.41°"),
        ("exudyn", "exudyn stopped at 0.0199"),
        ("mujoco", "unstable"),
        ("ondsel", "solved 7 of 33 frames"),
        ("simbody", "Unable to advance time"),
    ],
)
def test_a_linkage_that_locks_is_diverged_in_the_engines_own_words(name, words):
    """Its crank reaches 74.4°."""
    motion = crank_motion("constant-speed", speed=20.0, ramp_time=0.1, hold_time=0.0, start_angle=0.9)
    run = installed(name).run(driven(from_text(double_rocker_text()), motion), Setting.TUNED)
    assert (run.outcome, run.history) == (Outcome.DIVERGED, None)
    assert words in run.reason


def _loose(model):
    return dataclasses.replace(model, pins=tuple(pin for pin in model.pins if GROUND in (pin.first, pin.second)))


def _joint_twice(model):
    return dataclasses.replace(model, pins=(*model.pins, dataclasses.replace(model.pins[0], name="again")))


def _slider_twice(model):
    bar = next(body for body in model.bodies if body.name == model.sliders[0].body)
    again = dataclasses.replace(model.sliders[0], name="second guide", anchor=(0.0, 0.0), through=bar.position)
    return dataclasses.replace(model, sliders=(*model.sliders, again))


def _flywheel_without_mass(model):
    return with_body(model, model.crank, mass=0.0)


def _on_slots_alone(model):
    pins = tuple(pin for pin in model.pins if "rod" not in (pin.first, pin.second))
    slot = SlotJoint("slot", "rod", (0.0, 0.0), "crank", (0.0, 0.0), (1.0, 0.0))
    return dataclasses.replace(model, pins=pins, slots=(slot,))


def _free(model):
    return dataclasses.replace(model, drive=Free(0.1, 1.0))


def _damper_elsewhere(model):
    return dataclasses.replace(model, dampers=(dataclasses.replace(model.dampers[0], first="coupler"),))


@pytest.mark.parametrize(
    ("name", "linkage", "change", "words"),
    [
        ("exudyn", "juki-mf7923d", _joint_twice, "repeat 2"),
        ("exudyn", "juki-mf7923d", _loose, "degrees of freedom"),
        ("pymunk", "rimoldi-164", _loose, "degrees of freedom"),
        ("mujoco", "juki-mf7923d", _slider_twice, "second guide"),
        ("simbody", "force-over-angle", _slider_twice, "no constraint for 'second guide'"),
        ("simbody", "force-over-angle", _on_slots_alone, "only slots hold 'rod'"),
        ("simbody", "force-over-angle", _free, "changes with its angle"),
        # OpenSim would drop its inertia.
        ("simbody", "juki-mf7923d", _flywheel_without_mass, "takes no inertia of a body without mass, as 'crank' has"),
        ("ondsel", "slotted-takeup", _damper_elsewhere, "between the crank"),
    ],
)
def test_a_scene_that_an_engine_cannot_hold_is_unsupported_in_one_sentence(name, linkage, change, words, monkeypatch):
    if name == "simbody":  # what its own model refuses, not what all engines do
        monkeypatch.setattr("engines.stepping.stepped_engine.data_obstacle", lambda scene, massless: None)
    adapter, model = installed(name), scene(mechanism(linkage), Prescribed(crank_motion()), EVERYTHING)
    run = adapter.run(change(model), Setting.TUNED)
    assert (run.outcome, run.history) == (Outcome.UNSUPPORTED, None)
    assert words in run.reason


FIRST, MORE = 40, 100
ALLOWED = 20_000  # bytes a run; what the interpreter and the allocator keep comes to less


def left_by(name):
    """Bytes that a run leaves resident, on average over MORE runs after the FIRST: the least of four such averages.

    What runs leave adds up in each; the allocator takes a new stretch of memory now and then, in some of them.
    """
    motion = crank_motion("run-up-quintic", ramp_time=0.002, hold_time=0.001)
    adapter, model = engine(name), driven(mechanism("juki-mf7923d"), motion)
    method = adapter.methods(model)[:2][-1]
    sizes = []
    for count in (FIRST, MORE, MORE, MORE, MORE):
        for _ in range(count):
            assert adapter.run_method(model, method, 2.5e-4).history is not None
        gc.collect()
        sizes.append(int(Path("/proc/self/statm").read_text().split()[1]) * 4096)
    return min(after - before for before, after in pairwise(sizes)) / MORE


@pytest.mark.nightly
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
@pytest.mark.parametrize("name", own_names())
def test_a_process_does_not_grow_with_the_runs_it_has_made(name):
    installed(name)
    ((_, left),) = LocalPool(1).run(left_by, [(name,)])
    assert left < ALLOWED


# -- what single engines have of their own -----------------------------------------------------------------------------


def test_a_run_with_what_dart_ships_leaves_nothing_to_the_next():
    """A constraint's error reduction holds for all of the process."""

    def torque(setting, **recipe):
        engine = installed("dart")
        engine.settings = {Prescribed: {setting: dataclasses.replace(engine.settings[Prescribed][setting], **recipe)}}
        return run_of(engine, mechanism("fork-takeup"), QUINTIC, setting).torque.values

    ways = 2 * [{"setting": Setting.TUNED, "ratios": (5,)}, {"setting": Setting.NAIVE}]
    first, naive, again, repeated = (torque(**given) for given in ways)
    np.testing.assert_array_equal(first, again)
    np.testing.assert_array_equal(naive, repeated)


def test_pybullets_first_samples_of_a_start_at_full_speed_are_as_good_as_the_others():
    linkage = mechanism("slotted-takeup")
    history = run_of(installed("pybullet"), linkage, STEADY, Setting.TUNED)
    signals = (history.position, history.acceleration, history.torque, *history.joint_force.values())
    assert [signal.time[0] for signal in signals] == [0.0] * len(signals)
    assert max(errors_of(history, linkage, STEADY).values()) < 5e-5


def test_every_solution_of_ondsel_has_a_folder_of_its_own_for_files_of_fixed_names(monkeypatch):
    adapter = installed("ondsel")
    from engines import ondsel_loop  # noqa: PLC0415 - it imports pyondsel

    before, seen = os.environ.get("TMPDIR"), []
    solve = ondsel_loop.solve_asmt

    def solved(*args, **options):
        seen.append(os.environ["TMPDIR"])
        assert Path(seen[-1]).is_dir()
        return solve(*args, **options)

    monkeypatch.setattr(ondsel_loop, "solve_asmt", solved)
    run_of(adapter, mechanism("juki-mf7923d"), crank_motion("run-up", ramp_time=0.02, hold_time=0.01), Setting.TUNED)
    assert len(set(seen)) == len(seen) > 1
    assert os.environ.get("TMPDIR") == before
    assert not any(map(os.path.exists, seen))


def test_simbodys_forces_of_a_loop_on_moving_bodies_are_those_of_the_closed_form():
    """Closed between bodies that the crank carries, where Simbody tells forces in the axes of the crank."""
    linkage = from_text(file_text("dyad-on-the-crank"))
    assert max(errors_of(run_of(installed("simbody"), linkage, RUN_UP, Setting.TUNED), linkage, RUN_UP).values()) < 1e-9


@pytest.mark.parametrize(
    ("name", "motion", "limit"),
    [
        # near-toggle: steps of this length must be divided
        ("near-toggle", RUN_UP, 1e-6),
        pytest.param(
            "rimoldi-164",
            crank_motion("run-up-quintic", speed=1e5, ramp_time=6e-4, hold_time=1e-4),
            1e-8,
            marks=pytest.mark.nightly,
        ),
    ],
)
def test_in_simbody_sharp_linkages_and_fast_cranks_follow_the_closed_form(name, motion, limit):
    linkage = mechanism(name)
    assert torque_error(run_of(installed("simbody"), linkage, motion, Setting.TUNED), linkage, motion) < limit
