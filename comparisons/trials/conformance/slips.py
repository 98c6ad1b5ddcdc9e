"""Slips of an adapter: which one explains a wrong signal, and mutants, engines with a fault each that a check sees."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Final

import numpy as np

from analytic.description.law import FULL_TURN
from analytic.description.linkage import GROUND, DriverKind
from analytic.numerics.arrays import Array
from comparisons.motion.case import Case
from comparisons.trials.conformance.trial import (
    AT_SPEED,
    PLAIN,
    SAMPLES,
    SLIDER_AT_SPEED,
    EngineCheck,
    EngineTrial,
    NotTestedError,
    Sample,
    scene_of,
)
from comparisons.trials.judging.signal_errors import ANGLE, PLACE, Reading
from comparisons.trials.observed_motion import resample
from comparisons.trials.runs.run_engine import run_engine
from engines.contract import History, Origin, Setting, Signal
from engines.mechanics.states import point_acceleration, point_velocity
from engines.scene import LEVELS, Body, Channel, Scene
from engines.stepping.richardson import Weigh, weights

EXPLAINED: Final = 0.1  # of an error: what a cause may leave of it
ENDS: Final = 4  # samples at either end by which nothing is explained: shifted in time they have no values
FACTOR_ERROR: Final = 1e-3  # relative: what a known factor may be off
FACTORS: Final = {
    -1.0: "it has the wrong sign",
    1e3: "it is in mm",
    1e-3: "it is a thousandth: m taken for mm",
    360.0 / FULL_TURN: "it is in degrees",
    FULL_TURN / 360.0: "it is turned from degrees to rad twice",
}
SHIFTS: Final = (-1.0, -0.5, 0.5, 1.0)  # samples


def likeliest_misreading(right: Reading, wrong: Array) -> str:
    """The slip that leaves the least error of ``wrong`` values (n, k), in words; "" where none leaves a tenth or less.

    ``right`` reads the signal from the closed form.
    """
    left, words = min((_largest(wrong - values), words) for words, values in misread(right, wrong))
    return words if left <= EXPLAINED * _largest(wrong - right.values) else ""


def _largest(values: Array) -> float:
    """The largest magnitude of values (n, k), both ends left out unless that leaves fewer than one sample."""
    ends = min(ENDS, (len(values) - 1) // 2)
    return float(np.abs(values[ends : len(values) - ends]).max())


def misread(right: Reading, wrong: Array) -> Iterator[tuple[str, Array]]:
    """Yield every slip that may befall a signal, in words, with the values (n, k) that it makes of it.

    ``right`` reads the signal from the closed form. Of all factors the one that comes nearest to the ``wrong`` values
    (n, k) is tried.
    """
    values, channel, time = right.values, right.channel, right.time
    factor = float(np.vdot(values, wrong) / (np.vdot(values, values) or 1.0))
    yield _factor_words(factor), factor * values
    for samples in SHIFTS:
        when = "after" if samples > 0.0 else "before"
        words = f"its values are those of {abs(samples):.2g} of a sample {when} their times"
        yield words, right.values_at(time + samples * np.gradient(time))
    if channel in LEVELS and right.columns == ANGLE:
        yield from _misread_angle(right)
    if right.columns == PLACE:
        yield from _misread_vector(right)
    if channel is Channel.JOINT_FORCE:
        for joint in right.history.joint_force.keys() - {right.name}:
            yield f"it is the force of joint '{joint}'", right.channel_values(channel, joint, time)[:, right.columns]
    if channel is Channel.TORQUE and right.scene.driver_kind is not DriverKind.CYLINDER:
        yield "the crank's own inertia and weight are left out of it", _without_crank(right)


def _misread_angle(right: Reading) -> Iterator[tuple[str, Array]]:
    """Yield slips that may befall an angle or its rates, each in words with the values (n, 1) it makes."""
    values = right.values
    yield "it counts clockwise", -values
    if right.channel is Channel.POSITION:
        yield "it counts from the start", values - values[0]
        for low in (-np.pi, 0.0):
            yield "it is not unwrapped", (values - low) % FULL_TURN + low


def _misread_vector(right: Reading) -> Iterator[tuple[str, Array]]:
    """Yield slips that may befall a plane vector, each in words with the values (n, 2) it makes."""
    values = right.values
    yield "x and y are exchanged", values[:, ::-1]
    for axis, signs in (("x", (-1.0, 1.0)), ("y", (1.0, -1.0))):
        yield f"{axis} is mirrored", values * signs
    for body in _bodies(right):
        yield f"it is in the frame of body '{body}', not the ground's", _in_body_frame(right, body)
    if right.channel is Channel.ACCELERATION:
        yield "gravity is subtracted, as an accelerometer does", values - right.scene.gravity
    for joint, anchor in _anchors(right).items():
        words = f"it is that of the point in joint '{joint}', not of the mass centre"
        yield words, _at_anchor(right, anchor)


def _factor_words(factor: float) -> str:
    """A factor in words: the slip that it is known for, else "it is F times as large"."""
    known = (words for value, words in FACTORS.items() if abs(factor - value) <= FACTOR_ERROR * abs(value))
    return next(known, f"it is {factor:.5g} times as large")


def _bodies(reading: Reading) -> list[str]:
    """Names of the bodies in whose frame a vector may be read by mistake: those of a joint, or its own; no ground."""
    joints = {joint.name: joint.ends for joint in reading.scene.joints}
    bodies = dict(joints[reading.name]) if reading.channel is Channel.JOINT_FORCE else (reading.name,)
    return [body for body in bodies if body != GROUND]


def _in_body_frame(reading: Reading, body: str) -> Array:
    """The reading's vector (n, 2), given in the ground frame, in the frame of a body, which turns with it."""
    angle = reading.channel_values(Channel.POSITION, body, reading.time)[:, 2]
    c, s, (x, y) = np.cos(angle), np.sin(angle), reading.values.T
    return np.column_stack([c * x + s * y, c * y - s * x])


