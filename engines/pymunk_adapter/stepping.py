"""Stepping a world: driving the crank, and reading the parts' state back in one buffer for the whole run.

pymunk moves the bodies first and solves for velocities then, so after a step the positions are those of tₙ, the
velocities those of tₙ + h/2, and impulses over h the loads at tₙ.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from analytic.description.linkage import GROUND
from engines.mechanics.states import body_numbers
from engines.pymunk_adapter.layout import Gear, PartLayout
from engines.pymunk_adapter.space import World
from engines.stepping.driver import DivergedError

if TYPE_CHECKING:
    import pymunk

Array = NDArray[np.float64]

# Crank moves of one step while a world is put at an angle, rad: small enough for the joints to follow.
PLACING_STEP = 0.1

# A crank further than this from where it was last put, rad, has been thrown there.
LARGEST_WAY = 1e3

# Steps after which full turns are taken off the angles.
UNWINDING = 500

# Steps at rest after a move, in which the joints close (they do so quadratically).
SETTLING_STEPS = 4


@dataclass(frozen=True)
class Calls:
    """The calls a run consists of.

    ``look`` notes every part's x, y, θ and their rates; ``collected`` hands over what was noted since it was last
    called, (looks, parts, 2, 3).
    """

    step: Callable[[float], object]
    set_rate: Callable[[float], object]
    impulse: Callable[[], float]
    look: Callable[[], object]
    collected: Callable[[], Array]


def calls(world: World, motor: pymunk.SimpleMotor | None) -> Calls:
    """The C functions behind pymunk's methods where this version has them as known, else the methods.

    The methods do housekeeping at every step (late removals, callbacks, type checks) that a space nobody touches does
    not need; without them a step of a small linkage takes about two thirds of the time. Results are identical.
    """
    try:
        return direct_calls(world, motor)
    except (ImportError, AttributeError):
        return public_calls(world, motor)


def public_calls(world: World, motor: pymunk.SimpleMotor | None) -> Calls:
    """The calls through pymunk's documented attributes."""
    values: list[float] = []

    def look() -> None:
        for body in world.bodies:
            values.extend((*body.position, body.angle, *body.velocity, body.angular_velocity))

    def set_rate(rate: float) -> None:
        if motor is not None:
            motor.rate = rate

    def collected() -> Array:
        result = np.array(values).reshape(-1, len(world.bodies), 2, 3)
        values.clear()
        return result

    return Calls(
        step=world.space.step,
        set_rate=set_rate,
        impulse=lambda: 0.0 if motor is None else float(motor.impulse),
        look=look,
        collected=collected,
    )


def direct_calls(world: World, motor: pymunk.SimpleMotor | None) -> Calls:
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

    handle = None if motor is None else motor._constraint
    return Calls(
        step=partial(lib.cpSpaceStep, space),
        set_rate=(lambda _rate: None) if motor is None else partial(lib.cpSimpleMotorSetRate, handle),
        impulse=(lambda: 0.0) if motor is None else partial(lib.cpConstraintGetImpulse, handle),
        look=look,
        collected=collected,
    )


def march(
    on: Calls, step: float, rates: Iterable[float], looks: Iterable[int], loads: Callable[[], None] | None
) -> list[float]:
    """Take one step per rate and look after those marked; returns the drive's impulses there, N m s.

    A rate is that of the step to come: it sets the velocity with which the next step moves the bodies.
    """
    take, set_rate, impulse, look = on.step, on.set_rate, on.impulse, on.look
    impulses = []
    for rate, wanted in zip(rates, looks, strict=True):
        if loads is not None:
            loads()
        set_rate(rate)
        take(step)
        if wanted:
            look()
            impulses.append(impulse())
    return impulses


def march_wound(
    world: World,
    on: Calls,
    step: float,
    *,
    rates: Sequence[float],
    looks: Sequence[int],
    loads: Callable[[], None] | None,
) -> tuple[Array, list[float]]:
    """Like ``march``, in parts before each of which full turns are taken off the angles; returns what was seen as well.

    Angles that grow lose digits turn by turn, the same rounding again and again at a constant speed: after a thousand
    turns the crank is off by 1e-6 rad and accelerations carry the last digit of the angle over the step squared.
    """
    together = geared(world.layout)
    turns = np.zeros(len(world.bodies))
    seen, impulses = [on.collected().copy()], []
    for start in range(0, len(rates), UNWINDING):
        part = slice(start, start + UNWINDING)
        turns += _unwind(world, together)
        impulses += march(on, step, rates[part], looks[part], loads)
        look = on.collected().copy()
        look[:, :, 0, 2] += FULL_TURN * turns
        seen.append(look)
    for body, turned in zip(world.bodies, turns.tolist(), strict=True):
        body.angle += FULL_TURN * turned
    return np.concatenate(seen), impulses


def geared(layout: PartLayout) -> list[list[int]]:
    """The parts by number, those together that gears keep at fixed angles to each other."""
    group, numbers = list(range(len(layout.parts))), body_numbers(layout.scene)
    for hold in layout.holds:
        if isinstance(hold, Gear) and hold.host != GROUND:
            old, new = group[numbers[hold.host]], group[numbers[hold.body]]
            group = [new if own == old else own for own in group]
    return [[number for number, own in enumerate(group) if own == chosen] for chosen in sorted(set(group))]


def _unwind(world: World, together: Sequence[Sequence[int]]) -> Array:
    """Take the full turns off the angles, parts that turn together alike; returns how many they were."""
    turns = np.zeros(len(world.bodies))
    for parts in together:
        angle = world.bodies[parts[0]].angle
        if abs(angle) > FULL_TURN and math.isfinite(angle):
            turns[list(parts)] = full = round(angle / FULL_TURN)
            for number in parts:
                world.bodies[number].angle -= FULL_TURN * full
    return turns


def place(world: World, on: Calls, step: float, angle: float, settling: int = SETTLING_STEPS) -> int:
    """Bring the crank to an angle and everything to rest there; returns the steps it took. Raises DivergedError."""
    rates = [0.0, 0.0]  # the first of them still moves with the old velocities
    _rest(on, step, rates)
    taken = len(rates)
    way = angle - world.crank.angle
    if not abs(way) < LARGEST_WAY:
        raise DivergedError(f"the crank got to an angle of {world.crank.angle:.3g} rad instead of {angle:.3g} rad")
    moves = max(1, math.ceil(abs(way) / PLACING_STEP))
    rates = [-way / moves / step] * moves + [0.0] * settling
    _rest(on, step, rates)
    return taken + len(rates)


def _rest(on: Calls, step: float, rates: list[float]) -> None:
    for rate in rates:
        on.set_rate(rate)
        on.step(step)
