"""Mutants of an engine, each with one fault: of its world, of its read-out, or of how its runs are extrapolated.

Each change is small, of the size of a slip in an adapter. Faults of the world are those that ``judge`` fits, each
planted in the sample on which it matters; misreadings are those by which a wrong channel is explained.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import CrankMotion, Segment
from analytic.kinematics.mechanism import Mechanism
from comparisons.case import Case
from comparisons.conformance.trial import (
    AT_SPEED,
    PLAIN,
    SLIDER_AT_SPEED,
    Check,
    EngineTrial,
    NotTestedError,
    case,
    judged_rows,
    scene_of,
)
from comparisons.faults.fault import ChangedMotion, Simulation
from comparisons.faults.misreadings import MISREADINGS, Misreading, plant_misreading
from comparisons.faults.ranking import model_faults
from comparisons.faults.settings import motion_settings
from comparisons.judging.signal_errors import Reading
from comparisons.runs.run_engine import run_engine
from engines.contract import History, Origin, Run, Setting
from engines.scene import Body, Channel, Free, Scene
from engines.stepping.richardson import Weigh, named_signals, weights

Array = NDArray[np.float64]
Rows = Iterable[tuple[str, bool]]

MUTANT: Final = "mutant: "
RELEASED: Final = "torque of the drive"
SLIP: Final = "gravity × 0.999"  # 9.80 for 9.81: beside the forces of inertia of a fast crank too little for its torque
# By sample the faults of the world, by their names in the list: of their number a multiple, or a part more (SI).
WORLD: Final[Mapping[str, tuple[str, ...]]] = {
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
    "force": ("no forces", "forces.P × -1", "forces.P.x × 1.01", "forces.P at B"),
    "force over the angle": ("forces.P late + 0.035", "forces.P by its mean"),
    "torque": ("no torques", "torques.rocker × -1", "torques.rocker on coupler"),
    "spring": (
        *("no springs", "springs.P.F.stiffness × 1.01", "springs.P.F.length + 1e-3", "springs.P.F.damping × 0"),
    ),
    "damper": ("no dampers", "dampers.coupler.rocker against the ground"),
    "driven slider": ("piston.along + 1.75e-3", "start angle + 1e-4"),
    "cylinder": ("start angle + 1e-4", "ground.Q.x + 1e-3"),
    "released": (f"{RELEASED} × 1.01",),
}  # fmt: skip


@dataclass(frozen=True)
class Mutant:
    """One fault: ``rows(trial)`` are the rows of an engine that has it, in a sample and a setting.

    It raises NotTestedError where the fault cannot be planted. Where a ``row`` is named, that row has to see it.
    """

    name: str
    rows: Callable[[EngineTrial], Rows]
    sample: str = PLAIN
    setting: Setting = Setting.TUNED
    row: str = ""

    def check(self, trial: EngineTrial) -> None:
        """Raise AssertionError unless the fault fails a row that the engine itself passes; the first one is enough."""
        wrong, right = self.rows(trial), trial.rows(self.sample, self.setting)
        if self.row and self.row not in right:
            raise NotTestedError(f"no row '{self.row}' is judged of {trial.engine.name}")
        with np.errstate(all="ignore"):  # a wrong motion can be any numbers
            if any(is_over and not right.get(name) for name, is_over in wrong if self.row in ("", name)):
                return
        over = ", ".join(name for name, is_over in right.items() if is_over)
        beside = f" beside {over}, which it fails without the fault too" if over else ""
        signals = vars(trial.finished_history(self.sample, self.setting)).items()
        computed = ", ".join(name for name, signal in signals if getattr(signal, "origin", None) is Origin.COMPUTED)
        cure = f"read its {computed} from the engine" if computed else "return what the engine's own model does"
        raise AssertionError(f"sample '{self.sample}': expected a row over its limit, got none{beside}; {cure}")


def planted_case(sample: str, key: str) -> Case:
    """The case of a sample with a fault of ``WORLD``."""
    of = case(sample)
    name, _, times = key.partition(" × ")
    name, _, plus = name.partition(" + ")
    if name == RELEASED:
        assert isinstance(of.drive, Free)
        return replace(of, drive=replace(of.drive, torque=float(times) * of.drive.torque))
    right = Simulation(of.mechanism.linkage, of.motion)
    faults = chain(model_faults(right), motion_settings(of.motion))
    fault = next(fault for fault in faults if fault.name == name)
    wrong = fault.plant(right, *(float(times or 1) * number + float(plus or 0) for number in fault.start))
    motion = _in_polynomials(wrong.motion) if isinstance(wrong.motion, ChangedMotion) else of.motion
    return replace(of, mechanism=Mechanism(wrong.linkage), motion=motion)


def _in_polynomials(changed: ChangedMotion) -> CrankMotion:
    """A changed motion as engines take it, in polynomials of time; one that is late rests before it begins."""
    right, late = changed.motion, -changed.shift
    assert isinstance(right, CrankMotion)
    moved = []
    for s in right.segments:
        first, *rest = (changed.pace * c for c in s.coefficients)
        moved.append(Segment(s.start + late, min(s.end + late, right.duration), (first + changed.offset, *rest)))
    before = [Segment(0.0, late, moved[0].coefficients[:1])] if late else []
    return replace(right, segments=(*before, *moved))


def _rows_in_world(sample: str, key: str, trial: EngineTrial) -> Rows:
    """Judged rows of an engine whose worlds are built with a fault."""
    trial.finished_history(sample)
    wrong = planted_case(sample, key)
    run = _run_with(trial, sample, Setting.TUNED, "altered", lambda scene: wrong.scene(scene.channels))
    return _rows_of(trial, sample, Setting.TUNED, run)


def _run_with(trial: EngineTrial, sample: str, setting: Setting, method: str, other: Callable[..., Any]) -> Run:
    """A run of an engine with another method; raises NotTestedError where it has no such method."""
    if not hasattr(trial.engine, method):
        raise NotTestedError(f"{trial.engine.name} has no '{method}' to replace, as a SteppedEngine has")
    changed: Any = copy.copy(trial.engine)
    setattr(changed, method, other)
    return run_engine(changed, scene_of(sample), setting)


def _rows_of(trial: EngineTrial, sample: str, setting: Setting, run: Run) -> Rows:
    """Judged rows of a run; one that did not finish has a single row, which failed."""
    if run.history is None:
        return [(run.outcome.value, True)]
    return judged_rows(sample, setting, trial.engine.name, run.history)


# Wrong start velocities of bodies, by fault: how much of the right ones, and of a step's change, they have.
STARTS: Final[Mapping[str, tuple[float, float]]] = {
    "starts at rest": (0.0, 0.0),
    "start velocities of the middle of the first step": (1.0, 0.5),
}
SAME: Final = 1e-7  # of a signal's peak, a hundredth of the tightest limit: runs that differ less are the same


def _rows_started(sample: str, kept: float, moved: float, trial: EngineTrial) -> Rows:
    """Judged rows of an engine whose bodies have other start velocities.

    Raises NotTestedError where these change nothing, as in an engine that takes them from its joints and drive.
    """
    right = trial.finished_history(sample)
    step = moved * min(trial.run(sample).passes, default=0.0)

    def altered(scene: Scene) -> Scene:
        return replace(scene, bodies=tuple(_with_velocity(body, kept, step) for body in scene.bodies))

    run = _run_with(trial, sample, Setting.TUNED, "altered", altered)
    if run.history is not None and _is_same(right, run.history):
        raise NotTestedError(f"start velocities change nothing in a run of {trial.engine.name}")
    return _rows_of(trial, sample, Setting.TUNED, run)


def _with_velocity(body: Body, kept: float, step: float) -> Body:
    """A body with a share of its start velocities, and what its accelerations add to them in a time, s."""
    x, y, turn = (
        kept * rate + step * change
        for rate, change in zip(
            (*body.velocity, body.angular_velocity), (*body.acceleration, body.angular_acceleration), strict=True
        )
    )
    return replace(body, velocity=(x, y), angular_velocity=turn)


def _is_same(history: History, other: History) -> bool:
    """Whether two histories have the same values, to SAME of every signal's peak."""
    pairs = zip(named_signals(history), named_signals(other), strict=True)
    return all(
        a.values.shape == b.values.shape and np.all(np.abs(a.values - b.values) <= SAME * np.max(np.abs(a.values)))
        for (_, a), (_, b) in pairs
    )


