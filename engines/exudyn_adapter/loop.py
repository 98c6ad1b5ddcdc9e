"""One pass in exudyn: every part of a prescribed motion starts anew, from a state on the joints and the drive.

A rule with its constraints on velocity level lets positions drift off the joints, by the square of the step in every
turn; any rule has to be given an acceleration that jumps. Where the crank is prescribed, its angle φ alone fixes the
coordinates q, which the static solver finds to rounding; from their differences between angles near by follow

    q̇ = q' φ̇,    q̈ = q'' φ̇² + q' φ̈.

Data are the adapter's ``model``, in SI or the scene's own units. A course has ``parts`` of the motion, ``ratio`` steps
to a sample, the ``channels`` to record and ``details`` to report in. A part has its ``start`` and ``end``, s, a number
of ``samples``, and a ``segment``: its own start, s, and φ's coefficients from then on, lowest power first, or None for
a free driver.
"""

import cmath
import math
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache, reduce
from operator import mul
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface
from exudyn.advancedUtilities import CreateSymbolicUserFunction
from numpy.typing import NDArray

from engines.shared_loop import law_values

Array = NDArray[np.float64]
Data = dict[str, Any]

ANGLE = 2  # number of the angle among the coordinates of a two-dimensional rigid body
TURNED = 5e-3  # rad between these: rounding of q'' and what the differences leave out are about equal
# Weights of central differences of sixth order, for the first and second derivative, at 1 … 3 times that.
WEIGHTS = ((3 / 4, 3 / 2), (-3 / 20, -3 / 20), (1 / 60, 1 / 90))
# What a start may change of coordinates, in the unit of length and rad, and of velocities, over the largest. A larger
# change leads to another assembly mode, near a change point.
LARGEST_CHANGE = 1e-2


def polynomial(coefficients: Sequence[float], x: Any, order: int = 0) -> Any:  # noqa: ANN401 - exudyn has symbols too
    """Value, or derivative of an ``order``, of a polynomial at a number or symbol, coefficients lowest power first."""
    for _ in range(order):
        coefficients = [power * each for power, each in enumerate(coefficients)][1:] or [0.0]
    return reduce(lambda total, each: total * x + each, coefficients[-2::-1], coefficients[-1] + 0.0 * x)


class LinearDriver:
    """The span of a driver's two points from the coordinates of their bodies' nodes, reference values included.

    exudyn calls the functions with the coordinates of the two bodies and its own time; its multiplier is minus the
    force along the driver. ``travel`` gives φ and its rate at exudyn's time; it is set anew for each part.
    """

    def __init__(self, given: Data, travel: Callable[[float, int], float]) -> None:
        """Hold the driver's ends, as the model's ``linear`` gives them, and ``travel``, called with time, s, and order.

        It returns φ, m, or its derivative of that order.
        """
        self.ends, self.along, self.travel = given["ends"], given["along"], travel

    def span(self, coordinates: Sequence[float]) -> tuple[float, list[float]]:
        """φ, m, and its gradient over the coordinates of the first body's node and then of the second's.

        They are x, y and angle each; the ground has none.
        """
        between, arms, rest = 0j, list[complex](), list(coordinates)
        for (node, anchor), sign in zip(self.ends, (1.0, -1.0), strict=True):
            x, y, angle = (0.0, 0.0, 0.0) if node is None else rest[:3]
            rest = rest if node is None else rest[3:]
            arms.append(anchor * cmath.rect(1.0, angle))
            between += sign * (complex(x, y) + arms[-1])
        length = abs(between) if self.along is None else (self.along.conjugate() * between).real
        along = between / length if self.along is None else self.along
        gradient = list[float]()
        for (node, _), arm, sign in zip(self.ends, arms, (1.0, -1.0), strict=True):
            if node is not None:
                gradient += [sign * along.real, sign * along.imag, sign * (along.conjugate() * 1j * arm).real]
        return length, gradient

    def reached(self, mbs: Any) -> float:  # noqa: ANN401
        """φ, m, of the system ``mbs`` at its present instant."""
        nodes, kind = [node for node, _ in self.ends if node is not None], exudyn.OutputVariableType.Coordinates
        places = [mbs.GetNodeOutput(node, kind) + mbs.GetNode(node)["referenceCoordinates"] for node in nodes]
        return self.span(np.concatenate(places).tolist())[0]

    def functions(self) -> Data:
        """The arguments, by name, of exudyn's object: the constraint, on either level, its Jacobian, and no scaling."""

        def gap(_mbs: Any, t: float, _item: int, q: Any, q_t: Any, at_velocity: bool) -> list[float]:  # noqa: ANN401
            """The error of φ, m, or ``at_velocity`` of its rate, m/s, at exudyn's time ``t``, s, in a list, for exudyn.

            ``q`` and ``q_t`` are the coordinates of both bodies' nodes and their rates.
            """
            length, gradient = self.span(q)
            return [sum(map(mul, gradient, q_t)) - self.travel(t, 1) if at_velocity else length - self.travel(t, 0)]

        def jacobian(_mbs: Any, _t: float, _item: int, q: Any, *_: object) -> Array:  # noqa: ANN401
            """The gradient of φ over the coordinates ``q`` of both bodies' nodes, (1, coordinates), for exudyn."""
            return np.array([self.span(q)[1]])

        return {"scalingMarker0": np.zeros((1, 1)), "constraintUserFunction": gap, "jacobianUserFunction": jacobian}


