"""One pass in exudyn: every part of a prescribed motion starts anew, from a state on the joints and the drive.

A rule with its constraints on velocity level lets positions drift off the joints, by the square of the step in every
turn; any rule has to be given an acceleration that jumps. Where the crank is prescribed, its angle φ alone fixes the
coordinates q, which the static solver finds to rounding; from their differences between angles near by follow

    q̇ = q' φ̇,    q̈ = q'' φ̇² + q' φ̈.
"""

import cmath
import math
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from operator import mul
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface
from exudyn.advancedUtilities import CreateSymbolicUserFunction
from numpy.typing import NDArray

Array = NDArray[np.float64]
Data = dict[str, Any]
State = tuple[Array, Array, Array]  # coordinates and their first two time derivatives

FULL_TURN = 2.0 * math.pi
ANGLE = 2  # number of the angle among the coordinates of a two-dimensional rigid body
TURNED = 5e-3  # rad between these: rounding of q'' and what the differences leave out are about equal
# Central differences of sixth order for the first and second derivative, at 1 … 3 times that on either side.
FIRST = (3 / 4, -3 / 20, 1 / 60)
SECOND = (3 / 2, -3 / 20, 1 / 90)
TOLERANCE = 1e-9  # of a correction of the static solver, whose square, which is the next, is rounding
# What a start may change of coordinates, in the unit of length and rad, and of velocities, over the largest. A larger
# change leads to another assembly mode, near a change point.
LARGEST_CHANGE = 1e-2


def polynomial(coefficients: Sequence[float], x: Any, order: int = 0) -> Any:  # noqa: ANN401 - exudyn has symbols too
    """Value or derivative of a polynomial, lowest power first."""
    for _ in range(order):
        coefficients = [power * each for power, each in enumerate(coefficients)][1:] or [0.0]
    result = coefficients[-1] + 0.0 * x
    for coefficient in coefficients[-2::-1]:
        result = result * x + coefficient
    return result


def coordinate(terms: Sequence[float], order: int) -> Callable[..., Any]:
    """A polynomial of time or its derivative, in the form exudyn wants of a function of time."""

    def value(_mbs: Any, t: Any, _item: Any, _offset: Any) -> Any:  # noqa: ANN401
        return polynomial(terms, t, order)

    return value


def law_values(law: Any, angle: float) -> Any:  # noqa: ANN401
    """A load's components at an angle or a travel: those of cubics between knots."""
    knots, pieces, repeats = law
    angle = knots[0] + (angle - knots[0]) % FULL_TURN if repeats else min(max(angle, knots[0]), knots[-1])
    piece = min(bisect_right(knots, angle), len(pieces)) - 1
    x = angle - knots[piece]
    return [a + x * (b + x * (c + x * d)) for a, b, c, d in pieces[piece]]


class LinearDriver:
    """The span of a driver's two points from the coordinates of their bodies' nodes, reference values included.

    exudyn calls the functions with the coordinates of the two bodies and its own time; its multiplier is minus the
    force along the driver. ``travel`` gives φ and its rate at exudyn's time; it is set anew for each part.
    """

    def __init__(self, given: Data, travel: Callable[[float, int], float]) -> None:
        self.ends, self.along, self.travel = given["ends"], given["along"], travel

    def span(self, coordinates: Sequence[float]) -> tuple[float, list[float]]:
        """φ, m, and its gradient over the coordinates of the first body's node and then of the second's."""
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
        """φ at the present instant, m."""
        coordinates = list[float]()
        for node, _ in self.ends:
            if node is not None:
                place = mbs.GetNodeOutput(node, exudyn.OutputVariableType.Coordinates)
                coordinates += (place + mbs.GetNode(node)["referenceCoordinates"]).tolist()
        return self.span(coordinates)[0]

    def functions(self) -> Data:
        """The constraint, at position or at velocity level, and its Jacobian."""

        def gap(_mbs: Any, t: float, _item: int, q: Any, q_t: Any, at_velocity: bool) -> list[float]:  # noqa: ANN401
            length, gradient = self.span(q)
            return [sum(map(mul, gradient, q_t)) - self.travel(t, 1) if at_velocity else length - self.travel(t, 0)]

        def jacobian(_mbs: Any, _t: float, _item: int, q: Any, *_: object) -> Array:  # noqa: ANN401
            return np.array([self.span(q)[1]])

        # The matrix has one row: there is one equation.
        return {"scalingMarker0": np.zeros((1, 1)), "constraintUserFunction": gap, "jacobianUserFunction": jacobian}


