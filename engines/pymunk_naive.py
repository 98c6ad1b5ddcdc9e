"""The scene as a newcomer would run it: pymunk's defaults wherever it has any, every read-out taken at face value."""

from __future__ import annotations

import math
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from engines.contract import Channel, Free, History, Scene, Signal
from engines.pymunk_checks import check_joints
from engines.pymunk_doubt import Pass
from engines.pymunk_layout import Layout, plain_layout
from engines.pymunk_load_sums import loads_on_parts
from engines.pymunk_loads import StepLoads
from engines.pymunk_reactions import joint_forces
from engines.pymunk_space import World, add_motor, add_torque, build_world
from engines.pymunk_stepping import public_calls

Array = NDArray[np.float64]

STEP = 1e-4  # s

# A joint open by this share of the scene's size is the end of a naive run; less is for its reader to see.
TORN_JOINT = 0.1


def naive_pass(scene: Scene) -> Pass:
    """One pass at 1e-4 s.

    The motor is given the crank's speed of the moment, everything read after a step is put at the end of that step, and
    the drive torque is the motor's impulse over the step, of which pymunk tells the size alone. Raises DivergedError.
    """
    begun = perf_counter()
    layout = plain_layout(scene)
    world = build_world(scene, layout, iterations=None, error_bias=None, native_damping=True)
    for body, part in zip(world.bodies, layout.parts, strict=True):
        owner = scene.bodies[part.owner]
        body.velocity = owner.velocity
        body.angular_velocity = 0.0 if part.inertia is None else owner.angular_velocity
    built = perf_counter() - begun
    begun = perf_counter()
    seen, torque = _stepped(scene, world)
    seconds = perf_counter() - begun
    check_joints(STEP * np.arange(len(seen), dtype=np.float64), seen, layout, TORN_JOINT)
    return Pass(STEP, _history(scene, layout, seen, torque), seconds, built, len(torque))


def _stepped(scene: Scene, world: World) -> tuple[Array, Array]:
    """States (n + 1, bodies, 2, 3), the start's first, and the drive's torques (n,)."""
    drive = scene.drive
    motor = None
    if isinstance(drive, Free):
        count = math.ceil(drive.duration / STEP)
        rates = [0.0] * count
        if drive.torque:
            add_torque(world, world.crank, drive.torque)
    else:
        count = math.ceil(drive.motion.duration / STEP * (1.0 - 1e-9))
        rates = (-drive.motion.speed(STEP * np.arange(count))).tolist()
        motor = add_motor(world)
    on = public_calls(world, motor)
    loads = StepLoads(world, scene, STEP, ahead=False)
    on.look()
    impulses = []
    for rate in rates:
        if loads:
            loads()
        on.set_rate(rate)
        on.step(STEP)
        on.look()
        impulses.append(on.impulse())
    torque = np.full(count, drive.torque) if isinstance(drive, Free) else np.array(impulses) / STEP
    return on.collected(), torque


def _history(scene: Scene, layout: Layout, seen: Array, torque: Array) -> History:
    times = STEP * np.arange(1, len(seen), dtype=np.float64)
    state, rates = seen[:, :, 0], seen[:, :, 1]
    acceleration = np.diff(rates, axis=0) / STEP
    forces = {}
    if Channel.JOINT_FORCE in scene.channels:
        load = loads_on_parts(scene, layout, state[1:], rates[1:])
        found = joint_forces(layout, state[1:], acceleration, load)
        forces = {name: Signal(times, values) for name, values in found.items()}

    def signal(channel: Channel, values: Array) -> Signal | None:
        return Signal(times, values) if channel in scene.channels else None

    return History(
        position=signal(Channel.POSITION, state[1:]),
        velocity=signal(Channel.VELOCITY, rates[1:]),
        acceleration=signal(Channel.ACCELERATION, acceleration),
        torque=signal(Channel.TORQUE, torque),
        joint_force=forces,
    )
