"""A free crank: letting it go, and finding the step at which it can be followed."""

from __future__ import annotations

import math
from dataclasses import replace
from time import perf_counter

import numpy as np

from analytic.laws import FULL_TURN
from engines.contract import Body, Channel, Free, History, Scene
from engines.pymunk_checks import DivergedError, check_joints
from engines.pymunk_doubt import Pass, angle_doubt
from engines.pymunk_layout import Layout
from engines.pymunk_loads import StepLoads
from engines.pymunk_passes import COLD, COLD_STEPS, Plan, marks_of, step_count
from engines.pymunk_recording import Clock, Recording, looks
from engines.pymunk_space import World, add_torque, build_world
from engines.pymunk_stepping import calls, march

# A step is cut by no more than this at a time: the pace seen with too long a step may be nonsense.
STEP_CUT = 8.0
MOST_TRIALS = 10


def free_pass(scene: Scene, layout: Layout, drive: Free, step: float, ratio: int, iterations: int) -> Pass:
    """Let the crank go under its constant torque. Raises DivergedError."""
    begun = perf_counter()
    world = build_world(scene, layout, iterations=iterations, error_bias=0.0)
    if drive.torque:
        add_torque(world, world.crank, drive.torque)
    on = calls(world, None)
    count = step_count(drive.duration, step)
    clock = Clock(0.0, drive.duration / count, count + 1, count, ratio)
    loads = _let_go(scene, world, clock.fine)
    built = perf_counter() - begun
    begun = perf_counter()
    steps = looks(clock, scene.channels)
    seen = int(steps[0] < 0)
    if seen:
        on.look()  # the step before the first one is the start itself
    total = int(steps[-1]) + 1
    marks = marks_of(steps[seen:], 0, total)
    for part, effort in ((marks[:COLD_STEPS], COLD * iterations), (marks[COLD_STEPS:], iterations)):
        world.space.iterations = effort
        march(on, clock.fine, [0.0] * len(part), part, loads if loads else None)
    recording = Recording(clock, steps, on.collected(), np.full(len(steps), drive.torque))
    seconds = perf_counter() - begun
    check_joints(recording, layout)
    return Pass(clock.fine, recording.history(scene, layout), seconds, built, total)


def free_passes(
    scene: Scene, layout: Layout, drive: Free, plan: Plan, iterations: int
) -> tuple[list[Pass], list[Pass]]:
    """The passes to extrapolate, and before them all that were tried to find their step.

    How fast a free crank gets is not known before, and at too long a step it loses so much energy that it never gets
    there. So a first pass measures the pace, and the step is halved until the angle does not depend on the coarsest
    pass any more. Raises DivergedError where that takes more than MOST_TRIALS attempts.
    """
    step = drive.duration / plan.least_samples
    watched = replace(scene, channels=scene.channels | {Channel.POSITION})
    tried: list[Pass] = []
    doubt = math.inf
    for _ in range(MOST_TRIALS):
        try:
            pilot = free_pass(_rates_only(scene), layout, drive, step, 1, iterations)
            tried.append(pilot)
            wanted = FULL_TURN / max(_pace(pilot.history, layout.crank), 1.0 / drive.duration) / plan.samples_per_turn
            if wanted < step:
                step = max(wanted, step / STEP_CUT)
                continue
            passes = [free_pass(watched, layout, drive, step, ratio, iterations) for ratio in plan.ratios]
        except DivergedError:
            step /= STEP_CUT
            continue
        doubt = angle_doubt(passes, layout.crank)
        if doubt <= plan.doubt:
            return tried, [_without_watch(done, scene) for done in passes]
        tried += passes
        step /= 2.0
    raise DivergedError(f"no step down to {step:.2g} s gives a reliable motion: the crank's angle is in doubt by {doubt:.2g} rad")


def _rates_only(scene: Scene) -> Scene:
    return replace(scene, channels=frozenset({Channel.VELOCITY, Channel.ACCELERATION}))


def _without_watch(done: Pass, scene: Scene) -> Pass:
    if Channel.POSITION in scene.channels:
        return done
    return replace(done, history=replace(done.history, position=None))


def _pace(history: History, crank: int) -> float:
    """The faster of turning and swinging: peak speed, and peak acceleration over peak speed, 1/s."""
    assert history.velocity is not None and history.acceleration is not None
    speed = float(np.max(np.abs(history.velocity.values[:, crank, 2])))
    acceleration = float(np.max(np.abs(history.acceleration.values[:, crank, 2])))
    return max(speed, acceleration / speed if speed else 0.0)


def _let_go(scene: Scene, world: World, fine: float) -> StepLoads:
    """Set the state that the first step expects, positions at −h and velocities at −h/2, and take hold of the loads."""
    _set_rates(scene, world, -1.5 * fine)  # dampers look one step further back
    loads = StepLoads(world, scene, fine, ahead=True)
    _set_rates(scene, world, -0.5 * fine)
    for body in world.bodies:
        (x, y), (vx, vy) = body.position, body.velocity
        body.position = (x - fine * vx, y - fine * vy)
        body.angle -= fine * body.angular_velocity
    return loads


def _set_rates(scene: Scene, world: World, time: float) -> None:
    """Give every part the velocity it has a short time after the start, by the start's accelerations."""
    for body, part in zip(world.bodies, world.layout.parts, strict=True):
        velocity, turn_rate = _rates(scene.bodies[part.owner], part.offset, time)
        body.velocity = velocity
        body.angular_velocity = 0.0 if part.inertia is None else turn_rate


def _rates(owner: Body, offset: tuple[float, float], time: float) -> tuple[tuple[float, float], float]:
    c, s = math.cos(owner.angle), math.sin(owner.angle)
    x, y = c * offset[0] - s * offset[1], s * offset[0] + c * offset[1]
    rate, second = owner.angular_velocity, owner.angular_acceleration
    ax = owner.acceleration[0] - second * y - rate * rate * x
    ay = owner.acceleration[1] + second * x - rate * rate * y
    vx, vy = owner.velocity[0] - rate * y, owner.velocity[1] + rate * x
    return (vx + time * ax, vy + time * ay), rate + time * second
