"""Many mutants of every engine: none whose error is larger than what the limits let through passes unseen."""

from dataclasses import replace
from functools import partial
from itertools import chain

import numpy as np
import pytest

from analytic.description.crank_motion import Segment
from analytic.description.law import Law
from analytic.kinematics.mechanism import Mechanism
from comparisons.filejudge.hypotheses import of_model, of_motion
from comparisons.filejudge.simulation import ChangedMotion, Simulation
from comparisons.trials.conformance.slips import Mutant, extrapolated, in_world, misread
from comparisons.trials.conformance.trial import PLAIN, EngineTrial, NotTestedError, case, scene_of
from comparisons.trials.judging.signal_errors import readings
from engines.contract import Setting
from engines.registry import own_names
from engines.scene import LEVELS, Channel
from tests.comparisons.trials.conformance.wrong_engines import AlterableEngine
from tests.engines.closed_form import installed

FEWEST = 60  # mutants of an engine that are seen, whatever it can do
RELEASED = "torque of the drive"
# By sample the faults of the world, by their names in the list: of their number a multiple, or a part more (SI).
WORLD = {
    PLAIN: (
        *(f"{link}.{number} × 1.01" for number in ("mass", "inertia") for link in ("crank", "coupler", "rocker")),
        *("coupler.centre.x + 1e-3", "coupler.centre.y × -1"),
        *("gravity × 0", "gravity × -1", "gravity × 1.01", "gravity.x + 0.17"),
        *("coupler.B.y + 1e-4", "ground.O2.x + 1e-4", "crank.A.x + 1e-4"),
        *("speed × 1.001", "direction", "time shift + -6e-4"),
    ),
    "slider-crank": (
        *("slider.mass × 1.01", "slider.mass × 2", "slider.centre.y + 1e-3"),
        *("slider.along + 1.75e-3", "slider.through.y + 1e-4"),
    ),
    "quick return": ("A in rocker.along + 1.75e-3", "A in rocker.through.y + 1e-4", "crank.A.x + 1e-4"),
    "force": ("no forces", "the load 'forces.P' × -1", "forces.P.x × 1.01", "forces.P at B"),
    "force over the angle": ("the force is late", "the force is its mean"),
    "torque": ("no torques", "torques.rocker × -1", "torques.rocker on coupler"),
    "spring": (
        *("no springs", "springs.P.F.stiffness × 1.01", "springs.P.F.length + 1e-3", "springs.P.F.damping × 0"),
    ),
    "damper": ("no dampers", "dampers.coupler.rocker against the ground"),
    "driven slider": ("piston.along + 1.75e-3", "start angle + 1e-4"),
    "cylinder": ("start angle + 1e-4", "ground.Q.x + 1e-3"),
    "released": (f"{RELEASED} × 1.01",),
}  # fmt: skip
# Forces over the angle that an engine may apply in place of the right one, which are no faults of a file.
LAWS = {
    "the force is late": lambda law: replace(law, angles=law.angles + 0.035),
    "the force is its mean": lambda law: Law(np.mean(law.values, axis=0)),
}
WEIGHTS = {
    "the mean of its runs": lambda steps, _: np.full(len(steps), 1.0 / len(steps)),
    "its coarsest run alone": lambda steps, _: np.eye(len(steps))[int(np.argmax(steps))],
}
# Mutants that change less than the limits of MJX and MuJoCo Warp, in single precision, leave open.
SINGLE_PRECISION = (
    *(f"four-bar: {number} × 1.01" for number in ("rocker.mass", "crank.inertia", "coupler.inertia", "rocker.inertia")),
    *(f"four-bar: {place} + 1e-4" for place in ("coupler.B.y", "ground.O2.x", "crank.A.x")),
    *(
        "slider-crank: slider.through.y + 1e-4",
        "force: forces.P.x × 1.01",
    ),
    *("cylinder: start angle + 1e-4", "slider-crank: slider.mass × 1.01"),
    *(f"quick return: {place} + 1e-4" for place in ("A in rocker.through.y", "crank.A.x")),
)
UNSEEN = {"mjx": SINGLE_PRECISION, "mujoco-warp": SINGLE_PRECISION}


