"""One pass in pymunk: a space without shapes, its loads set before every step, and what is read after it.

A step of pymunk first moves the bodies, then asks for forces and solves for velocities: after it the positions are
those of tₙ, the velocities those of tₙ + h/2, impulses over h the loads at tₙ. From sample to sample there is an odd
number of steps, so that passes of different step share the samples as well as the middles between them: velocities live
on the middles, and the acceleration at a sample is (v⁺ − v⁻)/h across it.

What is set before a step has to be that of the positions it will reach: the present ones moved on by the present
velocities. Velocities at that instant lie half a step ahead of the last ones known and are extrapolated from the last
two, 1.5 v₁ − 0.5 v₂: dampers are of second order.
"""

import math
from bisect import bisect_right
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray

Array = NDArray[np.float64]
Numbers = NDArray[np.intp]
Data = dict[str, Any]
Point = tuple[float, float]

# Where a spring's far end lies, m or rad: any motion is nothing against it, so that its pull is constant to rounding.
FAR = 1e15
# Steps at a start or a jump that have no good impulses to begin with, and how many times as many iterations they get.
COLD_STEPS, COLD = 4, 10
WHOLE = 1.0 + 1e-9  # of the way that was looked at; a motion that goes on comes by the same angles again
MOTOR = "the motor"  # beside the names of joints
LOOK, LOADS = 1, 2  # what is read after a step, by its bits: the parts' state, the impulses


def at(law: Any, angle: float) -> Any:  # noqa: ANN401
    """A load's components at an angle or a travel: those of cubics between knots."""
    knots, pieces, repeats = law
    angle = knots[0] + (angle - knots[0]) % (2.0 * math.pi) if repeats else min(max(angle, knots[0]), knots[-1])
    piece = min(bisect_right(knots, angle), len(pieces)) - 1
    x = angle - knots[piece]
    return [a + x * (b + x * (c + x * d)) for a, b, c, d in pieces[piece]]


def span(ends: Iterable[tuple[pymunk.Body, Point]], ahead: float) -> float:
    """Distance of two points of bodies a time ahead at the present velocities."""
    places = []
    for body, (x, y) in ends:
        (px, py), (vx, vy), turn = body.position, body.velocity, body.angle + ahead * body.angular_velocity
        c, s = math.cos(turn), math.sin(turn)
        places.append((px + ahead * vx + c * x - s * y, py + ahead * vy + s * x + c * y))
    return math.dist(*places)


def set_push(spring: pymunk.DampedSpring, force: float) -> None:
    """Let a spring of FAR push its ends apart by a force, N."""
    spring.rest_length, spring.stiffness = math.copysign(FAR, force), abs(force) / FAR


class World:
    """A space in its start state, but for the velocities; ``ends`` has the bodies, the ground as -1.

    The ``motor`` is the drive: it works against a torque that keeps the sign of what it exerts, as pymunk tells the
    size alone. That of a linear drive is a pin joint, whose distance is set before every step: after the step to come
    its ends are as far apart. ``line`` are the ends of a linear driver, prescribed or free.
    """

    def __init__(self, given: Data) -> None:
        self.given, self.space = given, pymunk.Space()
        if any(given["gravity"]):
            self.space.gravity = given["gravity"]
        self.bodies = []
        for mass, inertia, position, angle in given["bodies"]:
            body = pymunk.Body(mass, math.inf if inertia is None else inertia)
            body.position, body.angle = position, angle
            self.bodies.append(body)
        ends = self.ends = [*self.bodies, self.space.static_body]
        self.springs = [pymunk.DampedSpring(ends[a], ends[b], *rest) for a, b, *rest in given["springs"]]
        self.constraints = [getattr(pymunk, kind)(ends[a], ends[b], *rest) for kind, a, b, *rest in given["holds"]]
        for constraint in self.constraints if given["centred"] else ():
            constraint.error_bias = 0.0
        pushes = [self.push(*push) for push in given["pushes"]]
        dampers = [] if given["centred"] else given["dampers"]
        drags = [pymunk.DampedRotarySpring(ends[a], ends[b], 0.0, 0.0, each) for a, b, each in dampers]
        self.space.add(*self.bodies, *self.springs, *pushes, *drags, *self.constraints)
        for number, torque in given["torques"]:
            if torque:  # as that of a rotary spring wound far up: one that is set lasts one step
                wound = -math.copysign(FAR, torque), abs(torque) / FAR, 0.0
                self.space.add(pymunk.DampedRotarySpring(self.space.static_body, ends[number], *wound))
        self.line = given["line"] and [(ends[number], anchor) for number, anchor in given["line"]]
        if given["linear_push"]:
            self.add_linear_push(given["linear_push"])
        self.motor = self.drive() if given["is_driven"] else None
        if self.motor is not None:
            self.space.add(self.motor)  # last, so that an iteration leaves no error in the crank's speed
        own = given["iterations"]
        self.iterations = np.array([self.space.iterations] * 2 if own is None else own, dtype=float)

    def push(self, number: int, anchor: Point, force: Point) -> pymunk.DampedSpring:
        """A constant force, as the pull of a spring whose other end is far away: a force that is set lasts one step."""
        size = math.hypot(*force) or 1.0
        far, stiffness = (FAR * force[0] / size, FAR * force[1] / size), math.hypot(*force) / FAR
        return pymunk.DampedSpring(self.space.static_body, self.ends[number], far, anchor, 0.0, stiffness, 0.0)

    def add_linear_push(self, force: float) -> pymunk.DampedSpring:
        """A constant force that pushes the ends of a linear driver apart, N."""
        (first, here), (second, there) = self.line
        spring = pymunk.DampedSpring(first, second, here, there, FAR, 0.0, 0.0)
        set_push(spring, force)
        self.space.add(spring)
        return spring

    def drive(self) -> Any:  # noqa: ANN401
        """What prescribes the driver; without a bias a pin joint is off by no more than the step makes it."""
        if self.line is None:
            return pymunk.SimpleMotor(self.space.static_body, self.ends[self.given["crank"]], 0.0)
        (first, here), (second, there) = self.line
        joint = pymunk.PinJoint(first, second, here, there)
        joint.error_bias = 0.0
        return joint

    def travel(self, ahead: float) -> float:
        """φ ``ahead`` seconds from now at the present velocities, rad or m."""
        if self.line is not None:
            return span(self.line, ahead) - float(self.given["base"])
        crank = self.ends[self.given["crank"]]
        return float(crank.angle + ahead * crank.angular_velocity)


