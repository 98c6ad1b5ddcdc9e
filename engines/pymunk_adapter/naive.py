"""The scene as a newcomer would run it: pymunk's defaults wherever it has any, every read-out taken at face value."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from engines.contract import History, Signal
from engines.pymunk_adapter.checks import check_finite, check_joints
from engines.pymunk_adapter.layout import PartLayout
from engines.pymunk_adapter.loads import StepLoads
from engines.pymunk_adapter.passes import count_steps
from engines.pymunk_adapter.plans import PlainPlan
from engines.pymunk_adapter.reactions import joint_forces
from engines.pymunk_adapter.space import World, add_motor, add_torque, build_world
from engines.pymunk_adapter.stepping import Calls, calls, march
from engines.scene import Channel, Free, Prescribed, Scene
from engines.stepping.cost import Cost
from engines.stepping.richardson import Pass

Array = NDArray[np.float64]


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
    forces = {}
    channels = layout.scene.channels
    if Channel.JOINT_FORCE in channels:
        reactions = joint_forces(layout, state[1:], rates[1:], acceleration)
        forces = {name: Signal(times, values) for name, values in reactions.items()}

    def signal(channel: Channel, values: Array) -> Signal | None:
        return Signal(times, values) if channel in channels else None

    return History(
        position=signal(Channel.POSITION, state[1:]),
        velocity=signal(Channel.VELOCITY, rates[1:]),
        acceleration=signal(Channel.ACCELERATION, acceleration),
        torque=signal(Channel.TORQUE, torque),
        joint_force=forces,
    )