def planted_case(sample, key):
    """The case of a sample with a fault of ``WORLD``."""
    of = case(sample)
    name, _, times = key.partition(" × ")
    name, _, plus = name.partition(" + ")
    if name == RELEASED:
        return replace(of, drive=replace(of.drive, torque=float(times) * of.drive.torque))
    if key in LAWS:
        (force,) = of.mechanism.linkage.forces
        wrong_law = replace(of.mechanism.linkage, forces=(replace(force, force=LAWS[key](force.force)),))
        return replace(of, mechanism=Mechanism(wrong_law))
    right = Simulation(of.mechanism.linkage, of.motion)
    fault = next(each for each in chain(of_model(right), of_motion(right, None, ())) if each.name == name)
    wrong = right.with_values(fault.targets(*(float(times or 1) * n + float(plus or 0) for n in fault.start)))
    motion = in_polynomials(wrong.motion) if isinstance(wrong.motion, ChangedMotion) else of.motion
    return replace(of, mechanism=Mechanism(wrong.linkage), motion=motion)


def in_polynomials(changed):
    """A changed motion as engines take it, in polynomials of time; one that is late rests before it begins."""
    right, late = changed.motion, -changed.shift
    moved = []
    for s in right.segments:
        first, *rest = (changed.pace * c for c in s.coefficients)
        moved.append(Segment(s.start + late, min(s.end + late, right.duration), (first + changed.offset, *rest)))
    before = [Segment(0.0, late, moved[0].coefficients[:1])] if late else []
    return replace(right, segments=(*before, *moved))


def with_values(history, reading, values):
    """A history with other values (n, k) of one signal."""
    channel, name = reading.channel.value, reading.name
    before = getattr(history, channel)
    if reading.channel is Channel.JOINT_FORCE:
        force = replace(before[name], values=values.reshape(before[name].values.shape))
        return replace(history, joint_force={**before, name: force})
    whole = before.values.copy()
    place = (slice(None), reading.body_number(name), reading.columns) if reading.channel in LEVELS else slice(None)
    whole[place] = values.reshape(whole[place].shape)
    return replace(history, **{channel: replace(before, values=whole)})


def misread_mutants(trial):
    """A mutant of every slip in every signal of the plain sample; factors are 1.01."""
    history = trial.finished_history(PLAIN)
    for reading in readings(scene_of(PLAIN), history):
        for words, values in misread(reading, 1.01 * reading.values):
            wrong = with_values(history, reading, values)
            if np.max(np.abs(values - reading.values)) > 9e-3 * np.max(np.abs(reading.values)):
                yield Mutant(f"{reading.words}: {words}", lambda _, wrong=wrong: wrong)


def planted_mutants():
    for sample, keys in WORLD.items():
        for key in keys:
            wrong = partial(lambda trial, sample, key: in_world(sample, planted_case(sample, key), trial))
            yield Mutant(f"{sample}: {key}", partial(wrong, sample=sample, key=key), sample)
    for words, weigh in WEIGHTS.items():
        yield Mutant(f"best: {words}", partial(extrapolated, weigh), setting=Setting.BEST)


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["a right engine", *(name for name in own_names() if name != "direct")])
def test_no_mutant_passes_unseen(name):
    trial = EngineTrial(AlterableEngine() if name == "a right engine" else installed(name))
    seen, unseen = 0, []
    for mutant in (*planted_mutants(), *misread_mutants(trial)):
        try:
            mutant.check(trial)
            seen += 1
        except NotTestedError:
            continue
        except AssertionError as reason:
            unseen.append((mutant.name, str(reason)))
    assert [pair for pair in unseen if pair[0] not in UNSEEN.get(name, ())] == []
    assert seen >= FEWEST