class StepLoads:
    """The loads that have to be set anew before every step.

    In a centred run they are aimed at the positions and velocities of the step to come; else they are those of the last
    one, as a newcomer would have them.
    """

    def __init__(self, world: World) -> None:
        given = world.given
        self.is_ahead, self.reach, self.time = given["centred"], 0.0, 0.0
        self.travel, self.ground, self.is_over_angle = world.travel, world.space.static_body, bool(given["over_angle"])
        self.sums: dict[pymunk.Body, list[float]] = {}
        self.parts = [self.over_angle(world.ends[number], *load) for number, *load in given["over_angle"]]
        if given["over_time"]:
            self.parts.append(self.over_time(world, *given["over_time"]))
        if given["centred"]:  # otherwise pymunk's own springs damp
            self.parts += [self.damper(world.ends[a], world.ends[b], each) for a, b, each in given["dampers"]]
            self.parts += [self.dashpot(world.springs[number], *each) for number, *each in given["dashpots"]]

    def __bool__(self) -> bool:
        return bool(self.parts)

    def __call__(self, step: float) -> None:
        """Set everything for the next step, s."""
        self.reach = step if self.is_ahead else 0.0
        angle = self.travel(self.reach) if self.is_over_angle else 0.0
        for total in self.sums.values():
            total[0] = total[1] = total[2] = 0.0
        for part in self.parts:
            part(angle)
        for body, (x, y, torque) in self.sums.items():
            if x or y:
                body.force = (x, y)
            body.torque = torque
        self.time += step

    def total(self, body: pymunk.Body) -> list[float]:
        """Where the loads on a body are summed; those on the ground go nowhere."""
        total = [0.0, 0.0, 0.0]
        return total if body is self.ground else self.sums.setdefault(body, total)

    def over_angle(self, body: pymunk.Body, anchor: Point, law: Any) -> Callable[[float], None]:  # noqa: ANN401
        """A force at an anchor, or a torque, which has one component."""
        (x, y), total = anchor, self.total(body)

        def add(angle: float) -> None:
            values = at(law, angle)
            if len(values) == 1:
                total[2] += values[0]
                return
            fx, fy = values
            turn = body.angle + self.reach * body.angular_velocity
            c, s = math.cos(turn), math.sin(turn)
            total[0] += fx
            total[1] += fy
            total[2] += (c * x - s * y) * fy - (s * x + c * y) * fx

        return add

    def over_time(self, world: World, times: Sequence[float], torques: Sequence[float]) -> Callable[[float], None]:
        """A free driver's torque, or the force along a linear one."""
        spring = world.add_linear_push(0.0) if world.line else None
        total = self.total(world.ends[world.given["crank"]]) if spring is None else []

        def add(_angle: float) -> None:
            now = float(np.interp(self.time + self.reach, times, torques))
            if spring is None:
                total[2] += now
            else:
                set_push(spring, now)

        return add

    def damper(self, first: pymunk.Body, second: pymunk.Body, coefficient: float) -> Callable[[float], None]:
        """A torque against the bodies' turning against each other."""
        first_total, second_total = self.total(first), self.total(second)
        last = first.angular_velocity - second.angular_velocity

        def add(_angle: float) -> None:
            nonlocal last
            rate = first.angular_velocity - second.angular_velocity
            torque = coefficient * (1.5 * rate - 0.5 * last)
            last = rate
            first_total[2] -= torque
            second_total[2] += torque

        return add

    def dashpot(self, spring: pymunk.DampedSpring, stretch: float, free: float | None) -> Callable[[float], None]:
        """A dashpot as a change of its spring's rest length, its speed from the lengths at three instants.

        ``stretch`` is that change over the speed, s; ``free`` is the spring's length, None of a dashpot alone.
        """
        ends = [(spring.a, (*spring.anchor_a,)), (spring.b, (*spring.anchor_b,))]
        last = second_last = math.nan

        def add(_angle: float) -> None:
            nonlocal last, second_last
            if math.isnan(last):
                last, second_last = span(ends, 0.0), span(ends, -self.reach)
            now = span(ends, self.reach)
            speed = (3.0 * now - 4.0 * last + second_last) / (2.0 * self.reach)
            last, second_last = now, last
            spring.rest_length = (now if free is None else free) - stretch * speed

        return add


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