def _anchors(reading: Reading) -> dict[str, tuple[float, float]]:
    """Places of a body's joints in its frame, m, by joint; {} for a force."""
    sides = [(pin.name, *end) for pin in reading.scene.pins for end in pin.ends]
    sides += [(joint.name, *joint.ends[0]) for joint in reading.scene.guided]
    return {name: at for name, body, at in sides if body == reading.name}


def _at_anchor(reading: Reading, anchor: tuple[float, float]) -> Array:
    """Place (n, 2), m, of a body's point, or its velocity or acceleration, as the reading's channel is.

    ``anchor`` is the point in the body's frame, from its mass centre, m.
    """
    order = LEVELS.index(reading.channel)
    position, *rates = (reading.channel_values(level, reading.name, reading.time) for level in LEVELS[: order + 1])
    c, s, (x, y) = np.cos(position[:, 2]), np.sin(position[:, 2]), anchor
    arm = np.column_stack([c * x - s * y, s * x + c * y])
    if order == 0:
        return position[:, :2] + arm
    return np.asarray((point_velocity, point_acceleration)[order - 1](arm, *rates), dtype=float)


def _without_crank(reading: Reading) -> Array:
    """The drive torque (n, 1), N m or N, less the part that accelerates and lifts the driven link itself."""
    scene = reading.scene
    crank = next(body for body in scene.bodies if body.name == scene.crank)
    velocity, second = (reading.channel_values(level, crank.name, reading.time) for level in LEVELS[1:])
    force = crank.mass * (second[:, :2] - scene.gravity)
    if scene.driver_kind is DriverKind.SLIDER:
        taken = force @ np.array(scene.driven_slider.along)
    else:
        speed = np.where(velocity[:, 2] == 0.0, 1.0, velocity[:, 2])
        taken = np.einsum("nk,nk->n", force, velocity[:, :2]) / speed + (crank.inertia or 0.0) * second[:, 2]
    return np.asarray(reading.values - taken[:, None])


# Mutants of an engine, each with one small fault of its world, its start, its read-out, or its extrapolation.
#
# One of each kind of slip, in the fastest sample that shows it. Many more of each kind are among the nightly tests of
# linkproof's own checks.


MUTANT: Final = "mutant: "
SAME: Final = 1e-7  # of a signal's peak, a hundredth of the tightest limit: runs that differ less are the same