class ExudynWorld:
    """An exudyn system in its start state.

    ``container`` is stored because exudyn frees the system's memory with it, and every size then silently reads zero.
    ``driver`` is the item that holds a prescribed driver; None for a free one.
    """

    def __init__(self, given: Data) -> None:
        """Build exudyn's system from the items of the adapter's data; it is not assembled yet."""
        self.given, self.container = given, exudyn.SystemContainer()
        self.mbs = self.container.AddSystem()
        self.begin = 0.0  # the time at which exudyn's is 0, s
        self.unwound = np.zeros((len(given["poses"]), 3))  # whole turns, rad, that have been taken off the angles
        self.linear = given["linear"] and LinearDriver(given["linear"], self.phi)
        self.functions = list[Any]()  # exudyn does not keep them alive itself
        self.driver = None if given["driver"] is None else exudyn.ObjectIndex(given["driver"])
        for category, kind, data, law in given["items"]:
            values = {**data, **self.function(law)} if law else dict(data)
            if category == "Sensor":
                values["outputVariableType"] = getattr(exudyn.OutputVariableType, data["outputVariableType"])
            getattr(self.mbs, f"Add{category}")(getattr(itemInterface, category + kind)(**values))
        if given["as_shipped"] and self.driver is not None and self.linear is None:
            self.mbs.SetObjectParameter(
                self.driver, "offsetUserFunction", lambda _mbs, t, _item, _offset: self.phi(t) - given["start"]
            )

    def phi(self, time: float, order: int = 0) -> float:
        """φ, rad or m, or its derivative of an ``order``, at any time, s, of a prescribed motion."""
        motion = self.given["motion"]
        start, _, coefficients = next((each for each in motion if time <= each[1]), motion[-1])
        return float(polynomial(coefficients, time - start, order))

    def function(self, law: tuple[str, str, Any]) -> Data:
        """The arguments, by name, of an item that hold its user functions.

        The law is "angle", with a load's plain law over φ, "time", with a free driver's constant, table over time or
        None, and direction, or "gap", a linear driver's; with exudyn's name of the argument between.
        """
        by, name, values = law
        if by == "gap":
            return self.linear.functions()
        over_angle = lru_cache(maxsize=1)(lambda angle: law_values(values, angle))  # it is evaluated at every iteration

        def load(mbs: Any, t: float, *_: object) -> Any:  # noqa: ANN401
            """The load at exudyn's time ``t``, s, for exudyn: three components of a force, or one number."""
            if by == "angle":
                components = over_angle(self.angle(mbs, t))
            else:  # a free driver's, along a direction; of a cylinder the pull
                torque, times, direction = values
                size = torque + (float(np.interp(self.begin + t, *times)) if times else 0.0)
                components = [size * each for each in direction]
            return [*components, 0.0] if components[1:] else components[0]

        return {name: load}

    def angle(self, mbs: Any, t: float) -> float:  # noqa: ANN401
        """φ, rad or m, at exudyn's time ``t``, s: by a prescribed motion, else by the coordinates of ``mbs``."""
        if self.given["motion"]:
            return self.phi(self.begin + t)
        if self.linear:
            return float(self.linear.reached(mbs))
        turned = mbs.GetNodeOutput(self.given["crank_node"], exudyn.OutputVariableType.Coordinates)[ANGLE]
        return float(self.given["start"] + turned)

    def unwind(self, position: Array) -> Array:
        """A copy of coordinates, (3 bodies,), less the nearest whole turns of their angles, added to ``unwound``, rad.

        On position level accelerations and forces carry the rounding of angles and times over the square of the step,
        which would grow with them: 2e-5 of the torque's peak after 300 turns.
        """
        whole = np.round(position.reshape(-1, 3) / math.tau) * math.tau * (0.0, 0.0, 1.0)
        self.unwound += whole
        return np.asarray(position - whole.ravel())

    @property
    def origin(self) -> float:
        """φ at which the crank's coordinate is 0, rad."""
        return float(self.given["start"] + self.unwound[self.given["crank"], ANGLE])

    def set_drive(self, part: Data) -> None:
        """Make the drive follow a part's polynomial, as exudyn's own functions of the time since the part's start.

        Python functions take a third more time; a linear driver has these.
        """
        self.begin, (zero, coefficients) = part["start"], part["segment"]
        shifted = [float(polynomial(coefficients, self.begin - zero, n)) for n in range(len(coefficients))]
        terms = [value / math.factorial(n) for n, value in enumerate(shifted)]
        if self.linear:
            self.linear.travel = lambda t, order: polynomial(terms, t, order)
            return
        terms[0] -= self.origin
        offsets: dict[str, Callable[..., Any]] = {
            "offsetUserFunction": lambda _mbs, t, _item, _offset: polynomial(terms, t),
            "offsetUserFunction_t": lambda _mbs, t, _item, _offset: polynomial(terms, t, 1),
        }
        self.functions = [CreateSymbolicUserFunction(self.mbs, f, name, self.driver) for name, f in offsets.items()]
        for name, function in zip(offsets, self.functions, strict=True):
            self.mbs.SetObjectParameter(self.driver, name, function)

    def hold_drive(self, angle: float) -> None:
        """Hold the crank at an angle, rad, or a linear driver at a travel, m, for static solves."""
        if self.linear:
            self.linear.travel = lambda _time, _order: angle
            return
        self.mbs.SetObjectParameter(self.driver, "offsetUserFunction", 0)
        self.mbs.SetObjectParameter(self.driver, "offset", angle - self.origin)


