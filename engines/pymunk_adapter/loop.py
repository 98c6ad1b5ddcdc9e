"""One pass in pymunk: a space without shapes, its loads set before every step, and what is read after it.

A step of pymunk first moves the bodies, then evaluates forces and solves for velocities: after it the positions are
those of tₙ, the velocities those of tₙ + h/2, impulses over h the loads at tₙ. From sample to sample there is an odd
number of steps, so that passes of different step share the samples as well as the middles between them: velocities live
on the middles, and the acceleration at a sample is (v⁺ − v⁻)/h across it.

Loads set before a step have to be those of the positions that it will reach: the present ones moved on by the present
velocities. Velocities at that instant lie half a step ahead of the last ones known and are extrapolated from the last
two, 1.5 v₁ − 0.5 v₂: dampers are of second order. A newcomer's run, which is not ``centred``, sets what holds now,
leaves damping to pymunk and takes every read-out for that of the step's end.
"""

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk import batch

Array = NDArray[np.float64]
Data = dict[str, Any]
Point = tuple[float, float]
Load = Callable[[float], None]  # sets a load for the next step, which takes so many seconds

# Steps that have no good impulses to begin with, and how many times as many iterations they get.
COLD_STEPS, COLD = 4, 10
CLOCK_ROUNDING = 1e-6  # of a sample: passes of different step leave out the same samples at a kink
MOTOR = "the motor"  # beside the names of joints
STATE = batch.BodyFields.POSITION | batch.BodyFields.ANGLE | batch.BodyFields.VELOCITY
STATE |= batch.BodyFields.ANGULAR_VELOCITY
BUFFER = batch.Buffer()  # pymunk never frees one


def law_values(law: Any, angle: float) -> Any:  # noqa: ANN401
    """A load's components at an angle or a travel: constants, or cubics that repeat or keep their end values."""
    if isinstance(law, list):
        return law
    knots, pieces, repeats = law
    angle = knots[0] + (angle - knots[0]) % (2.0 * math.pi) if repeats else min(max(angle, knots[0]), knots[-1])
    piece = min(bisect_right(knots, angle), len(pieces)) - 1
    x = angle - knots[piece]
    return [a + x * (b + x * (c + x * d)) for a, b, c, d in pieces[piece]]


def arm(body: pymunk.Body, anchor: Point, ahead: float) -> pymunk.Vec2d:
    """From a body's centre to a point of it, a time ahead at the present velocity."""
    return pymunk.Vec2d(*anchor).rotated(body.angle + ahead * body.angular_velocity)


class Rod:
    """The line between two points of bodies."""

    def __init__(self, first: pymunk.Body, second: pymunk.Body, here: Point, there: Point) -> None:
        self.ends = (first, here), (second, there)

    def length(self, ahead: float) -> float:
        """Length, m, ``ahead`` seconds from now at the present velocities."""
        return math.dist(*(b.position + ahead * b.velocity + arm(b, anchor, ahead) for b, anchor in self.ends))

    def push(self, force: float, ahead: float) -> None:
        """Push its ends apart by a force, N, in the next step."""
        (first, here), (second, there) = self.ends
        arms = arm(first, here, ahead), arm(second, there, ahead)
        between = first.position - second.position + ahead * (first.velocity - second.velocity) + arms[0] - arms[1]
        for body, lever, sign in zip((first, second), arms, (1.0, -1.0), strict=True):
            body.apply_force_at_world_point(sign * force * between.normalized(), body.position + lever)


