"""One pass in pymunk: a space without shapes, what has to be set before every step, and what is read after it.

A step of pymunk first moves the bodies, then evaluates forces and solves for velocities: after it the positions are
those of tₙ, the velocities those of tₙ + h/2, impulses over h the loads at tₙ. From sample to sample there is an odd
number of steps, so that passes of different step share the samples as well as the middles between them: velocities live
on the middles, and the acceleration at a sample is (v⁺ − v⁻)/h across it.

Loads set before a step have to be those of the positions that it will reach: the present ones moved on by the present
velocities. Velocities at that instant lie half a step ahead of the last ones known and are extrapolated from the last
two, 1.5 v₁ − 0.5 v₂: dampers are of second order. Constant torques are set once, since a step of pymunk takes about as
long as ten of its properties. A newcomer's run, which is not ``centred``, sets what holds now,
leaves damping to pymunk and takes every read-out for that of the step's end.

Data are the adapter's ``model``, in SI or the scene's own units. A course has one part of the motion, with its ``end``,
s, and a number of ``samples``, ``ratio`` steps to a sample, the ``channels`` to record and ``details`` to report in.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk import batch

from engines.shared_loop import law_values, motion_values

Array = NDArray[np.float64]
Data = dict[str, Any]
Point = tuple[float, float]
Load = Callable[[float], None]  # sets a load for the next step, which takes so many seconds

# Steps that have no good impulses to begin with, and how many times as many iterations they get.
COLD_STEPS, COLD = 4, 10
OUT_OF_REACH = 1e12  # rad/s, a speed that no motor of limited torque attains
CLOCK_ROUNDING = 1e-6  # of a sample: passes of different step leave out the same samples at a kink
MOTOR = "the motor"  # beside the names of joints
STATE = batch.BodyFields.POSITION | batch.BodyFields.ANGLE | batch.BodyFields.VELOCITY
STATE |= batch.BodyFields.ANGULAR_VELOCITY
BUFFER = batch.Buffer()  # pymunk never frees one


def arm(body: pymunk.Body, anchor: Point, ahead: float) -> pymunk.Vec2d:
    """The vector, m, ground frame, from a body's centre to a point of it, ``ahead`` s from now at its present spin."""
    return pymunk.Vec2d(*anchor).rotated(body.angle + ahead * body.angular_velocity)


def is_steady_torque(law: Any) -> bool:  # noqa: ANN401
    """Whether a load's law, in plain data, is a torque that does not change: a list of one number."""
    return isinstance(law, list) and len(law) == 1