def build(given: Data) -> ExudynWorld:
    """The assembled system of a model; raises ArithmeticError for a model that exudyn refuses.

    Raises it, too, where the joints repeat a condition, or leave another freedom than the drive's: they would make it
    singular, which exudyn reports only in the middle of a solve.
    """
    world = ExudynWorld(given)
    try:
        world.mbs.Assemble()
    except exudyn.ExudynError as error:
        raise ArithmeticError("exudyn refuses the scene: " + str(error).partition("\n")[0]) from error
    freedom = exudyn.ComputeSystemDegreeOfFreedom(world.mbs)
    redundant, left = freedom["redundantConstraints"], int(freedom["degreeOfFreedom"])
    needed = 1 if world.driver is None else 0
    if redundant or left != needed:
        reason = f"leave {left} degrees of freedom where the drive needs {needed}, and repeat {redundant}"
        raise ArithmeticError(f"the joints {reason} of their conditions")
    return world


def set_initial(world: ExudynWorld, *state: Array) -> None:
    """Set coordinates and, where given, their first and second time derivatives as the start of the next solve.

    Each is one array of all bodies' x, y and angle in turn.
    """
    data, initial = world.mbs.systemData, exudyn.ConfigurationType.Initial
    setters = (data.SetODE2Coordinates, data.SetODE2Coordinates_t, data.SetODE2Coordinates_tt)
    for setter, values in zip(setters, state, strict=False):
        setter(values, configuration=initial)