class PymunkWorld:
    """A space in its start state, but for the velocities; ``ends`` has the bodies by number, the ground at -1.

    The ``motor`` is the drive: it works against a torque that keeps the sign of its own, as pymunk gives the
    size alone. That of a linear drive is a pin joint, whose distance is set before every step: after the step to come
    its ends are as far apart. ``line`` is between the ends of a linear driver, prescribed or free.
    """

    def __init__(self, given: Data) -> None:
        self.given, self.space, self.time = given, pymunk.Space(), 0.0
        self.space.gravity = given["gravity"]
        self.bodies = []
        for mass, inertia, position, angle in given["bodies"]:
            body = pymunk.Body(mass, math.inf if inertia is None else inertia)
            body.position, body.angle = position, angle
            self.bodies.append(body)
        ends = self.ends = [*self.bodies, self.space.static_body]
        centred = given["centred"]
        given_ones = given["constraints"]
        self.constraints = [getattr(pymunk, kind)(ends[a], ends[b], *rest) for kind, a, b, *rest in given_ones]
        self.line = given["line"] and Rod(*(ends[n] for n, _ in given["line"]), *(point for _, point in given["line"]))
        self.crank = self.space.static_body if self.line else ends[given["crank"]]
        self.motor = self.drive() if given["motion"] else None
        if self.motor is not None:
            self.constraints.append(self.motor)  # last, so that an iteration leaves no error in the crank's speed
        for constraint in self.constraints if centred else ():
            constraint.error_bias = 0.0
        springs = [pymunk.DampedSpring(ends[a], ends[b], *rest) for a, b, *rest in given["springs"]]
        if not centred:
            springs += [pymunk.DampedRotarySpring(ends[a], ends[b], 0.0, 0.0, each) for a, b, each in given["dampers"]]
        self.space.add(*self.bodies, *springs, *self.constraints)
        self.loads: list[Load] = [self.load(*load) for load in given["loads"] if load[0] >= 0]
        torque, over_time = given["push"]
        if torque + given["offset"] or over_time:
            self.loads.append(self.driver_load(torque + given["offset"], over_time))
        if centred:
            self.loads += [self.damper(ends[a], ends[b], each) for a, b, each in given["dampers"]]
            self.loads += [self.dashpot(spring) for spring in springs if spring.damping]

    def drive(self) -> Any:  # noqa: ANN401
        """The constraint that prescribes the driver."""
        if self.line is None:
            return pymunk.SimpleMotor(self.space.static_body, self.crank, 0.0)
        (first, here), (second, there) = self.line.ends
        return pymunk.PinJoint(first, second, here, there)

    def travel(self, ahead: float) -> float:
        """φ ``ahead`` seconds from now at the present velocities: a crank's angle, rad, or a travel or length, m."""
        if self.line is not None:
            return self.line.length(ahead) - float(self.given["base"])
        return float(self.crank.angle + ahead * self.crank.angular_velocity)

    def load(self, number: int, anchor: Point, law: Any) -> Load:  # noqa: ANN401
        """A force at an anchor, or a torque, which has one component; over φ, or constant."""
        body = self.ends[number]

        def add(ahead: float) -> None:
            values = law_values(law, self.travel(ahead))
            if len(values) == 1:
                body.torque += values[0]
            else:
                body.apply_force_at_world_point(values, body.position + arm(body, anchor, ahead))

        return add

    def driver_load(self, size: float, over_time: tuple[Sequence[float], Sequence[float]] | None) -> Load:
        """The load on a free driver, or against a motor: a torque on a crank, a force along a linear driver."""
        crank, line = self.crank, self.line

        def add(ahead: float) -> None:
            now = size + float(np.interp(self.time + ahead, *over_time)) if over_time else size
            if line is None:
                crank.torque += now
            else:
                line.push(now, ahead)

        return add

    def damper(self, first: pymunk.Body, second: pymunk.Body, coefficient: float) -> Load:
        """A torque against the bodies' turning against each other."""
        last = None

        def add(_ahead: float) -> None:
            nonlocal last
            rate = first.angular_velocity - second.angular_velocity
            torque = coefficient * (rate if last is None else 1.5 * rate - 0.5 * last)
            last = rate
            first.torque -= torque
            second.torque += torque

        return add

    def dashpot(self, spring: pymunk.DampedSpring) -> Load:
        """The damping of a spring, which pymunk has to first order, its speed from the lengths at three instants."""
        rod, damping = Rod(spring.a, spring.b, spring.anchor_a, spring.anchor_b), spring.damping
        spring.damping = 0.0
        lengths: list[float] = []

        def add(ahead: float) -> None:
            if not lengths:
                lengths.extend((rod.length(-ahead), rod.length(0.0)))
            before, last, now = *lengths, rod.length(ahead)
            lengths[:] = last, now
            rod.push(-damping * (3.0 * now - 4.0 * last + before) / (2.0 * ahead), ahead)

        return add


