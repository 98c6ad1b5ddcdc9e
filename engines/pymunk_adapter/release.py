"""Following a free crank at a given step: released again and again, from where the passes together have brought it.

Passes at different steps get ever further out of phase, and what turns with the crank cannot be extrapolated from them
any more long before the crank's angle cannot. So they are extrapolated every few turns, and all start again from the
one motion that came of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import Segment
from engines.contract import History, Signal
from engines.pymunk_adapter.checks import check_finite, check_joints
from engines.pymunk_adapter.cost import Cost
from engines.pymunk_adapter.disagreement import ORDERS, Pass, angle_doubt, extrapolated
from engines.pymunk_adapter.passes import RUN_IN, run_in
from engines.pymunk_adapter.recording import Clock, Recording, joined, looks, marks
from engines.pymunk_adapter.space import Rig, World, add_motor, add_torque, build_world
from engines.pymunk_adapter.stepping import calls, march_wound
from engines.scene import Channel, Free, Scene
from engines.stepping.richardson import weights

Array = NDArray[np.float64]

# Samples from release to release, and how many of the first after a release are taken from the stretch before: a motor
# that lets go leaves a trace in them.
WINDOW = 1000
OVERLAP = 10

# Samples of the past that tell how the crank came to where it is released, and the power of time they are fitted with.
PAST, DEGREE = RUN_IN + 8, 12


@dataclass(frozen=True)
class Release:
    """Where a stretch starts: the crank's angle just before, as a polynomial of time, and the parts near there.

    ``state`` (parts, 3) is x, y, θ; None for the scene's start.
    """

    past: Segment
    state: Array | None = None


def followed(rig: Rig, drive: Free, step: float, ratios: Sequence[int], cost: Cost) -> tuple[History, float]:
    """The motion at samples ``step`` seconds apart, and how far its crank angle may depend on the coarsest pass, rad.

    That is summed over all stretches, with what a doubt about the speed at a release makes of the angle by the end.
    """
    crank, wanted = rig.layout.crank, rig.scene.channels
    if len(ratios) > 1:
        rig = replace(rig, scene=replace(rig.scene, channels=wanted | {Channel.POSITION, Channel.ACCELERATION}))
    count, doubt, stretches = round(drive.duration / step), 0.0, []
    release = _start(rig.scene)
    for first, last in _windows(count, whole=len(ratios) == 1):
        beyond = min(last + OVERLAP, count) - first
        clocks = [Clock(first * step, step, beyond + 1, beyond, ratio) for ratio in ratios]
        recordings = [_recording(rig, drive, release, clock, cost) for clock in clocks]
        passes = [Pass(seen.clock.fine, seen.history(rig.scene, rig.layout)) for seen in recordings]
        stretches.append(extrapolated(passes))
        if len(passes) > 1:
            doubt += angle_doubt(passes, crank)
        if last < count:
            full, finer = (_instant(recordings[skipped:], last - first) for skipped in (0, 1))
            doubt += abs(float((full - finer)[1, crank, 2])) * (drive.duration - last * step)
            release = _release(stretches[-1], last - first, full, crank)
    later = [_later(stretch) for stretch in stretches[1:]]
    return _as_asked(joined([stretches[0], *later]), wanted), doubt


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
    """First and last samples of the stretches between releases; a short one goes with the stretch before."""
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
        world = build_world(rig.scene, rig.layout, iterations=rig.iterations, error_bias=0.0)
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
        cost.count(world, count)
    recording = Recording(clock, steps, seen, np.full(len(steps), drive.torque))
    check_finite(recording.times, recording.seen)
    if rig.judged:
        check_joints(recording.times, recording.seen, rig.layout)
    return recording


def _put(world: World, state: Array) -> None:
    for body, (x, y, angle) in zip(world.bodies, state.tolist(), strict=True):
        body.position, body.angle = (x, y), angle


def _later(history: History) -> History:
    """A stretch without the samples that the stretch before has as well; velocities are between samples."""

    def cut(signal: Signal | None, count: int = OVERLAP + 1) -> Signal | None:
        return None if signal is None else Signal(signal.time[count:], signal.values[count:])

    forces = {name: Signal(f.time[OVERLAP + 1 :], f.values[OVERLAP + 1 :]) for name, f in history.joint_force.items()}
    velocity = cut(history.velocity, OVERLAP)
    return History(cut(history.position), velocity, cut(history.acceleration), cut(history.torque), forces)