def closed_state(world: ExudynWorld, part: Data, reached: tuple[Array, ...]) -> tuple[Array, ...] | None:
    """Coordinates and two time derivatives at the start of a part that fit the joints; None if far from ``reached``.

    ``reached`` is the state in which the part before ended. None, too, where the static solver finds none. The drive is
    left held.
    """
    zero, coefficients = part["segment"]
    angle, speed, second = (float(polynomial(coefficients, part["start"] - zero, order)) for order in range(3))
    try:
        position = at_angle(world, reached[0], angle)
        rate, bend = np.zeros_like(position), np.zeros_like(position)
        for sign in (1.0, -1.0):
            place = position
            for count, (first, other) in enumerate(WEIGHTS, start=1):
                place = at_angle(world, place, angle + sign * count * TURNED)
                rate += sign * first / TURNED * (place - position)
                bend += other / TURNED**2 * (place - position)
    except exudyn.ExudynError:
        return None
    velocity = rate * speed
    is_near = np.abs(position - reached[0]).max() <= LARGEST_CHANGE
    is_like = np.abs(velocity - reached[1]).max() <= LARGEST_CHANGE * np.abs(velocity).max()
    return (position, velocity, bend * speed**2 + rate * second) if is_near and is_like else None


def simulation_settings(values: Data) -> Any:  # noqa: ANN401
    """A new object of exudyn's simulation settings, as shipped but for the values given by dotted name."""
    settings = exudyn.SimulationSettings()
    for path, value in values.items():
        *groups, name = path.split(".")
        enumerated = exudyn.LinearSolverType.__members__ if name == "solverType" else {}
        setattr(reduce(getattr, groups, settings), name, enumerated.get(value, value))
    return settings


def at_angle(world: ExudynWorld, guess: Array, angle: float) -> Array:
    """Coordinates of exudyn at φ, rad or m, found from a guess by the static solver; the drive is left held there.

    Raises ExudynError where there are none.
    """
    world.hold_drive(angle)
    set_initial(world, guess)
    world.mbs.SolveStatic(simulation_settings(world.given["static_settings"]))
    return np.array(world.mbs.systemData.GetODE2Coordinates())


def start(world: ExudynWorld, part: Data, details: Data, *, first: bool) -> None:
    """Set the drive and the start state of a part: the scene's in the ``first``, else one near the state reached.

    Where there is none that fits the joints, the part goes on from the state reached. ``details`` counts both, in
    place, as ``fresh_starts`` and ``fresh_starts_left_out``. A free driver's drive is not set.
    """
    state, data = tuple(map(np.array, world.given["states"])), world.mbs.systemData
    if not first:
        ended = (data.GetODE2Coordinates(), data.GetODE2Coordinates_t(), data.GetODE2Coordinates_tt())
        position, velocity, acceleration = map(np.array, ended)
        reached = world.unwind(position), velocity, acceleration
        closed = closed_state(world, part, reached)
        key = "fresh_starts_left_out" if closed is None else "fresh_starts"
        details[key] = details.get(key, 0) + 1
        state = closed or reached
    if part["segment"] is not None:
        world.set_drive(part)
    set_initial(world, *state)


