"""Stepping a world: driving the crank, and reading the parts' state back in one buffer for the whole run.

pymunk moves the bodies first and solves for velocities then, so after a step the positions are those of tₙ, the
velocities those of tₙ + h/2, and impulses over h the loads at tₙ.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from engines.pymunk_adapter.loads import StepLoads
from engines.pymunk_adapter.space import PymunkWorld

if TYPE_CHECKING:
    import pymunk

Array = NDArray[np.float64]

LOOK, LOADS = 1, 2  # what is read after a step, by its bits: the parts' state, the impulses


@dataclass(frozen=True)
class Calls:
    """The calls a run consists of.

    ``look`` notes every part's x, y, θ and their rates; ``collected`` hands over what was noted since it was last
    called, (looks, parts, 2, 3). ``impulses`` are those of the constraints to be read, N s or N m s.
    """

    step: Callable[[float], object]
    set_rate: Callable[[float], object]
    set_iterations: Callable[[int], object]
    impulses: tuple[Callable[[], float], ...]
    look: Callable[[], object]
    collected: Callable[[], Array]


def calls(world: PymunkWorld, read: Iterable[pymunk.Constraint]) -> Calls:
    """The C functions behind pymunk's methods where this version has them as known, else the methods.

    The methods do housekeeping at every step (late removals, callbacks, type checks) that a space nobody touches does
    not need; without them a step of a small linkage takes about two thirds of the time. Results are identical.
    """
    try:
        return direct_calls(world, read)
    except (ImportError, AttributeError):
        return public_calls(world, read)


def public_calls(world: PymunkWorld, read: Iterable[pymunk.Constraint]) -> Calls:
    """The calls through pymunk's documented attributes."""
    values: list[float] = []

    def look() -> None:
        for body in world.bodies:
            values.extend((*body.position, body.angle, *body.velocity, body.angular_velocity))

    def set_rate(rate: float) -> None:
        if world.line is not None and world.motor is not None:
            world.motor.distance = rate
        elif world.motor is not None:
            world.motor.rate = rate

    def set_iterations(count: int) -> None:
        world.space.iterations = count

    def collected() -> Array:
        result = np.array(values).reshape(-1, len(world.bodies), 2, 3)
        values.clear()
        return result

    impulses = tuple(partial(getattr, constraint, "impulse") for constraint in read)
    return Calls(world.space.step, set_rate, set_iterations, impulses, look, collected)


def direct_calls(world: PymunkWorld, read: Iterable[pymunk.Constraint]) -> Calls:
    """The calls through pymunk's C library; raises ImportError or AttributeError where it is not as expected."""
    from pymunk import batch
    from pymunk._chipmunk_cffi import ffi, lib

    fields = batch.BodyFields
    buffer, data = batch.Buffer(), ffi.new("pmBatchedData *")
    data.fields = (fields.POSITION | fields.ANGLE | fields.VELOCITY | fields.ANGULAR_VELOCITY).value
    data.floatArray, data.intArray = buffer._float_arr, buffer._int_arr
    reader = ffi.addressof(lib, "pmSpaceBodyGetIteratorFuncBatched")
    space, parts = world.space._space, len(world.bodies)
    look = partial(lib.cpSpaceEachBody, space, reader, data)
    look()
    columns = len(buffer.float_buf()) // (8 * 6)  # the static body comes last
    buffer.clear()

    def collected() -> Array:
        result = np.frombuffer(bytes(buffer.float_buf())).reshape(-1, columns, 2, 3)[:, :parts]
        buffer.clear()
        return result

    motor, set_rate = world.motor, lib.cpPinJointSetDist if world.line else lib.cpSimpleMotorSetRate
    return Calls(
        step=partial(lib.cpSpaceStep, space),
        set_rate=(lambda _rate: None) if motor is None else partial(set_rate, motor._constraint),
        set_iterations=partial(lib.cpSpaceSetIterations, space),
        impulses=tuple(partial(lib.cpConstraintGetImpulse, constraint._constraint) for constraint in read),
        look=look,
        collected=collected,
    )


def march(on: Calls, step: float, plan: Iterable[tuple[float, int, int]], loads: StepLoads) -> list[float]:
    """Take the steps of a plan: rate, iterations, and the mark of what is read then; returns the impulses in order.

    A rate is that of the step to come: it sets the velocity with which the next step moves the bodies. Of a linear
    drive it is the distance of its ends after that step.
    """
    take, set_rate, impulses, look = on.step, on.set_rate, on.impulses, on.look
    read: list[float] = []
    now, any_loads = 0, bool(loads)
    for rate, count, mark in plan:
        if any_loads:
            loads(step)
        if count != now:
            on.set_iterations(count)
            now = count
        set_rate(rate)
        take(step)
        if mark & LOOK:
            look()
        if mark & LOADS:
            read.extend([impulse() for impulse in impulses])
    return read