def driver_speeds(
    motion: Sequence[tuple[float, Sequence[float]]] | None, centred: bool, step: float, count: int
) -> Array:
    """Speed of the driver in so many steps, rad/s or m/s; zeros for a free one.

    It is the mean over the step by Gauss's quadrature, or a newcomer's: that at the step's start.
    """
    if motion is None:
        return np.zeros(count)
    nodes, shares = np.polynomial.legendre.leggauss(4) if centred else (-np.ones(1), np.full(1, 2.0))
    times = step * (np.arange(count)[:, None] + 0.5 * (nodes + 1.0))
    piece = np.searchsorted([start for start, _ in motion[1:]], times, side="right")
    result = np.zeros(times.shape)
    for number, (start, coefficients) in enumerate(motion):
        here = piece == number
        result[here] = np.poly1d(coefficients[::-1]).deriv()(times[here] - start)
    return np.asarray(result @ (0.5 * shares))


def build(model: Data) -> PymunkWorld:
    """The world of a model."""
    return PymunkWorld(model)


def follow(world: PymunkWorld, course: Data) -> Data:
    """The samples of a course, which is one part."""
    given, channels, ratio, (part,) = world.given, course["channels"], course["ratio"], course["parts"]
    centred, samples = given["centred"], ratio * np.arange(part["samples"] + 1)
    step = part["end"] / int(samples[-1])
    middles, loaded = samples[1:-1] + (ratio - 1) // 2, samples[given["lead"] :]
    half = 0.5 * step if centred else 0.0
    if centred:
        middles = middles[is_smooth(step * middles + half, given["kinks"], ratio * step)]
        loaded = loaded[is_smooth(step * loaded, given["kinks"], ratio * step)]
    rates = driver_speeds(given["motion"], centred, step, samples[-1] + 1)
    set_start_velocities(world, float(rates[0]), step)
    read = {name: world.constraints[number] for name, number in given["joints"].items() if "joint_force" in channels}
    if world.motor is not None and "torque" in channels:
        read[MOTOR] = world.motor
    moving = {"position", "velocity", "acceleration"} & {*channels}
    looks = np.unique(np.concatenate([samples, middles, loaded - 1])) if moving else samples[:0]
    seen, impulses = take_steps(world, step, rates, (looks, loaded if read else samples[:0]), [*read.values()])
    course["details"]["iterations"] = int(world.space.iterations)
    course["solver_work"] += int(samples[-1]) * world.space.iterations * len(world.constraints)
    forces = {name: (step * loaded, values) for name, values in zip(read, impulses.T / step, strict=True)}
    result: Data = {}
    if MOTOR in forces:
        times, torque = forces.pop(MOTOR)
        result["torque"] = times, given["offset"] - torque if centred else torque

    def state(steps: Any, ahead: float = 0.0, rates_of: Any = None) -> tuple[Array, Array]:  # noqa: ANN401
        of, rate = (np.searchsorted(looks, each) for each in (steps, steps if rates_of is None else rates_of))
        return centre_motion(given["offsets"], seen[of, :, 0], seen[rate, :, 1], ahead)

    if "position" in moving:
        places = samples if centred else samples[1:]
        result["position"] = step * places, state(places)[0]
    if "velocity" in moving:
        times = middles if centred else samples[1:]
        result["velocity"] = step * times + half, state(times, half)[1]
    if "acceleration" in moving:
        change = state(loaded, half)[1] - state(loaded, -half, loaded - 1)[1]
        result["acceleration"] = step * loaded, change / step
    return result | {"joint_force": forces}