def solve(world: ExudynWorld, part: Data, course: Data) -> None:
    """Step through a part; raises ArithmeticError if exudyn stops or leaves velocities that are not finite.

    Samples stay in exudyn's sensors.
    """
    mbs, solver, duration = world.mbs, exudyn.MainSolverImplicitSecondOrder(), part["end"] - part["start"]
    times = {"timeIntegration.endTime": duration, "timeIntegration.numberOfSteps": part["samples"] * course["ratio"]}
    times["solution.sensors.writePeriod"] = duration / part["samples"]
    try:
        finished = solver.SolveSystem(mbs, simulation_settings(world.given["settings"] | times))
        reason = solver.GetErrorString()
    except exudyn.ExudynError as error:
        finished, reason = False, str(error).partition("\n")[0]
    if not finished:
        raise ArithmeticError(f"exudyn stopped at {world.begin + mbs.systemData.GetTime():.4g} s: {reason}")
    if not all(map(math.isfinite, mbs.systemData.GetODE2Coordinates_t())):
        raise ArithmeticError(f"the state is not finite at {part['end']:.4g} s")


def read(world: ExudynWorld, *, first: bool, before_jump: bool) -> Iterator[tuple[str, str | None, Array, Array]]:
    """Yield the samples of the latest solve that are exudyn's own: channel, joint or None, times, s, and values.

    The state that the solve started from has one in the run's ``first`` part alone. The multipliers belong to a step,
    not to a state: torque and joint forces have no sample at a start. Nor have accelerations where those of the scene
    were given to start from. None of these has one at an end that is ``before_jump``, where they have two values.
    """
    given, end = world.given, -1 if before_jump else None
    data = [world.mbs.GetSensorStoredData(number) for number in range(given["sensors"])]
    time = world.begin + data[0][:, 0] if data else np.zeros(0)
    for channel, sensors in given["motion_sensors"].items():
        changes = channel == "acceleration"
        values = np.stack([data[sensor][:, 1:] for sensor in sensors], axis=1)
        if channel == "position":
            values += np.array(given["poses"]) + world.unwound
        is_given = changes and not given["as_shipped"]
        steps = slice(0 if first and not is_given else 1, end if changes else None)
        yield channel, None, time[steps], values[steps]
    loaded = slice(1, end)
    if given["torque_sensor"] is not None:  # exudyn reports what the crank does to the drive
        yield "torque", None, time[loaded], -data[given["torque_sensor"]][loaded, 1]
    for name, (sensor, turned) in given["force_sensors"].items():
        values = data[sensor][:, 1:3]
        if turned is not None:  # by the angle of a body
            zero, of_body = turned
            c, s = (each(zero + data[of_body][:, 1 + ANGLE]) for each in (np.cos, np.sin))
            values = np.stack([c * values[:, 0] - s * values[:, 1], s * values[:, 0] + c * values[:, 1]], axis=-1)
        yield "joint_force", name, time[loaded], values[loaded]


def follow(world: ExudynWorld, course: Data) -> Data:
    """Step through all parts of a course and return its samples: times, s, and values by channel, SI or own units.

    Forces by joint are under "joint_force". The system is released. Adds to the course's ``details``. Raises
    ArithmeticError if exudyn stops or a state is not finite.
    """
    signals: dict[tuple[str, str | None], list[tuple[Array, Array]]] = {}
    parts, prints = course["parts"], exudyn.config.printToConsole
    exudyn.config.printToConsole = False
    try:
        for part, later in zip(parts, [*parts[1:], None], strict=True):
            if not world.given["as_shipped"]:
                start(world, part, course["details"], first=part is parts[0])
            solve(world, part, course)
            before_jump = later is not None and later["after_jump"]
            for channel, joint, time, values in read(world, first=part is parts[0], before_jump=before_jump):
                signals.setdefault((channel, joint), []).append((time, values))
    finally:
        exudyn.config.printToConsole = prints
        world.container.Reset()  # else exudyn keeps what its functions and sensors hold for as long as it lives
    samples: Data = {"joint_force": {}}
    for (channel, joint), pieces in signals.items():
        time, values = (np.concatenate([piece[n] for piece in pieces]) for n in range(2))
        (samples if joint is None else samples[channel])[channel if joint is None else joint] = (time, values)
    return samples