class ExudynWorld:
    """An exudyn system in its start state.

    ``container`` is stored because exudyn frees the system's memory with it, and every size then silently reads zero.
    ``driver`` is the item that holds a prescribed driver; None for a free one.
    """

    def __init__(self, given: Data) -> None:
        self.given = given
        self.container = exudyn.SystemContainer()
        self.mbs = self.container.AddSystem()
        self.begin = 0.0  # the time at which exudyn's is 0, s
        self.unwound = np.zeros((len(given["poses"]), 3))  # whole turns, rad, that have been taken off the angles
        self.linear = given["linear"] and LinearDriver(given["linear"], self.phi)
        self.functions = list[Any]()  # exudyn does not keep them alive itself
        self.driver = None if given["driver"] is None else exudyn.ObjectIndex(given["driver"])
        for category, kind, data, law in given["items"]:
            values = {**data, **self.function(kind, law)} if law else dict(data)
            if category == "Sensor":
                values["outputVariableType"] = getattr(exudyn.OutputVariableType, data["outputVariableType"])
            getattr(self.mbs, f"Add{category}")(getattr(itemInterface, category + kind)(**values))
        if given["as_shipped"] and self.driver is not None and self.linear is None:
            self.mbs.SetObjectParameter(
                self.driver, "offsetUserFunction", lambda _mbs, t, _item, _offset: self.phi(t) - given["start"]
            )

    def phi(self, time: float, order: int = 0) -> float:
        """φ or its rate at any time of a prescribed motion."""
        motion = self.given["motion"]
        start, _, coefficients = next((each for each in motion if time <= each[1]), motion[-1])
        return float(polynomial(coefficients, time - start, order))

    def function(self, kind: str, law: tuple[str, Any]) -> Data:
        """Exudyn's user functions of an item, by argument name: over time, over φ, or of a linear driver."""
        by, values = law
        if by == "gap":
            return self.linear.functions()
        vector = kind == "ForceVector"
        name = {"ForceVector": "loadVector", "Coordinate": "load", "ConnectorSpringDamper": "springForce"}[kind]
        if by == "time":  # a free driver's, along a direction; of a cylinder the pull
            torque, times, direction = values

            def timed(_mbs: Any, t: float, *_: object) -> Any:  # noqa: ANN401
                size = torque + (float(np.interp(self.begin + t, *times)) if times else 0.0)
                return [size * each for each in direction] if vector else size * direction[0]

            return {f"{name}UserFunction": timed}
        value = lru_cache(maxsize=1)(lambda angle: law_values(values, angle))  # it is evaluated at every iteration

        def over_angle(mbs: Any, t: float, _load: Any) -> Any:  # noqa: ANN401
            components = value(self.angle(mbs, t))
            return [*components, 0.0] if vector else components[0]

        return {f"{name}UserFunction": over_angle}

    def angle(self, mbs: Any, t: float) -> float:  # noqa: ANN401
        """φ; a prescribed crank's is a matter of the time alone."""
        if self.given["motion"]:
            return self.phi(self.begin + t)
        if self.linear:
            return float(self.linear.reached(mbs))
        turned = mbs.GetNodeOutput(self.given["crank_node"], exudyn.OutputVariableType.Coordinates)[ANGLE]
        return float(self.given["start"] + turned)

    def unwind(self, position: Array) -> Array:
        """Coordinates without the whole turns of their angles.

        On position level accelerations and forces carry the rounding of angles and times over the square of the step,
        which would grow with them: 2e-5 of the torque's peak after 300 turns.
        """
        whole = np.round(position.reshape(-1, 3) / FULL_TURN) * FULL_TURN * (0.0, 0.0, 1.0)
        self.unwound += whole
        return np.asarray(position - whole.ravel())

    @property
    def origin(self) -> float:
        """φ at which the crank's coordinate is 0, rad; a linear driver has no coordinate but φ."""
        return 0.0 if self.linear else float(self.given["start"] + self.unwound[self.given["crank"], ANGLE])

    def set_drive(self, part: Data) -> None:
        """Give the solver the crank's angle and speed as its own functions of the time since the start of a part.

        Python functions take a third more time.
        """
        self.begin, (zero, coefficients) = part["start"], part["segment"]
        orders = range(len(coefficients))
        terms = [float(polynomial(coefficients, self.begin - zero, n)) / math.factorial(n) for n in orders]
        terms[0] -= self.origin
        if self.linear:
            self.linear.travel = lambda t, order: polynomial(terms, t, order)
            return
        self.functions = []
        for order, name in enumerate(("offsetUserFunction", "offsetUserFunction_t")):
            function = coordinate(terms, order)
            self.functions.append(CreateSymbolicUserFunction(self.mbs, function, name, self.driver))
            self.mbs.SetObjectParameter(self.driver, name, self.functions[-1])

    def hold_drive(self, angle: float) -> None:
        """Keep the crank at an angle, rad, or a linear driver at a travel."""
        if self.linear:
            self.linear.travel = lambda _time, _order: angle
            return
        self.mbs.SetObjectParameter(self.driver, "offsetUserFunction", 0)
        self.mbs.SetObjectParameter(self.driver, "offset", angle - self.origin)