def calls(world: World, read: Iterable[pymunk.Constraint]) -> Calls:
    """The C functions behind pymunk's methods where this version has them as known, else the methods.

    The methods do housekeeping at every step (late removals, callbacks, type checks) that a space nobody touches does
    not need; without them a step of a small linkage takes about two thirds of the time. Results are identical.
    """
    try:
        return direct_calls(world, read)
    except (ImportError, AttributeError):
        return public_calls(world, read)


def public_calls(world: World, read: Iterable[pymunk.Constraint]) -> Calls:
    """The calls through pymunk's documented attributes."""
    values: list[float] = []

    def look() -> None:
        for body in world.bodies:
            values.extend((*body.position, body.angle, *body.velocity, body.angular_velocity))

    def set_rate(rate: float) -> None:
        if world.motor is not None:
            setattr(world.motor, "rate" if world.line is None else "distance", rate)

    def collected() -> Array:
        result = np.array(values).reshape(-1, len(world.bodies), 2, 3)
        values.clear()
        return result

    impulses = tuple(partial(getattr, constraint, "impulse") for constraint in read)
    return Calls(world.space.step, set_rate, partial(setattr, world.space, "iterations"), impulses, look, collected)


def direct_calls(world: World, read: Iterable[pymunk.Constraint]) -> Calls:
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


@dataclass(frozen=True)
class Clock:
    """The instants of a part of a run that are looked at; numbers count the engine's steps since the part's start.

    ``last``: no other part follows, whose start would be this one's end. ``lead`` counts samples.
    """

    part: Data
    ratio: int
    last: bool
    centred: bool
    lead: int

    @property
    def fine(self) -> float:
        """The engine's step, s."""
        return float((self.part["end"] - self.part["start"]) / self.part["samples"] / self.ratio)

    @property
    def steps(self) -> int:
        """Number of the engine's steps."""
        return int(self.part["samples"] * self.ratio)

    @property
    def samples(self) -> Numbers:
        """Steps after which positions are read; a newcomer reads none before the first."""
        return np.arange(0 if self.centred else 1, self.part["samples"] + (self.last or not self.centred)) * self.ratio

    @property
    def middles(self) -> Numbers:
        """Steps after which velocities are read; those of the first step are given."""
        if not self.centred:
            return self.samples
        first = 1 if self.part["start"] == 0.0 else 0
        return np.arange(first, self.part["samples"]) * self.ratio + (self.ratio - 1) // 2

    @property
    def loaded(self) -> Numbers:
        """Steps after which forces and accelerations are read: not at a start or a jump, nor for ``lead`` more.

        The first impulses answer to the velocities that were given, or to those before the jump.
        """
        return self.samples[self.lead if self.centred else 0 :]

    def marks(self, channels: Sequence[str]) -> NDArray[np.uint8]:
        """What is read after each step for some channels, the part's start first."""
        result = np.zeros(self.steps + 1, dtype=np.uint8)
        seen = {
            "position": self.samples,
            "velocity": self.middles,
            "acceleration": np.concatenate([self.loaded - 1, self.loaded]),
        }
        for channel, steps in seen.items():
            if channel in channels:
                result[steps] = LOOK
        if "torque" in channels or "joint_force" in channels:
            result[self.loaded] |= LOADS
        return result

    def times(self, steps: Numbers, ahead: float | Array = 0.0) -> Array:
        """Times of the states after steps, s; ``ahead`` by a share of a step."""
        return np.asarray(self.part["start"] + self.fine * (steps + ahead))

    def rates(self) -> Array:
        """Speed of the driver in every step, in the last part and one more, rad/s or m/s; zeros for a free one.

        It is the mean over the step, exact by Gauss-Legendre quadrature, or a newcomer's: that at the step's start.
        """
        steps = np.arange(self.steps + self.last)
        if self.part["segment"] is None:
            return np.zeros(len(steps))
        zero, coefficients = self.part["segment"]
        order, speed = (len(coefficients) + 1) // 2, np.poly1d(coefficients[::-1]).deriv()
        nodes, shares = np.polynomial.legendre.leggauss(order) if self.centred else (-np.ones(1), np.full(1, 2.0))
        return np.asarray(speed(self.times(steps[:, None], 0.5 * (nodes + 1.0)) - zero) @ (0.5 * shares))