@dataclass(frozen=True)
class Mutant:
    """One fault: ``wrong(trial)`` gives the history of an engine that has it, in a sample and a setting.

    It gives None where the engine gives up, and raises NotTestedError where the fault cannot be planted. Where a
    ``row`` is named, a quantity or invariant, that row has to see it.
    """

    name: str
    wrong: Callable[[EngineTrial], History | None]
    sample: str = PLAIN
    setting: Setting = Setting.TUNED
    row: str = ""

    def check(self, trial: EngineTrial) -> None:
        """Raise AssertionError unless the fault fails a row that the engine itself passes, the ``row`` if one is named.

        A run that gives up shows the fault, too. Raises AssertionError also where the engine's own run does not finish,
        NotTestedError where that run or the fault cannot be had or its row is not judged, AdapterError where the
        adapter raises.
        """
        right, wrong = trial.rows(self.sample, self.setting), self.wrong(trial)
        if self.row and self.row not in right:
            raise NotTestedError(f"no row '{self.row}' is judged of {trial.engine.name}")
        if wrong is None:  # a run that gives up shows the fault
            return
        with np.errstate(all="ignore"):  # a wrong motion can be any numbers
            rows = trial.judged_rows(self.sample, self.setting, wrong).items()
        if any(is_over and not right.get(name) for name, is_over in rows if self.row in ("", name)):
            return
        over = ", ".join(name for name, is_over in right.items() if is_over)
        beside = f" beside {over}, which it fails without the fault too" if over else ""
        signals = vars(trial.finished_history(self.sample, self.setting)).items()
        computed = ", ".join(name for name, signal in signals if getattr(signal, "origin", None) is Origin.COMPUTED)
        cure = f"read its {computed} from the engine" if computed else "return what the engine's own model does"
        raise AssertionError(f"sample '{self.sample}': expected a row over its limit, got none{beside}; {cure}")


def history_with(
    trial: EngineTrial, method: str, other: Callable[..., Any], sample: str, setting: Setting = Setting.TUNED
) -> History | None:
    """The history of a sample by a copy of the engine that has another function as its ``method``; None if it gives up.

    ``other`` is called as the method named is, without the engine. Raises NotTestedError where the engine has no such
    method, AdapterError where the adapter raises.
    """
    if not hasattr(trial.engine, method):
        raise NotTestedError(f"{trial.engine.name} has no '{method}' to replace, as a SteppedEngine has")
    changed: Any = copy.copy(trial.engine)
    setattr(changed, method, other)
    return run_engine(changed, scene_of(sample), setting).history


def in_world(sample: str, wrong: Case, trial: EngineTrial) -> History | None:
    """The engine's history of a sample if it builds its worlds from the ``wrong`` case instead; None if it gives up.

    Raises NotTestedError where the engine builds them in no method ``altered``, AdapterError where the adapter raises.
    """
    return history_with(trial, "altered", lambda scene: wrong.scene(scene.channels), sample)


def _in_sample(sample: str, wrong: Sample, trial: EngineTrial) -> History | None:
    """The engine's history of a sample if it builds its worlds from the ``wrong`` sample instead.

    None if it gives up. Raises what ``in_world`` raises.
    """
    return in_world(sample, wrong.case, trial)


def _started(sample: str, kept: float, moved: float, trial: EngineTrial) -> History | None:
    """The engine's history if bodies start with ``kept`` of their velocity and what ``moved`` steps add.

    Both are shares: of the right velocity, and of the step, over which the start accelerations act. None if it gives
    up. Raises NotTestedError where these change nothing, as in an engine that takes them from its joints and drive, and
    what ``history_with`` and ``EngineTrial.finished_history`` raise.
    """
    step = moved * min(trial.run(sample).passes, default=0.0)

    def altered(scene: Scene) -> Scene:
        """The scene with other start velocities of all bodies."""
        return replace(scene, bodies=tuple(_with_velocity(body, kept, step) for body in scene.bodies))

    wrong = history_with(trial, "altered", altered, sample)
    if wrong is not None and _is_same(trial.finished_history(sample), wrong):
        raise NotTestedError(f"start velocities change nothing in a run of {trial.engine.name}")
    return wrong


def _with_velocity(body: Body, kept: float, step: float) -> Body:
    """A copy of a body with a share of its start velocities, and what its accelerations add to them in ``step``, s."""
    x, y = (kept * rate + step * change for rate, change in zip(body.velocity, body.acceleration, strict=True))
    turning = kept * body.angular_velocity + step * body.angular_acceleration
    return replace(body, velocity=(x, y), angular_velocity=turning)


def _is_same(history: History, other: History) -> bool:
    """Whether two histories of the same signals have the same values, to SAME of every signal's peak."""
    pairs = zip(history.signals.values(), other.signals.values(), strict=True)
    return all(
        a.values.shape == b.values.shape and np.all(np.abs(a.values - b.values) <= SAME * np.max(np.abs(a.values)))
        for a, b in pairs
    )


def _lagging(signal: Signal) -> Array:
    """The signal's values (n, ...), each half a sample too early for its time: it lags.

    Raises ValueError for fewer than six samples.
    """
    time = signal.time
    return resample(signal, np.clip(time - 0.5 * np.gradient(time), time[0], time[-1]))