class Line:
    """The line between two points of bodies."""

    def __init__(self, first: pymunk.Body, second: pymunk.Body, here: Point, there: Point) -> None:
        """The line between a point ``here`` of the first body, in its frame, and a point ``there`` of the second."""
        self.ends = (first, here), (second, there)

    def length(self, ahead: float) -> float:
        """Length, m, ``ahead`` seconds from now at the present velocities."""
        return math.dist(*(b.position + ahead * b.velocity + arm(b, anchor, ahead) for b, anchor in self.ends))

    def push(self, force: float, ahead: float) -> None:
        """Push both ends apart by a force, N, in the next step, in the direction ``ahead`` seconds from now."""
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
        """Build pymunk's space from the adapter's data."""
        self.given, self.space = given, pymunk.Space()
        self.counts = given["iterations"] or [self.space.iterations]
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
        self.line = given["line"] and Line(*(ends[n] for n, _ in given["line"]), *(point for _, point in given["line"]))
        self.crank = self.space.static_body if self.line else ends[given["crank"]]
        self.motor = self.drive() if given["motion"] else None
        if self.motor is not None:
            self.constraints.append(self.motor)  # last, so that an iteration leaves no error in the crank's speed
        for constraint in self.constraints if centred else ():
            constraint.error_bias = 0.0
        springs = [pymunk.DampedSpring(ends[a], ends[b], *rest) for a, b, *rest in given["springs"]]
        if not centred:
            springs += [pymunk.DampedRotarySpring(ends[a], ends[b], 0.0, 0.0, each) for a, b, each in given["dampers"]]
        loads = [load for load in given["loads"] if load[0] >= 0]
        steady = [(ends[body], law[0]) for body, _, law in loads if is_steady_torque(law)]
        if not self.is_pushed:
            steady.append((self.crank, given["push"][0] + given["offset"]))
        self.space.add(*self.bodies, *springs, *(self.steady_torque(*each) for each in steady), *self.constraints)
        self.loads: list[Load] = [self.load(*load) for load in loads if not is_steady_torque(load[2])]
        if centred:
            self.loads += [self.damper(ends[a], ends[b], each) for a, b, each in given["dampers"]]
            self.loads += [self.dashpot(spring) for spring in springs if spring.damping]

    def drive(self) -> Any:  # noqa: ANN401
        """Create and return the constraint that prescribes the driver, a motor or a pin joint, not yet in the space."""
        if self.line is None:
            return pymunk.SimpleMotor(self.space.static_body, self.crank, 0.0)
        (first, here), (second, there) = self.line.ends
        return pymunk.PinJoint(first, second, here, there)

    def travel(self, ahead: float) -> float:
        """φ ``ahead`` seconds from now at the present velocities: a crank's angle, rad, or a travel or length, m."""
        if self.line is not None:
            return self.line.length(ahead) - float(self.given["base"])
        return float(self.crank.angle + ahead * self.crank.angular_velocity)

    def iterations(self) -> int:
        """Iterations of pymunk's solver in the next step, by the driver's place.

        Raises ArithmeticError if that is not finite.
        """
        travelled = self.travel(0.0) - self.given["start"]
        if not math.isfinite(travelled):
            raise ArithmeticError("the driver's position is not finite")
        return int(self.counts[round(travelled / self.given["apart"]) % len(self.counts)])

    def load(self, number: int, anchor: Point, law: Any) -> Load:  # noqa: ANN401
        """A function that adds a force at an anchor, m, or a torque to the body of this number for the next step.

        It takes the seconds from now at which φ and the anchor are taken. ``law`` is plain data: a list of two
        components, N, ground frame, or one, N m, or knots, cubics and a period over φ.
        """
        body = self.ends[number]

        def add(ahead: float) -> None:
            """Add the load to its body for the next step, as it is ``ahead`` seconds from now."""
            values = law_values(law, self.travel(ahead))
            if len(values) == 1:
                body.torque += values[0]
            else:
                body.apply_force_at_world_point(values, body.position + arm(body, anchor, ahead))

        return add

    @property
    def is_pushed(self) -> bool:
        """Whether the drive's load must be set before every step: it changes in time, or is along a line."""
        return self.line is not None or self.given["push"][1] is not None

    def steady_torque(self, body: pymunk.Body, torque: float) -> pymunk.SimpleMotor:
        """Create a constant torque, N m, on a body, not yet in the space.

        It is a motor with this limit that never reaches its speed.
        """
        motor = pymunk.SimpleMotor(self.space.static_body, body, -math.copysign(OUT_OF_REACH, torque))
        motor.max_force = abs(torque)
        return motor

    def driver_load(self, times: Array) -> Load:
        """A function that adds the load on a free driver, N m or N, and any offset, for the next step.

        Each call takes the value at the next of ``times`` (n,), s, n calls at most; it is given the seconds from now at
        which a line's direction is taken.
        """
        torque, over_time = self.given["push"]
        crank, line = self.crank, self.line
        values = np.full(len(times), torque + self.given["offset"])
        if over_time:
            values += np.interp(times, *over_time)
        coming = iter(values.tolist())

        def add(ahead: float) -> None:
            """Add the next value of the load to the driver for the next step."""
            if line is None:
                crank.torque += next(coming)
            else:
                line.push(next(coming), ahead)

        return add

    def damper(self, first: pymunk.Body, second: pymunk.Body, coefficient: float) -> Load:
        """A function, to be called before each step, that adds a damper's torque, N m, to two bodies for that step.

        Either body may be the ground; ``coefficient`` is in N m s. Its argument, seconds, is not used.
        """
        last = None
        # An assignment to a body's attribute takes twice as long as its property's own setter.
        turning, torque_of = pymunk.Body.angular_velocity.fget, pymunk.Body.torque.fget
        set_torque = pymunk.Body.torque.fset
        body, *others = (end for end in (first, second) if end in self.bodies)

        def add(_ahead: float) -> None:
            """Add the damper's torque to both bodies for the next step, extrapolated from the last two rates."""
            nonlocal last
            rate = turning(body)
            for other in others:
                rate -= turning(other)
            torque = coefficient * (rate if last is None else 1.5 * rate - 0.5 * last)
            last = rate
            set_torque(body, torque_of(body) - torque)
            for other in others:
                set_torque(other, torque_of(other) + torque)

        return add

    def dashpot(self, spring: pymunk.DampedSpring) -> Load:
        """A function, to be called before each step, that adds a spring's damping for it, to second order.

        It takes the step, s. The spring's own ``damping`` is set to 0.
        """
        line, damping = Line(spring.a, spring.b, spring.anchor_a, spring.anchor_b), spring.damping
        spring.damping = 0.0
        lengths: list[float] = []

        def add(ahead: float) -> None:
            """Push the spring's ends against the rate of its length in the next step."""
            if not lengths:
                lengths.extend((line.length(-ahead), line.length(0.0)))
            before, last, now = *lengths, line.length(ahead)
            lengths[:] = last, now
            line.push(-damping * (3.0 * now - 4.0 * last + before) / (2.0 * ahead), ahead)

        return add