@dataclass(frozen=True)
class Recording:
    """All that was read in a part of a run for some channels.

    ``seen`` (looks, parts, 2, 3) are the parts' positions and rates, ``torque`` (loads,) is the drive's, ``forces``
    (loads,) are magnitudes by joint. ``offsets`` (bodies, 2) are the bodies' mass centres from those of their carriers.
    """

    clock: Clock
    offsets: Array
    channels: Sequence[str]
    seen: Array
    torque: Array
    forces: dict[str, Array]

    def history(self) -> Data:
        """Times and values by channel, of a joint under its name."""
        clock, half = self.clock, 0.5 * self.clock.centred
        loaded, result = clock.times(clock.loaded), dict[str, tuple[Array, Array]]()
        if "position" in self.channels:
            result["position"] = clock.times(clock.samples), self.centres(self._at(clock.samples)[0])
        if "velocity" in self.channels:
            rates = self.centres(*self._at(clock.middles), half * clock.fine)
            result["velocity"] = clock.times(clock.middles, half), rates
        if "acceleration" in self.channels:
            state, late = self._at(clock.loaded)
            early = self._at(clock.loaded - 1)[1]
            change = self.centres(state, late, half * clock.fine) - self.centres(state, early, -half * clock.fine)
            result["acceleration"] = loaded, change / clock.fine
        if "torque" in self.channels:
            result["torque"] = loaded, self.torque
        return result | {f"force in {name}": (loaded, values) for name, values in self.forces.items()}

    @cached_property
    def _looked(self) -> Numbers:
        return np.flatnonzero(self.clock.marks(self.channels) & LOOK)

    def _at(self, steps: Numbers) -> tuple[Array, Array]:
        """Positions and rates of the parts after steps."""
        seen = self.seen[np.searchsorted(self._looked, steps)]
        return seen[:, :, 0], seen[:, :, 1]

    def centres(self, state: Array, rates: Array | None = None, ahead: float = 0.0) -> Array:
        """Positions of the mass centres, (n, bodies, 3), or their velocities ``ahead`` s from the positions."""
        carried = len(self.offsets)
        result = (state if rates is None else rates)[:, :carried].copy()
        angle = state[:, :carried, 2] + (0.0 if rates is None else ahead * result[..., 2])
        c, s = np.cos(angle), np.sin(angle)
        x = c * self.offsets[:, 0] - s * self.offsets[:, 1]
        y = s * self.offsets[:, 0] + c * self.offsets[:, 1]
        result[..., 0] += x if rates is None else -result[..., 2] * y
        result[..., 1] += y if rates is None else result[..., 2] * x
        return result


def build(model: Data) -> World:
    """The world of a model."""
    return World(model)