def _with_late_start(signal: Signal) -> Array:
    """The signal's values (n, ...), the first one replaced by that of half a step later.

    Raises ValueError for fewer than six samples.
    """
    time = signal.time.copy()
    time[0] += 0.5 * (time[1] - time[0])
    return resample(signal, time)


def _misread(sample: str, channel: Channel, slip: Callable[[Signal], Array], trial: EngineTrial) -> History:
    """The engine's own history of a sample, with a channel altered by a ``slip``, which makes values of a signal.

    Raises NotTestedError without the channel, and what ``EngineTrial.finished_history`` raises.
    """
    if channel not in trial.engine.abilities.readouts:
        raise NotTestedError(f"{trial.engine.name} offers no {channel.value}")
    signals = trial.finished_history(sample).signals
    wrong = {key: replace(signal, values=slip(signal)) for key, signal in signals.items() if key[0] is channel}
    return History.of(signals | wrong)


def extrapolated(weigh: Weigh, trial: EngineTrial) -> History | None:
    """The engine's history with its runs at several steps combined by the weights of ``weigh``; None if it gives up.

    It is that of the plain sample in ``best``. ``weigh(steps, orders)`` gives a weight to each run from the runs'
    steps, s, and the orders of their errors. Raises NotTestedError where its best setting is one run, and what
    ``history_with`` and ``EngineTrial.finished_history`` raise.
    """
    trial.finished_history(PLAIN, Setting.BEST)
    if len(trial.run(PLAIN, Setting.BEST).passes) < 2:
        raise NotTestedError(f"'{Setting.BEST}' of {trial.engine.name} is one run")
    return history_with(trial, "weights", weigh, PLAIN, Setting.BEST)


def _slightly_wrong_weights(steps: Sequence[float], orders: Sequence[int]) -> Array:
    """Richardson's weights of runs at these ``steps``, s, for errors of these orders, the first one 1e-6 too large.

    Raises what ``engines.stepping.richardson.weights`` raises.
    """
    right = weights(steps, orders)
    right[0] += 1e-6
    return right


# By fault of the world: the sample that shows it, what is wrong in that sample, and the row that has to see it.
WORLD: Final[Mapping[str, tuple[str, Mapping[str, Any], str]]] = {
    "the coupler's mass 1 % too large": (PLAIN, {"variant": "the coupler's mass 1 % too large"}, ""),
    "a pin 0.1 mm out of place": (PLAIN, {"variant": "a pin 0.1 mm out of place"}, ""),
    "the crank 0.01° out of place": (PLAIN, {"start": SAMPLES[PLAIN].start + 0.01}, ""),
    "gravity 0.1 % too small": (AT_SPEED, {"variant": "gravity 0.1 % too small"}, "weight_on_frame"),
}
# By wrong start: how much of the right velocities, and of a step's change, the bodies have.
STARTS: Final[Mapping[str, tuple[float, float]]] = {
    "starts at rest": (0.0, 0.0),
    "start velocities of the middle of the first step": (1.0, 0.5),
}
SLIPS: Final[Mapping[str, tuple[str, Callable[[Signal], Array]]]] = {
    "wrong sign": (PLAIN, lambda signal: -signal.values),
    "values of half a sample before their times": (PLAIN, _lagging),
    "first sample that of half a step later": (AT_SPEED, _with_late_start),
}


def _mutants() -> Iterator[Mutant]:
    """Yield every deliberate fault of an engine that the checks have to find, once."""
    for words, (sample, changes, row) in WORLD.items():
        wrong = replace(SAMPLES[sample], **changes)
        yield Mutant(f"{sample}: {words}", partial(_in_sample, sample, wrong), sample, row=row)
    for sample in (AT_SPEED, SLIDER_AT_SPEED):
        for words, shares in STARTS.items():
            yield Mutant(f"{sample}: {words}", partial(_started, sample, *shares), sample)
    for channel in Channel:
        for words, (sample, slip) in SLIPS.items():
            yield Mutant(f"{channel.value}: {words}", partial(_misread, sample, channel, slip), sample)
    yield Mutant("best: a weight off by 1e-6", partial(extrapolated, _slightly_wrong_weights), setting=Setting.BEST)


MUTANTS: Final = tuple(_mutants())
MUTANT_CHECKS: Final = tuple(EngineCheck(f"{MUTANT}{mutant.name}", "fails a row", mutant.check) for mutant in MUTANTS)
