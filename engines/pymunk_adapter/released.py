"""A free crank: finding the step at which it can be followed, and following it in windows.

Passes at different steps get ever further out of phase, and what turns with the crank cannot be extrapolated from them
any more long before the crank's angle cannot. So they are extrapolated every few turns, and all are released again from
the one motion that came of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import Segment
from engines.contract import History, Signal
from engines.pymunk_adapter.checks import check_finite, check_joints
from engines.pymunk_adapter.passes import LEAST_SAMPLES, ORDERS, RUN_IN, count_steps, run_in
from engines.pymunk_adapter.plans import Aim, Plan
from engines.pymunk_adapter.recording import Clock, Recording, looks, marks
from engines.pymunk_adapter.space import Rig, World, add_motor, add_torque, build_world
from engines.pymunk_adapter.stepping import calls, march_wound
from engines.scene import Channel, Free, Scene
from engines.stepping.cost import Cost
from engines.stepping.driver import CAUTION, DivergedError, StepSearch, whole_steps
from engines.stepping.error_estimate import angle_disagreement
from engines.stepping.histories import combined, joined
from engines.stepping.richardson import Pass, extrapolate, weights

Array = NDArray[np.float64]

# Where passes disagree about the angle, which goes with a power of the step, the next step is this much below the one
# foreseen to do, and no less than a share of the last.
SHORTER, LARGEST_CUT = 0.9, 0.25

# Bounds of the search for a step, and of the steps of a pass: minutes of work, gigabytes of samples.
MOST_TRIALS = 10
MOST_STEPS = 10_000_000

# Samples from release to release, and how many of the first after a release are taken from the window before: a motor
# that lets go leaves a trace in them.
WINDOW = 1000
OVERLAP = 10

# Samples of the past that tell how the crank came to where it is released, and the power of time they are fitted with.
PAST, DEGREE = RUN_IN + 8, 12


@dataclass(frozen=True)
class Release:
    """Where a window starts: the crank's angle just before, as a polynomial of time, and the parts near there.

    ``state`` (parts, 3) is x, y, θ; None for the scene's start.
    """

    past: Segment
    state: Array | None = None


def free_history(rig: Rig, drive: Free, plan: Plan, cost: Cost) -> tuple[History, float]:
    """The motion of a free crank and the step of its samples, s; raises DivergedError where no step is found."""
    if isinstance(plan.pace, Aim):
        return _aimed(rig, drive, plan.ratios, plan.pace, cost)
    step = drive.duration / whole_steps(drive.duration, plan.pace, LEAST_SAMPLES)
    return followed(rig, drive, step, plan.ratios, cost)[0], step


def _aimed(rig: Rig, drive: Free, ratios: tuple[int, ...], aim: Aim, cost: Cost) -> tuple[History, float]:
    """The motion at the step that the aim asks for.

    At too long a step a free crank loses so much energy that it never gets up to its speed. So a first pass measures
    its pace, and the step is cut until the angle depends on the coarsest pass no more than it may.
    """
    watched = replace(rig, scene=replace(rig.scene, channels=frozenset({Channel.VELOCITY, Channel.ACCELERATION})))

    def pace(step: float) -> float:
        trial, _ = followed(watched, drive, step, (1,), cost)
        return max(_pace(trial, rig.layout.crank), 1.0 / drive.duration)

    shortest = drive.duration * max(ratios) / MOST_STEPS
    search = StepSearch(drive.duration, aim.samples_per_turn, LEAST_SAMPLES, MOST_TRIALS, CAUTION, shortest)
    step = drive.duration / aim.least_samples
    while True:
        step = search.fit(step, pace)
        try:
            history, left = followed(rig, drive, step, ratios, cost)
        except DivergedError:
            step /= CAUTION
            continue
        if left <= aim.disagreement:
            return history, step
        step *= max(LARGEST_CUT, SHORTER * (aim.disagreement / left) ** (1.0 / len(ratios)))


def _pace(history: History, crank: int) -> float:
    """The faster of turning and swinging: peak speed, and peak acceleration over peak speed, 1/s."""
    assert history.velocity is not None
    assert history.acceleration is not None
    speed = float(np.max(np.abs(history.velocity.values[:, crank, 2])))
    acceleration = float(np.max(np.abs(history.acceleration.values[:, crank, 2])))
    return max(speed, acceleration / speed if speed else 0.0)


def followed(rig: Rig, drive: Free, step: float, ratios: Sequence[int], cost: Cost) -> tuple[History, float]:
    """The motion at samples ``step`` seconds apart, and how far its crank angle may depend on the coarsest pass, rad.

    That is summed over all windows, with what disagreement about the speed at a release makes of the angle by the end.
    """
    crank, wanted = rig.layout.crank, rig.scene.channels
    if len(ratios) > 1:
        rig = replace(rig, scene=replace(rig.scene, channels=wanted | {Channel.POSITION, Channel.ACCELERATION}))
    count, apart = round(drive.duration / step), 0.0
    parts: list[History] = []
    release = _start(rig.scene)
    for first, last in _windows(count, whole=len(ratios) == 1):
        beyond = min(last + OVERLAP, count) - first
        clocks = [Clock(first * step, step, beyond + 1, beyond, ratio) for ratio in ratios]
        recordings = [_recording(rig, drive, release, clock, cost) for clock in clocks]
        passes = [Pass(seen.clock.fine, seen.history(rig.scene.channels, rig.layout)) for seen in recordings]
        window = extrapolate(passes, ORDERS)
        # Velocities lie between the samples.
        parts.append(_later(window, (first + OVERLAP + 0.25) * step) if first else window)
        if len(passes) > 1:
            apart += angle_disagreement(passes, ORDERS, crank)
        if last < count:
            full, finer = (_instant(recordings[skipped:], last - first) for skipped in (0, 1))
            apart += abs(float((full - finer)[1, crank, 2])) * (drive.duration - last * step)
            release = _release(window, last - first, full, crank)
    return _as_asked(joined(parts), wanted), apart


def _instant(recordings: Sequence[Recording], sample: int) -> Array:
    """Positions, rates and accelerations of the parts at a sample, extrapolated, (3, parts, 3)."""
    share = weights([seen.clock.fine for seen in recordings], ORDERS)
    return np.asarray(np.tensordot(share, np.array([seen.instant(sample) for seen in recordings]), 1))


def _as_asked(history: History, wanted: frozenset[Channel]) -> History:
    """A history without what was recorded for the releases alone."""
    position = history.position if Channel.POSITION in wanted else None
    return replace(
        history, position=position, acceleration=history.acceleration if Channel.ACCELERATION in wanted else None
    )


def _windows(count: int, *, whole: bool) -> list[tuple[int, int]]:
    """First and last samples of the windows between releases; a short one goes with the window before."""
    starts = [0] if whole else list(range(0, max(1, count - WINDOW // 2), WINDOW))
    return list(zip(starts, [*starts[1:], count], strict=True))


def _start(scene: Scene) -> Release:
    """The release of the scene itself, as if the crank had had its acceleration before."""
    crank = next(body for body in scene.bodies if body.name == scene.crank)
    return Release(Segment(0.0, 0.0, (crank.angle, crank.angular_velocity, 0.5 * crank.angular_acceleration)))


def _release(history: History, sample: int, instant: Array, crank: int) -> Release:
    """The release at a sample, where ``instant`` (3, parts, 3) holds positions, rates and accelerations.

    Angle, speed and acceleration are those; higher powers of time are fitted to the samples before.
    """
    assert history.position is not None
    now, before = float(history.position.time[sample]), slice(sample - PAST, sample)
    time, angle = history.position.time[before] - now, history.position.values[before, crank, 2]
    known = instant[:, crank, 2] * (1.0, 1.0, 0.5)
    span = -time[0]
    powers = np.stack([(time / span) ** power for power in range(3, DEGREE + 1)], axis=-1)
    fitted = np.linalg.lstsq(powers, angle - np.polynomial.polynomial.polyval(time, known), rcond=None)[0]
    higher = fitted / span ** np.arange(3, DEGREE + 1)
    return Release(Segment(now, now, (*known.tolist(), *higher.tolist())), instant[0])


def _recording(rig: Rig, drive: Free, release: Release, clock: Clock, cost: Cost) -> Recording:
    """Let the crank go and look at what it does. Raises DivergedError."""
    with cost.building():
        world = build_world(rig.layout, iterations=rig.iterations, error_bias=0.0)
        if release.state is not None:
            _put(world, release.state)
        if drive.torque:
            add_torque(world, world.crank, drive.torque)
        motor = add_motor(world)
        on = calls(world, motor)
    with cost.stepping():
        loads = run_in(rig, world, on, cost, segment=release.past, clock=clock)
        world.space.remove(motor)
        steps = looks(clock, rig.scene.channels)
        if steps[0] < 0:
            on.look()
        count = int(steps[-1]) + 1
        rates, marked = [0.0] * count, marks(steps[steps >= 0], count)
        seen, _ = march_wound(world, on, clock.fine, rates=rates, looks=marked, loads=loads)
        count_steps(cost, world, count)
    recording = Recording(clock, steps, seen, np.full(len(steps), drive.torque))
    check_finite(recording.times, recording.seen)
    if rig.checked:
        check_joints(recording.times, recording.seen, rig.layout)
    return recording


def _put(world: World, state: Array) -> None:
    for body, (x, y, angle) in zip(world.bodies, state.tolist(), strict=True):
        body.position, body.angle = (x, y), angle


def _later(history: History, time: float) -> History:
    """A window without the samples up to a time, which the window before has as well."""

    def cut(signals: Sequence[Signal]) -> Signal:
        (signal,) = signals
        after = slice(int(np.searchsorted(signal.time, time)), None)
        return Signal(signal.time[after], signal.values[after])

    return combined([history], cut)