def follow(world: World, course: Data) -> Data:
    """The samples of a course."""
    given, channels, parts = world.given, course["channels"], course["parts"]
    centred = given["centred"]
    clocks = [Clock(part, course["ratio"], part is parts[-1], centred, given["lead"]) for part in parts]
    read = {name: world.constraints[number] for name, number in given["joints"].items() if "joint_force" in channels}
    if world.motor is not None and "torque" in channels:
        read[MOTOR] = world.motor
    on = calls(world, read.values())
    rates = np.concatenate([clock.rates() for clock in clocks])
    given_to_motor = -rates if world.line is None else given["base"] + travels(given["start"], clocks, rates)
    set_off(world, clocks[0], float(rates[0]))
    fewest, most = (round(bound(world.iterations)) for bound in (min, max))
    course["details"]["iterations"] = most if fewest == most else f"{fewest} to {most}"
    loads, iterations = StepLoads(world), iterations_in(world, clocks, rates)
    recordings, start = [], 0
    for clock, later in zip(clocks, [*clocks[1:], clocks[-1]], strict=True):
        count = clock.steps
        coming = given_to_motor[start + centred : start + centred + count].tolist()
        first, *marks = clock.marks(channels).tolist()
        if first:
            on.look()
        own = iterations[start : start + count]
        *plan, last = zip(coming, own.tolist(), marks, strict=True)
        impulses = march(on, clock.fine, plan, loads)
        impulses += march(on, change_of_step(world, clock, later), [last], loads)
        columns = np.array(impulses).reshape(-1, len(read) or 1).T / clock.fine
        forces = dict(zip(read, columns, strict=False))  # there are none where nothing is read
        torque = forces.pop(MOTOR, np.zeros(0))
        if MOTOR in read and centred:
            gained = np.diff(rates)[start + clock.loaded - 1] / clock.fine
            torque = given["offset"] - torque - given["flywheel"] * gained
        seen = on.collected().copy()
        recordings.append(Recording(clock, np.array(given["offsets"]), channels, seen, torque, forces))
        course["solver_work"] += int(own.sum()) * len(world.space.constraints)
        start += count
    with np.errstate(all="ignore"):
        return joined([recording.history() for recording in recordings], list(given["joints"]))


def joined(histories: list[Data], joints: list[str]) -> Data:
    """Histories of consecutive parts as one, forces by joint."""
    samples: Data = {
        name: tuple(np.concatenate([history[name][n] for history in histories]) for n in range(2))
        for name in histories[0]
    }
    names = {f"force in {joint}": joint for joint in joints}
    forces = {joint: samples.pop(name) for name, joint in names.items() if name in samples}
    return samples | {"joint_force": forces}


def travels(start: float, clocks: list[Clock], rates: Array) -> Array:
    """φ of a linear drive after every step and one more, m, at these mean speeds."""
    steps = np.concatenate([np.full(clock.steps + clock.last, clock.fine) for clock in clocks])
    return np.asarray(start + np.cumsum(rates * steps))


def set_off(world: World, clock: Clock, rate: float) -> None:
    """Give the parts their velocities: those that bring them through the first step, or a newcomer's.

    The latter are those of the start. The former are the motion's tangent there, at the speed of the middle of the
    step: a step along it opens the joints as every later step does, and so the next one closes them as later ones do.
    """
    given = world.given
    (speed, gain), velocity = given["driver_rates"], np.array(given["velocity"], dtype=float)
    if clock.centred:
        middle = speed + 0.5 * clock.fine * gain if world.motor is None else rate
        acceleration = np.array(given["acceleration"], dtype=float)
        velocity = velocity / speed * middle if speed else acceleration / (gain or 1.0) * middle
    for body, (_, inertia, *_), (x, y, turn) in zip(world.bodies, given["bodies"], velocity.tolist(), strict=True):
        body.velocity, body.angular_velocity = (x, y), 0.0 if inertia is None else turn


def change_of_step(world: World, clock: Clock, later: Clock) -> float:
    """The step with which to take the last one of a part: that of the part to follow, the way being that of its own.

    pymunk closes the joints by the step that it is given, while it is the next one that moves the bodies on.
    """
    if not clock.centred or math.isclose(clock.fine, later.fine):
        return clock.fine
    for body in world.bodies:
        body.velocity *= clock.fine / later.fine
        body.angular_velocity *= clock.fine / later.fine
    return later.fine


def iterations_in(world: World, clocks: list[Clock], rates: Array) -> Numbers:
    """Iterations in every step."""
    angles = np.cumsum(rates[:-1] * np.concatenate([np.full(clock.steps, clock.fine) for clock in clocks]))
    share = angles / (world.given["way"] or 1.0)
    share = np.clip(share, 0.0, 1.0) if np.ptp(share) <= WHOLE else share % 1.0
    even = np.linspace(0.0, 1.0, len(world.iterations))
    result: Numbers = np.interp(share, even, world.iterations).astype(np.intp)
    start = 0
    for clock, former in zip(clocks, [None, *clocks], strict=False):
        unlike = former is None or clock.part["after_jump"] or not math.isclose(clock.fine, former.fine)
        if clock.centred and unlike:
            first = max(0, start - 1)
            result[first : first + COLD_STEPS] *= COLD
        start += clock.steps
    return result