def _first_sample_late(reading: Reading, _: str) -> Array:
    """The first sample that of half a step later, as of a rule that has its velocities or forces between its steps."""
    time = reading.time.copy()
    time[0] += 0.5 * (time[1] - time[0])
    return reading.values_at(time)


LATE: Final = Misreading(lambda _: "its first sample is that of half a step later", _first_sample_late)


def _rows_misread(
    sample: str, channel: Channel, misreading: Misreading, number: float | None, trial: EngineTrial
) -> Rows:
    """Judged rows of the engine's own run of a sample with a channel misread."""
    if channel not in trial.engine.abilities.readouts:
        raise NotTestedError(f"{trial.engine.name} offers no {channel.value}")
    right = trial.finished_history(sample)
    wrong = plant_misreading(right, scene_of(sample), channel, misreading, number)
    if wrong is right:
        raise NotTestedError(f"{trial.engine.name} provides only magnitudes of joint forces")
    return judged_rows(sample, Setting.TUNED, trial.engine.name, wrong)


def _rows_extrapolated(weigh: Weigh, trial: EngineTrial) -> Rows:
    """Judged rows of the engine's runs at several steps, combined by other weights."""
    trial.finished_history(PLAIN, Setting.BEST)
    if len(trial.run(PLAIN, Setting.BEST).passes) < 2:
        raise NotTestedError(f"'{Setting.BEST}' of {trial.engine.name} is one run")
    run = _run_with(trial, PLAIN, Setting.BEST, "weights", weigh)
    return _rows_of(trial, PLAIN, Setting.BEST, run)


