"""Passes of a scene through pymunk under a prescribed crank, on the way to second order and beyond.

With every joint's ``error_bias`` at 0 each step closes the joints to first order (a linearised SHAKE), which makes the
motion second order in the step with terms of every higher order behind it; any other bias leaves it at first order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from analytic.laws import FULL_TURN
from analytic.regimes import CrankMotion, Segment
from engines.contract import Scene
from engines.pymunk_checks import DivergedError, check_crank, check_impulses, check_joints
from engines.pymunk_doubt import Pass, doubt
from engines.pymunk_layout import Layout
from engines.pymunk_loads import StepLoads
from engines.pymunk_recording import Clock, Recording, joined, looks, marks
from engines.pymunk_space import Rig, World, add_motor, add_torque, build_world
from engines.pymunk_stepping import Calls, calls, march, place

Array = NDArray[np.float64]

# Steps before the first sample of a segment, in which what the start got wrong dies away: first with COLD times as many
# iterations, there being no good guess of the impulses, then as later, so that the change of effort dies away too.
RUN_IN = 20
COLD_STEPS = 10
COLD = 4

# Passes of a prescribed motion at most, what another one has to make of their disagreement to be followed by more, and
# how far they may disagree in the end.
MOST_PASSES = 7
WORTHWHILE = 0.5
LARGEST_DOUBT = 0.05

# Fewest samples of a segment, however short it is.
LEAST_SAMPLES = 4


@dataclass(frozen=True)
class Plan:
    """How a setting is stepped.

    ``samples_per_turn`` at the peak speed (``least_samples`` in all), the ``ratios`` of steps to samples of the passes
    that are extrapolated, and the share ``remaining`` of an impulse's change that the solver may leave wrong in a step.
    ``doubt`` is how far the result may depend on the coarsest pass (see pymunk_doubt; the angle of a free crank, rad).
    """

    samples_per_turn: int
    least_samples: int
    ratios: tuple[int, ...]
    remaining: float
    doubt: float


def step_count(duration: float, step: float) -> int:
    """Number of equal steps of at most ``step`` seconds that make up a duration."""
    return max(LEAST_SAMPLES, math.ceil(duration / step * (1.0 - 1e-9)))


def clocks(motion: CrankMotion, step: float, ratio: int) -> list[tuple[Segment, Clock]]:
    """Cut every segment into equal steps of at most ``step`` seconds, so that each kink falls on a sample.

    A segment has its start among its samples; the last one has its end as well.
    """
    result = []
    for segment in motion.segments:
        count = step_count(segment.end - segment.start, step)
        samples = count + 1 if segment is motion.segments[-1] else count
        result.append((segment, Clock(segment.start, (segment.end - segment.start) / count, samples, count, ratio)))
    return result


def mean_speeds(segment: Segment, start: float, step: float, count: int) -> Array:
    """Mean crank speed over consecutive steps, rad/s, exact: Gauss-Legendre quadrature of the speed's polynomial."""
    nodes, shares = np.polynomial.legendre.leggauss(max(1, (len(segment.coefficients) + 1) // 2))
    times = start + step * (np.arange(count)[:, None] + 0.5 * (nodes + 1.0))
    return np.asarray(segment.value(times, 1) @ (0.5 * shares))


def torque_bound(scene: Scene, layout: Layout, motion: CrankMotion) -> float:
    """A torque well above any that the drive can need, N m: all mass at the scene's size, at the peak of the motion."""
    times = np.linspace(0.0, motion.duration, 101)
    rate = float(np.max(np.abs(motion.acceleration(times)))) + motion.peak_speed**2
    size = layout.reach
    weight = sum(part.mass for part in layout.parts)
    bound = rate * (weight * size**2 + sum(part.inertia or 0.0 for part in layout.parts))
    bound += weight * math.hypot(*scene.gravity) * size
    bound += sum(float(np.max(np.abs(load.force.values))) for load in scene.forces) * size
    bound += sum(float(np.max(np.abs(load.torque.values))) for load in scene.torques)
    bound += sum(damper.coefficient for damper in scene.dampers) * motion.peak_speed
    bound += sum(spring.stiffness + spring.damping * motion.peak_speed for spring in scene.springs) * size**2
    return bound


def prescribed_passes(rig: Rig, motion: CrankMotion, plan: Plan) -> list[Pass]:
    """The passes to extrapolate: those of the plan, and finer ones until they agree as far as the plan wants.

    Raises DivergedError where they do not agree at all.
    """
    step = min(FULL_TURN / motion.peak_speed / plan.samples_per_turn, motion.duration / plan.least_samples)
    ratios = list(plan.ratios)
    passes = [prescribed_pass(rig, motion, step, ratio) for ratio in ratios]
    found, before = doubt(passes, rig.layout), math.inf
    while plan.doubt < found.size < WORTHWHILE * before and len(passes) < MOST_PASSES:
        ratios.append(ratios[-1] + 2)
        passes.append(prescribed_pass(rig, motion, step, ratios[-1]))
        found, before = doubt(passes, rig.layout), found.size
    if found.size > LARGEST_DOUBT:
        raise DivergedError(
            f"runs at different steps do not agree: {found.about} differs by {found.size:.2g} of its scale at "
            f"{found.time:.4g} s"
        )
    return passes


def prescribed_pass(rig: Rig, motion: CrankMotion, step: float, ratio: int) -> Pass:
    """Drive the crank through its motion, every segment on its own, ``ratio`` steps to a sample.

    A segment is entered along its own polynomial continued backwards, so that its first samples already show the motion
    after the kink. The motor's impulse is known to its size alone: a constant torque on the crank, above any that the
    drive can need, keeps its sign. Raises DivergedError.
    """
    begun = perf_counter()
    world = build_world(rig.scene, rig.layout, iterations=rig.iterations, error_bias=0.0)
    offset = torque_bound(rig.scene, rig.layout, motion)
    add_torque(world, world.crank, offset)
    on = calls(world, add_motor(world))
    built, seconds, steps = perf_counter() - begun, 0.0, 0
    recordings = []
    for segment, clock in clocks(motion, step, ratio):
        begun = perf_counter()
        recording, taken = _driven(rig, world, on, segment=segment, clock=clock, offset=offset)
        seconds, steps = seconds + perf_counter() - begun, steps + taken
        check_joints(recording.times, recording.seen, rig.layout)
        check_crank(recording, rig.layout, segment)
        check_impulses(recording, offset)
        recordings.append(recording)
    history = joined([recording.history(rig.scene, rig.layout) for recording in recordings])
    return Pass(step / ratio, history, seconds, built, steps)


def _driven(
    rig: Rig, world: World, on: Calls, *, segment: Segment, clock: Clock, offset: float
) -> tuple[Recording, int]:
    """Drive one segment; returns what was seen of it and the number of steps taken."""
    fine = clock.fine
    steps = looks(clock, rig.scene.channels)
    count = RUN_IN + int(steps[-1]) + 1
    rates = (-mean_speeds(segment, clock.start - RUN_IN * fine, fine, count)).tolist()
    marked = marks(steps + RUN_IN, count)
    world.space.iterations = COLD * rig.iterations
    taken = place(world, on, fine, float(segment.value(clock.start - RUN_IN * fine)))
    loads = StepLoads(world, rig.scene, fine, ahead=True)
    impulses: list[float] = []
    for part, effort in ((slice(COLD_STEPS), COLD), (slice(COLD_STEPS, None), 1)):
        world.space.iterations = effort * rig.iterations
        impulses += march(on, fine, rates[part], marked[part], loads if loads else None)
    recording = Recording(clock, steps, on.collected(), offset - np.array(impulses) / fine)
    return recording, taken + count