def build(given: Data) -> ExudynWorld:
    """The assembled system of a model.

    Redundant joints would make it singular, which exudyn reports only in the middle of a solve.
    """
    world = ExudynWorld(given)
    try:
        world.mbs.Assemble()
    except exudyn.ExudynError as error:
        raise ArithmeticError("exudyn refuses the scene: " + str(error).partition("\n")[0]) from error
    freedom = exudyn.ComputeSystemDegreeOfFreedom(world.mbs)
    redundant, left = freedom["redundantConstraints"], int(freedom["degreeOfFreedom"])
    expected = 1 if world.driver is None else 0
    if redundant or left != expected:
        reason = f"leave {left} degrees of freedom where the drive needs {expected}, and repeat {redundant}"
        raise ArithmeticError(f"the joints {reason} of their conditions")
    return world


def end_state(world: ExudynWorld) -> State:
    """The state that the latest solve has ended with, its angles unwound."""
    state = world.mbs.systemData
    values = (state.GetODE2Coordinates(), state.GetODE2Coordinates_t(), state.GetODE2Coordinates_tt())
    position, velocity, acceleration = map(np.array, values)
    return world.unwind(position), velocity, acceleration


def set_initial(world: ExudynWorld, position: Array, *rates: Array) -> None:
    """Set coordinates and, where given, their time derivatives as the start of the next solve."""
    state, initial = world.mbs.systemData, exudyn.ConfigurationType.Initial
    state.SetODE2Coordinates(position, configuration=initial)
    for put, rate in zip((state.SetODE2Coordinates_t, state.SetODE2Coordinates_tt), rates, strict=False):
        put(rate, configuration=initial)


def closed_state(world: ExudynWorld, part: Data, reached: State) -> State | None:
    """The state at the start of a part of a prescribed motion; None if the solver has none near the one reached."""
    zero, coefficients = part["segment"]
    angle, speed, second = (float(polynomial(coefficients, part["start"] - zero, order)) for order in range(3))
    try:
        position = at_angle(world, reached[0], angle)
        rate, bend = np.zeros_like(position), np.zeros_like(position)
        for sign in (1.0, -1.0):
            place = position
            for count, (first_weight, second_weight) in enumerate(zip(FIRST, SECOND, strict=True), start=1):
                place = at_angle(world, place, angle + sign * count * TURNED)
                rate += sign * first_weight / TURNED * (place - position)
                bend += second_weight / TURNED**2 * (place - position)
    except exudyn.ExudynError:
        return None
    velocity = rate * speed
    is_near = np.abs(position - reached[0]).max() <= LARGEST_CHANGE
    is_like = np.abs(velocity - reached[1]).max() <= LARGEST_CHANGE * np.abs(velocity).max()
    return (position, velocity, bend * speed**2 + rate * second) if is_near and is_like else None