def _slightly_wrong_weights(steps: Sequence[float], orders: Sequence[int]) -> Array:
    right = weights(steps, orders)
    right[0] += 1e-6
    return right


# Wrong weights of an extrapolation's runs by their steps and orders.
WEIGHTS: Final[Mapping[str, Weigh]] = {
    "the mean of its runs": lambda steps, _: np.full(len(steps), 1.0 / len(steps)),
    "its coarsest run alone": lambda steps, _: np.eye(len(steps))[int(np.argmax(steps))],
    "a weight of its runs off by 1e-6": _slightly_wrong_weights,
}


def _name(channel: Channel) -> str:
    return channel.value.replace("_", " ")


def _mutants() -> Iterator[Mutant]:
    for sample, keys in WORLD.items():
        for key in keys:
            yield Mutant(f"{sample}: {key}", partial(_rows_in_world, sample, key), sample)
    yield Mutant(f"{AT_SPEED}: {SLIP}", partial(_rows_in_world, AT_SPEED, SLIP), AT_SPEED, row="weight_on_frame")
    for sample in (AT_SPEED, SLIDER_AT_SPEED):
        for words, shares in STARTS.items():
            yield Mutant(f"{sample}: {words}", partial(_rows_started, sample, *shares), sample)
    for channel in Channel:
        for misreading in (each for each in MISREADINGS if channel in each.channels):
            for number in misreading.numbers or (None,):
                words = misreading.words("…" if number is None else number)
                rows = partial(_rows_misread, PLAIN, channel, misreading, number)
                yield Mutant(f"{_name(channel)}: {words}", rows)
        yield Mutant(
            f"{_name(channel)}: {LATE.words('')}", partial(_rows_misread, AT_SPEED, channel, LATE, None), AT_SPEED
        )
    for words, weigh in WEIGHTS.items():
        yield Mutant(f"best: {words}", partial(_rows_extrapolated, weigh), setting=Setting.BEST)


MUTANTS: Final = tuple(_mutants())
CHECKS: Final = tuple(Check(f"{MUTANT}{mutant.name}", "fails a row", mutant.check) for mutant in MUTANTS)
