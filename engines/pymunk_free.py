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
from engines.pymunk_loads import StepLoads
from engines.pymunk_passes import COLD, COLD_STEPS, Plan, step_count
from engines.pymunk_recording import Clock, Recording, looks, marks
from engines.pymunk_space import Rig, World, add_torque, build_world
from engines.pymunk_stepping import calls, march

# A step is cut by no more than this at a time: the pace seen with too long a step may be nonsense. One that is longer
# than wanted by less than the slack will do.
STEP_CUT = 8.0
SLACK = 1.25

# Times the iterations of a normal step that the first one gets: it starts from nothing and is a sample already.
FIRST = 20

# Bounds of the search for a step, and of the steps of a pass: minutes of work, gigabytes of samples.
MOST_TRIALS = 10
MOST_STEPS = 10_000_000


def free_passes(rig: Rig, drive: Free, plan: Plan) -> tuple[list[Pass], list[Pass]]:
    """The passes to extrapolate, and all those tried before them to find their step.

    How fast a free crank gets is not known before, and at too long a step it loses so much energy that it never gets
    there. So a first pass measures the pace, and the step is halved until the angle does not depend on the coarsest
    pass any more. Raises DivergedError where no step is found.
    """
    step, doubt = drive.duration / plan.least_samples, math.inf
    tried: list[Pass] = []
    for _ in range(MOST_TRIALS):
        if drive.duration / step * max(plan.ratios) > MOST_STEPS:
            break
        try:
            tried.append(free_pass(_seen_by(rig, Channel.VELOCITY, Channel.ACCELERATION), drive, step, 1))
            pace = max(_pace(tried[-1].history, rig.layout.crank), 1.0 / drive.duration)
            wanted = FULL_TURN / pace / plan.samples_per_turn
            if SLACK * wanted < step:
                step = max(wanted, step / STEP_CUT)
                continue
            watched = _seen_by(rig, Channel.POSITION, *rig.scene.channels)
            passes = [free_pass(watched, drive, step, ratio) for ratio in plan.ratios]
        except DivergedError:
            step /= STEP_CUT
            continue
        doubt = angle_doubt(passes, rig.layout.crank)
        if doubt <= plan.doubt:
            return tried, [_as_asked(done, rig.scene) for done in passes]
        tried += passes
        step /= 2.0
    raise DivergedError(
        f"no step down to {step:.2g} s gives a motion to rely on: the crank's angle stays in doubt by {doubt:.2g} rad"
    )


def _seen_by(rig: Rig, *channels: Channel) -> Rig:
    return replace(rig, scene=replace(rig.scene, channels=frozenset(channels)))


def _as_asked(done: Pass, scene: Scene) -> Pass:
    """Without the positions that were recorded for the search alone."""
    return done if Channel.POSITION in scene.channels else replace(done, history=replace(done.history, position=None))


def _pace(history: History, crank: int) -> float:
    """The faster of turning and swinging: peak speed, and peak acceleration over peak speed, 1/s."""
    assert history.velocity is not None
    assert history.acceleration is not None
    speed = float(np.max(np.abs(history.velocity.values[:, crank, 2])))
    acceleration = float(np.max(np.abs(history.acceleration.values[:, crank, 2])))
    return max(speed, acceleration / speed if speed else 0.0)


def free_pass(rig: Rig, drive: Free, step: float, ratio: int) -> Pass:
    """Let the crank go under its constant torque, ``ratio`` steps to a sample. Raises DivergedError."""
    begun = perf_counter()
    world = build_world(rig.scene, rig.layout, iterations=rig.iterations, error_bias=0.0)
    if drive.torque:
        add_torque(world, world.crank, drive.torque)
    on = calls(world, None)
    count = step_count(drive.duration, step)
    clock = Clock(0.0, drive.duration / count, count + 1, count, ratio)
    loads = _let_go(rig.scene, world, clock.fine)
    built = perf_counter() - begun
    begun = perf_counter()
    steps = looks(clock, rig.scene.channels)
    if steps[0] < 0:
        on.look()  # what the first step starts from
    total = int(steps[-1]) + 1
    marked = marks(steps[steps >= 0], total)
    for part, effort in ((slice(1), FIRST), (slice(1, COLD_STEPS), COLD), (slice(COLD_STEPS, None), 1)):
        world.space.iterations = effort * rig.iterations
        march(on, clock.fine, [0.0] * len(marked[part]), marked[part], loads if loads else None)
    recording = Recording(clock, steps, on.collected(), np.full(len(steps), drive.torque))
    seconds = perf_counter() - begun
    check_joints(recording.times, recording.seen, rig.layout)
    return Pass(clock.fine, recording.history(rig.scene, rig.layout), seconds, built, total)


def _let_go(scene: Scene, world: World, fine: float) -> StepLoads:
    """Set the state that the first step expects, positions at −h and velocities at −h/2; return the loads.

    They are made in the state of one step before, for dampers and dashpots look that far back.
    """
    _set_rates(scene, world, -0.5 * fine)
    _move(world, -fine)
    _set_rates(scene, world, -1.5 * fine)
    _move(world, -fine)
    loads = StepLoads(world, scene, fine, ahead=True)
    _move(world, fine)
    _set_rates(scene, world, -0.5 * fine)
    return loads


def _move(world: World, time: float) -> None:
    """Move every part on by its velocity."""
    for body in world.bodies:
        (x, y), (vx, vy) = body.position, body.velocity
        body.position = (x + time * vx, y + time * vy)
        body.angle += time * body.angular_velocity


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
