"""Passes of a scene through pymunk: as a newcomer would run it, and on the way to second order and beyond.

With every joint's ``error_bias`` at 0 each step closes the joints to first order (a linearised SHAKE), which makes the
motion second order in the step with terms of every higher order behind it; any other bias leaves it at first order.
The naive pass leaves pymunk its defaults and takes every read-out at face value.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import CrankMotion, Segment
from analytic.description.law import FULL_TURN
from engines.contract import History, Signal
from engines.pymunk_adapter.checks import check_crank, check_finite, check_impulses, check_joints
from engines.pymunk_adapter.layout import PartLayout
from engines.pymunk_adapter.loads import StepLoads
from engines.pymunk_adapter.plans import PlainPlan, Plan
from engines.pymunk_adapter.recording import Clock, Recording, joint_forces, looks, marks
from engines.pymunk_adapter.space import Rig, World, add_motor, add_torque, build_world
from engines.pymunk_adapter.stepping import Calls, calls, march, march_wound, place
from engines.scene import Channel, Free, Prescribed, Scene
from engines.stepping.cost import Cost
from engines.stepping.driver import DivergedError, refined
from engines.stepping.error_estimate import disagreement
from engines.stepping.histories import joined
from engines.stepping.intervals import Pace, intervals
from engines.stepping.richardson import Pass

Array = NDArray[np.float64]

# Steps before the first sample of a segment, in which what the start got wrong dies away: a share of them with COLD
# times as many iterations, there being no good guess of the impulses, then as later, so that the change of effort dies
# away too. Where steps are so long that they would lead further back than a turn, there are fewer.
RUN_IN = 40
COLD_SHARE = 0.25
COLD = 4

# Powers of the step in the error of a pass; the read-outs are centred, the closing of the joints is not.
ORDERS = (2, 3, 4, 5, 6, 7, 8)

# Passes of a prescribed motion at most, what another one has to make of their disagreement to be followed by more, and
# how far they may disagree in the end.
MOST_PASSES = 7
WORTHWHILE = 0.5
LARGEST_DISAGREEMENT = 0.05

# Fewest samples of a segment, however short it is.
LEAST_SAMPLES = 4


def clocks(motion: CrankMotion, step: float, ratio: int) -> list[tuple[Segment, Clock]]:
    """Cut every segment into equal steps of at most ``step`` seconds, so that each kink falls on a sample.

    A segment has its start among its samples; the last one has its end as well.
    """
    result = []
    for part in intervals(motion, Pace(step, least_steps=LEAST_SAMPLES)):
        assert part.segment is not None
        samples = part.samples + 1 if part.segment is motion.segments[-1] else part.samples
        result.append((part.segment, Clock(part.start, part.step, samples, part.samples, ratio)))
    return result


def mean_speeds(segment: Segment, start: float, step: float, count: int) -> Array:
    """Mean crank speed over consecutive steps, rad/s, exact: Gauss-Legendre quadrature of the speed's polynomial."""
    nodes, shares = np.polynomial.legendre.leggauss(max(1, (len(segment.coefficients) + 1) // 2))
    times = start + step * (np.arange(count)[:, None] + 0.5 * (nodes + 1.0))
    return np.asarray(segment.value(times, 1) @ (0.5 * shares))


def torque_bound(scene: Scene, layout: PartLayout, motion: CrankMotion) -> float:
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


def prescribed_passes(rig: Rig, motion: CrankMotion, plan: Plan, cost: Cost) -> list[Pass]:
    """The passes to extrapolate: those of the plan, and finer ones until they agree as far as it aims at.

    Raises DivergedError where they do not agree at all.
    """
    aim = plan.pace
    if isinstance(aim, float):
        return [prescribed_pass(rig, motion, aim, ratio, cost) for ratio in plan.ratios]
    step = min(FULL_TURN / motion.peak_speed / aim.samples_per_turn, motion.duration / aim.least_samples)
    levels = len(plan.ratios)
    further = [plan.ratios[-1] + 2 * number for number in range(1, MOST_PASSES - levels + 1)]
    passes, left = refined(
        lambda ratio: prescribed_pass(rig, motion, step, ratio, cost),
        [*plan.ratios, *further],
        levels=levels,
        estimate=lambda passes: disagreement(passes, ORDERS, rig.layout.reach).size,
        accuracy=aim.disagreement,
        worthwhile=WORTHWHILE,
    )
    if left > LARGEST_DISAGREEMENT:
        worst = disagreement(passes, ORDERS, rig.layout.reach)
        raise DivergedError(
            f"runs at different steps do not agree: {worst.about} differs by {worst.size:.2g} of its scale at "
            f"{worst.time:.4g} s"
        )
    return passes


def count_steps(cost: Cost, world: World, steps: int) -> None:
    """Note steps that a world took with its present number of iterations."""
    cost.steps += steps
    cost.solver_work += steps * world.visits


def prescribed_pass(rig: Rig, motion: CrankMotion, step: float, ratio: int, cost: Cost) -> Pass:
    """Drive the crank through its motion, every segment on its own, ``ratio`` steps to a sample.

    A segment is entered along its own polynomial continued backwards, so that its first samples already show the motion
    after the kink. The motor's impulse is known to its size alone: a constant torque on the crank, above any that the
    drive can need, keeps its sign. Raises DivergedError.
    """
    with cost.building():
        world = build_world(rig.layout, iterations=rig.iterations, error_bias=0.0)
        offset = torque_bound(rig.scene, rig.layout, motion)
        add_torque(world, world.crank, offset)
        on = calls(world, add_motor(world))
    recordings = []
    for segment, clock in clocks(motion, step, ratio):
        with cost.stepping():
            recording = _driven(rig, world, on, cost, segment=segment, clock=clock, offset=offset)
        check_finite(recording.times, recording.seen)
        if rig.checked:
            check_joints(recording.times, recording.seen, rig.layout)
            check_crank(recording, rig.layout, segment)
            check_impulses(recording, offset)
        recordings.append(recording)
    history = joined([recording.history(rig.scene.channels, rig.layout) for recording in recordings])
    return Pass(step / ratio, history)


def _driven(
    rig: Rig, world: World, on: Calls, cost: Cost, *, segment: Segment, clock: Clock, offset: float
) -> Recording:
    """Drive one segment and return what was seen of it."""
    steps, fine = looks(clock, rig.scene.channels), clock.fine
    loads = run_in(rig, world, on, cost, segment=segment, clock=clock)
    before = []
    if steps[0] < 0:
        on.look()
        before.append(on.impulse())
    count = int(steps[-1]) + 1
    rates = (-mean_speeds(segment, clock.start, fine, count)).tolist()
    seen, impulses = march_wound(world, on, fine, rates=rates, looks=marks(steps[steps >= 0], count), loads=loads)
    count_steps(cost, world, count)
    return Recording(clock, steps, seen, offset - np.array(before + impulses) / fine)


def run_in(
    rig: Rig, world: World, on: Calls, cost: Cost, *, segment: Segment, clock: Clock
) -> Callable[[], None] | None:
    """Drive the crank along a segment continued backwards, up to the state that the clock's first step starts from.

    Returns the loads to be set before every further step.
    """
    count = _run_in_steps(segment, clock)
    start = clock.start - count * clock.fine
    world.space.iterations = COLD * rig.iterations
    count_steps(cost, world, place(world, on, clock.fine, float(segment.value(start))))
    changing = StepLoads(world, clock.fine, ahead=True)
    loads = changing if changing else None
    rates, cold = (-mean_speeds(segment, start, clock.fine, count)).tolist(), math.ceil(COLD_SHARE * count)
    for part, effort in ((slice(cold), COLD), (slice(cold, None), 1)):
        world.space.iterations = effort * rig.iterations
        march(on, clock.fine, rates[part], [0] * len(rates[part]), loads)
        count_steps(cost, world, len(rates[part]))
    return loads


def _run_in_steps(segment: Segment, clock: Clock) -> int:
    """Number of steps to lead up to a clock's start."""
    ways = segment.value(clock.start - clock.fine * np.arange(RUN_IN + 1)) - segment.value(clock.start)
    (far,) = np.nonzero(np.abs(ways) > FULL_TURN)
    return max(1, int(far[0]) - 1) if len(far) else RUN_IN


def naive_pass(layout: PartLayout, plan: PlainPlan, cost: Cost) -> Pass:
    """One pass at equal steps.

    The motor is given the crank's speed of the moment, everything read after a step is put at the end of that step, and
    the drive torque is the motor's impulse over the step, of which pymunk tells the size alone. Raises DivergedError.
    """
    scene = layout.scene
    with cost.building():
        world = build_world(layout, iterations=plan.iterations, error_bias=None, native_damping=True)
        for body, part in zip(world.bodies, scene.bodies, strict=True):
            body.velocity = part.velocity
            body.angular_velocity = 0.0 if part.inertia is None else part.angular_velocity
        on = _let_go(scene, world)
    drive = scene.drive
    duration = drive.duration if isinstance(drive, Free) else drive.motion.duration
    count = math.ceil(duration / plan.step * (1.0 - 1e-9))
    step = duration / count
    with cost.stepping():
        seen, torque = _naive_steps(scene, world, on, step, count)
        count_steps(cost, world, count)
    times = step * np.arange(count + 1, dtype=np.float64)
    check_finite(times, seen)
    if plan.torn is not None:
        check_joints(times, seen, layout, plan.torn)
    return Pass(step, _naive_history(layout, step, seen, torque))


def _let_go(scene: Scene, world: World) -> Calls:
    """Put the drive on the crank."""
    if isinstance(scene.drive, Prescribed):
        return calls(world, add_motor(world))
    if scene.drive.torque:
        add_torque(world, world.crank, scene.drive.torque)
    return calls(world, None)


def _naive_steps(scene: Scene, world: World, on: Calls, step: float, count: int) -> tuple[Array, Array]:
    """States (count + 1, bodies, 2, 3), the start's first, and the drive's torques (count,)."""
    drive = scene.drive
    rates = [0.0] * count
    if isinstance(drive, Prescribed):
        rates = (-drive.motion.speed(step * np.arange(count))).tolist()
    loads = StepLoads(world, step, ahead=False)
    on.look()
    impulses = march(on, step, rates, [1] * count, loads if loads else None)
    torque = np.full(count, drive.torque) if isinstance(drive, Free) else np.array(impulses) / step
    return on.collected(), torque


def _naive_history(layout: PartLayout, step: float, seen: Array, torque: Array) -> History:
    times = step * np.arange(1, len(seen), dtype=np.float64)
    state, rates = seen[:, :, 0], seen[:, :, 1]
    acceleration = np.diff(rates, axis=0) / step
    signals = {
        Channel.POSITION: state[1:],
        Channel.VELOCITY: rates[1:],
        Channel.ACCELERATION: acceleration,
        Channel.TORQUE: torque,
    }
    channels = layout.scene.channels
    forces = joint_forces(layout, state[1:], rates[1:], acceleration) if Channel.JOINT_FORCE in channels else {}
    recorded = {channel.value: Signal(times, values) for channel, values in signals.items() if channel in channels}
    return History(**recorded, joint_force={name: Signal(times, values) for name, values in forces.items()})