def driver_speeds(
    motion: Sequence[tuple[float, Sequence[float]]] | None, centred: bool, step: float, count: int
) -> Array:
    """Speed of the driver in each of ``count`` steps, rad/s or m/s; zeros for a free one.

    It is the mean over the step, ``step`` s long, or a newcomer's, not ``centred``: that at the step's start. A motion
    is pairs of a start, s, and coefficients, lowest power first.
    """
    if motion is None:
        return np.zeros(count)
    nodes, shares = np.polynomial.legendre.leggauss(4) if centred else (-np.ones(1), np.full(1, 2.0))
    times = step * (np.arange(count)[:, None] + 0.5 * (nodes + 1.0))
    speeds = [(start, np.polynomial.polynomial.polyder(coefficients)) for start, coefficients in motion]
    return np.asarray(motion_values(speeds, times) @ (0.5 * shares))


def build(model: Data) -> PymunkWorld:
    """The world of a model, the adapter's data, in its start state, but for the velocities."""
    return PymunkWorld(model)


def follow(world: PymunkWorld, course: Data) -> Data:
    """Step through the one part of a course and return its samples: times, s, and values by channel.

    Forces by joint are under "joint_force", sizes alone, N. Adds the iterations to the course's ``details``. Raises
    ArithmeticError where the driver's position is not finite.
    """
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
    stops = samples, looks, loaded if read else samples[:0]
    seen, impulses, counts = take_steps(world, step, rates, stops, [*read.values()])
    fewest, most = min(counts), max(counts)
    course["details"]["iterations"] = most if fewest == most else f"{fewest} to {most}"
    forces = {name: (step * loaded, values) for name, values in zip(read, impulses.T / step, strict=True)}
    result: Data = {}
    if MOTOR in forces:
        times, torque = forces.pop(MOTOR)
        result["torque"] = times, given["offset"] - torque if centred else torque

    def state(steps: Any, ahead: float = 0.0, rates_of: Any = None) -> tuple[Array, Array]:  # noqa: ANN401
        """Positions of bodies after these steps, and velocities ``ahead`` s later, each (steps, bodies, 3).

        ``rates_of`` are the numbers of other steps, of as many, for the velocities.
        """
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
    """Which of the times (n,), s, are far enough from every kink, as truth values (n,).

    A kink is its time, s, and how many samples, ``spacing`` s apart, are far enough.
    """
    smooth = np.ones(len(times), dtype=bool)
    for kink, apart in kinks:
        smooth &= np.abs(times - kink) >= (apart - CLOCK_ROUNDING) * spacing
    return smooth