def at_angle(world: ExudynWorld, guess: Array, angle: float) -> Array:
    """Coordinates at a crank angle, rad; raises ExudynError where exudyn finds none."""
    world.hold_drive(angle)
    set_initial(world, guess)
    settings = exudyn.SimulationSettings()
    settings.solution.file.write = False
    settings.solution.sensors.active = False
    settings.linearSolver.solverType = exudyn.LinearSolverType.EigenDense
    settings.staticSolver.useLoadFactor = False
    newton = settings.staticSolver.newton
    newton.residualMode = 1  # corrections are judged, not loads
    newton.relativeTolerance = newton.absoluteTolerance = TOLERANCE
    world.mbs.SolveStatic(settings)
    return np.array(world.mbs.systemData.GetODE2Coordinates())


def start(world: ExudynWorld, part: Data, details: Data, *, first: bool) -> None:
    """Set the drive's functions and the state a part starts from: the scene's, or one near what has been reached."""
    state = tuple(map(np.array, world.given["states"]))
    if not first:
        reached = end_state(world)
        closed = closed_state(world, part, reached)
        key = "fresh_starts_left_out" if closed is None else "fresh_starts"
        details[key] = details.get(key, 0) + 1
        state = closed or reached
    if part["segment"] is not None:
        world.set_drive(part)
    set_initial(world, *state)


def solver_settings(given: Data, part: Data, ratio: int) -> Any:  # noqa: ANN401
    """The settings of a part's solver."""
    settings = exudyn.SimulationSettings()
    integration = settings.timeIntegration
    integration.endTime = part["end"] - part["start"]
    integration.numberOfSteps = part["samples"] * ratio
    settings.solution.sensors.writePeriod = (part["end"] - part["start"]) / part["samples"]
    settings.solution.file.write = False
    newton = integration.newton
    if given["effort"] is not None:
        newton.relativeTolerance = newton.absoluteTolerance = given["effort"]
    if given["as_shipped"]:
        return settings
    settings.linearSolver.solverType = exudyn.LinearSolverType.EigenDense
    integration.adaptiveStep = given["adaptive"]
    integration.generalizedAlpha.useNewmark = given["damping"] is None
    integration.generalizedAlpha.useIndex2Constraints = given["damping"] is None
    integration.generalizedAlpha.computeInitialAccelerations = False  # exudyn leaves out the drive's own
    if given["damping"] is not None:
        integration.generalizedAlpha.spectralRadius = given["damping"]
    # Residuals hold the multipliers, which nothing fixes at a change point; corrections of the motion die out there.
    newton.residualMode = 1
    newton.useModifiedNewton = True
    newton.modifiedNewtonJacUpdatePerStep = True
    return settings


def solve(world: ExudynWorld, part: Data, course: Data) -> None:
    """Step through a part; raises ArithmeticError if exudyn stops or leaves what is no number."""
    mbs, solver = world.mbs, exudyn.MainSolverImplicitSecondOrder()
    try:
        finished = solver.SolveSystem(mbs, solver_settings(world.given, part, course["ratio"]))
        reason = solver.GetErrorString()
    except exudyn.ExudynError as error:
        finished, reason = False, str(error).partition("\n")[0]
    finally:
        course["solver_work"] += solver.it.newtonStepsCount
    if not finished:
        raise ArithmeticError(f"exudyn stopped at {world.begin + mbs.systemData.GetTime():.4g} s: {reason}")
    if not all(map(math.isfinite, mbs.systemData.GetODE2Coordinates_t())):
        raise ArithmeticError(f"the state is not finite at {part['end']:.4g} s")


def read(world: ExudynWorld, *, first: bool, before_jump: bool) -> Iterator[tuple[str, str | None, Array, Array]]:
    """The samples of the latest solve that are exudyn's own: channel, joint, times and values.

    Of the state it started from they are only the run's first. The multipliers belong to a step, not to a state: loads
    have no sample at the start. Nor have accelerations where those of the scene were given to start from. Both have
    none at a jump, where they have two values.
    """
    given, end = world.given, -1 if before_jump else None
    data = [world.mbs.GetSensorStoredData(number) for number in range(given["sensors"])]
    time = world.begin + data[0][:, 0] if data else np.zeros(0)
    for channel, sensors in given["motion_sensors"].items():
        changes = channel == "acceleration"
        values = np.stack([data[sensor][:, 1:] for sensor in sensors], axis=1)
        if channel == "position":
            values += np.array(given["poses"]) + world.unwound
        is_own = first and not (changes and not given["as_shipped"])
        steps = slice(0 if is_own else 1, end if changes else None)
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
    """The samples of a course."""
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