def is_smooth(times: Array, kinks: list[tuple[float, float]], spacing: float) -> Any:  # noqa: ANN401 - booleans
    """Which of the times (n,), s, are at least so many samples of a ``spacing``, s, from every kink."""
    smooth = np.ones(len(times), dtype=bool)
    for kink, apart in kinks:
        smooth &= np.abs(times - kink) >= (apart - CLOCK_ROUNDING) * spacing
    return smooth


def take_steps(
    world: PymunkWorld, step: float, rates: Array, marks: tuple[Array, Array], read: list[pymunk.Constraint]
) -> tuple[Array, Array]:
    """Take all steps; ``marks`` are those after which states and those after which impulses are read.

    Returns x, y, θ and their rates, (looks, parts, 2, 3), and impulses, (loaded, constraints).

    A motor's rate is that of the step to come: it sets the velocity with which the next step moves the bodies. Of a
    linear drive it is the distance of its ends after that step.
    """
    space, motor, loads, given = world.space, world.motor, world.loads, world.given
    if world.line is None:
        name, values = "rate", -rates
    else:
        name, values = "distance", given["base"] + given["start"] + step * np.cumsum(rates)
    coming = values[1:] if given["centred"] else values[:-1]
    is_seen, is_read = (np.isin(np.arange(len(rates)), steps).tolist() for steps in marks)
    seen, impulses = list[bytes](), list[float]()
    if is_seen[0]:
        seen.append(body_states(space))
    usual = space.iterations if given["iterations"] is None else given["iterations"]
    for number, value in enumerate(coming.tolist(), start=1):
        if number <= COLD_STEPS + 1 and given["centred"]:
            space.iterations = usual * COLD if number <= COLD_STEPS else usual
        elif number == 1:
            space.iterations = usual
        for load in loads:
            load(step if given["centred"] else 0.0)
        if motor is not None:
            setattr(motor, name, value)
        space.step(step)
        world.time += step
        if is_seen[number]:
            seen.append(body_states(space))
        if is_read[number]:
            impulses.extend([constraint.impulse for constraint in read])
    states = np.frombuffer(b"".join(seen)).reshape(len(seen), len(world.ends), 2, 3)  # the static body comes last
    return states, np.array(impulses).reshape(len(marks[1]), len(read))


def body_states(space: pymunk.Space) -> bytes:
    """Places, angles and velocities of all bodies, as bytes."""
    BUFFER.clear()
    batch.get_space_bodies(space, STATE, BUFFER)
    return bytes(BUFFER.float_buf())


def centre_motion(offsets: list[complex], place: Array, rate: Array, ahead: float) -> tuple[Array, Array]:
    """Positions of mass centres from those of the parts that carry the bodies, and velocities ``ahead`` s later."""
    place, rate = place[:, : len(offsets)].copy(), rate[:, : len(offsets)].copy()
    for values, arms in (
        (place, offsets * np.exp(1j * place[..., 2])),
        (rate, 1j * rate[..., 2] * offsets * np.exp(1j * (place[..., 2] + ahead * rate[..., 2]))),
    ):
        values[..., 0] += arms.real
        values[..., 1] += arms.imag
    return place, rate


def set_start_velocities(world: PymunkWorld, rate: float, step: float) -> None:
    """Give the parts their velocities: those that bring them through the first step, or a newcomer's.

    The latter are those of the start. The former are the motion's tangent there, at the speed of the middle of the
    step: a step along it opens the joints as every later step does, and so the next one closes them as later ones do.
    """
    speed, gain = world.given["driver_rates"]
    if world.given["centred"]:
        speed = speed + 0.5 * step * gain if world.motor is None else rate
    for body, (x, y), turn in zip(world.bodies, *world.given["tangent"], strict=True):
        body.velocity, body.angular_velocity = (speed * x, speed * y), speed * turn if body.moment < math.inf else 0.0