def take_steps(
    world: PymunkWorld, step: float, rates: Array, stops: tuple[Array, Array, Array], read: list[pymunk.Constraint]
) -> tuple[Array, Array, list[int]]:
    """Take all steps; after those of ``stops`` iterations are chosen, states and impulses are read, in this order.

    ``stops`` are three arrays of numbers of steps, 0 being the start; ``read`` are the constraints with the impulses.
    Returns x, y, θ and their rates, (looks, parts, 2, 3), impulses, (loaded, constraints), and iterations, (samples,).
    A motor's rate is that of the step to come: it sets the velocity with which the next step moves the bodies. Of a
    linear drive it is the distance of its ends after that step. ``rates`` has the driver's speed in every step and one
    more. Raises ArithmeticError where the driver's position is not finite.
    """
    space, motor, given = world.space, world.motor, world.given
    if world.line is None:
        drive, values = pymunk.SimpleMotor.rate.fset, -rates
    else:
        drive, values = pymunk.PinJoint.distance.fset, given["base"] + given["start"] + step * np.cumsum(rates)
    coming = (values[1:] if given["centred"] else values[:-1]).tolist()
    cold, ahead = (COLD_STEPS, step) if given["centred"] else (0, 0.0)
    loads = [*world.loads]
    if world.is_pushed:
        loads.append(world.driver_load(ahead + step * np.arange(len(coming), dtype=np.float64)))
    is_sample, is_seen, is_read = (set(steps.tolist()) for steps in stops)
    seen, impulses, counts = list[bytes](), list[float](), list[int]()
    begin = 0
    for end in sorted({cold, len(coming)} | is_sample | is_seen | is_read):
        for value in coming[begin:end]:
            for load in loads:
                load(ahead)
            if motor is not None:
                drive(motor, value)
            space.step(step)
        begin = end
        if end in is_seen:
            seen.append(body_states(space))
        if end in is_read:
            impulses.extend([constraint.impulse for constraint in read])
        if end in is_sample:
            counts.append(world.iterations())
        space.iterations = counts[-1] * (COLD if end < cold else 1)
    states = np.frombuffer(b"".join(seen)).reshape(len(seen), len(world.ends), 2, 3)  # the static body comes last
    return states, np.array(impulses).reshape(len(is_read), len(read)), counts[:-1]


def body_states(space: pymunk.Space) -> bytes:
    """Place, m, angle, rad, and their rates of all bodies, the static one last, as bytes of six doubles each."""
    BUFFER.clear()
    batch.get_space_bodies(space, STATE, BUFFER)
    return bytes(BUFFER.float_buf())


def centre_motion(offsets: list[complex], place: Array, rate: Array, ahead: float) -> tuple[Array, Array]:
    """Positions of bodies from those of the parts that carry them, and velocities ``ahead`` s later, (n, bodies, 3).

    ``place`` and ``rate``, (n, parts, 3), are x, y and angle of the parts and their rates; those that carry bodies come
    first. ``offsets``, in their frames, m, lead from their centres to the bodies' mass centres.
    """
    place, rate = place[:, : len(offsets)].copy(), rate[:, : len(offsets)].copy()
    for values, arms in (
        (place, offsets * np.exp(1j * place[..., 2])),
        (rate, 1j * rate[..., 2] * offsets * np.exp(1j * (place[..., 2] + ahead * rate[..., 2]))),
    ):
        values[..., 0] += arms.real
        values[..., 1] += arms.imag
    return place, rate


def set_start_velocities(world: PymunkWorld, rate: float, step: float) -> None:
    """Give the parts the velocities of the start or, if ``centred``, those of the first step's middle.

    ``step`` is in s, ``rate`` the driver's prescribed speed in it, rad/s or m/s; of a free one its start's acceleration
    counts. These are the motion's tangent at the start, at the speed in the middle of the step: the first step then
    opens the joints as every later step does, and the next one closes them as later ones do.
    """
    speed, gain = world.given["driver_rates"]
    if world.given["centred"]:
        speed = speed + 0.5 * step * gain if world.motor is None else rate
    for body, (x, y), turn in zip(world.bodies, *world.given["tangent"], strict=True):
        body.velocity, body.angular_velocity = (speed * x, speed * y), speed * turn if body.moment < math.inf else 0.0
