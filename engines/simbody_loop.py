"""One pass in Simbody, through OpenSim: a manager for each part of the motion, from where the one before ended.

Data are the adapter's ``model``, in SI or the scene's own units. A course has ``parts`` of the motion, ``ratio`` steps
to a sample, and the ``channels`` to record. A part has its ``start`` and ``end``, s, a number of ``samples``, and a
``segment``: its own start, s, and φ's coefficients from then on, lowest power first, or None for a free driver.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
import opensim
from numpy.typing import NDArray

from engines.shared_loop import law_values, signals

Array = NDArray[np.float64]
Data = dict[str, Any]

RAPID = 1e3  # rad/s: a crank's speed beyond which the tolerance grows with it
KINEMATICS = {
    "position": ("getPositionInGround", "getValue"),
    "velocity": ("getLinearVelocityInGround", "getSpeedValue"),
    "acceleration": ("getLinearAccelerationInGround", "getAccelerationValue"),
}

opensim.Logger.setLevelString("Off")  # or it prints, and leaves a log file


def vec3(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Any:  # noqa: ANN401
    """A vector of OpenSim's from its components."""
    return opensim.Vec3(float(x), float(y), float(z))


def in_plane(space: Any, factor: float = 1.0) -> tuple[float, float]:  # noqa: ANN401
    """The x and y components of a vector of OpenSim's, times a factor."""
    return factor * space.get(0), factor * space.get(1)


class SimbodyWorld:
    """The model; bodies, joints and coordinates are in the order of the tree, the ground is body -1.

    ``loads`` take three functions of time each, which every part of the motion gives them anew.
    """

    def __init__(self, given: Data) -> None:
        """Build OpenSim's model from the plain data of the adapter's ``model``; loads have no functions yet."""
        self.given, self.model = given, opensim.Model()
        self.model.setGravity(vec3(*given["gravity"]))
        self.frames = [self.model.getGround()]  # the last is body -1
        self.joints, self.coordinates, self.cuts, self.loads = list[Any](), list[Any](), list[Any](), list[Any]()
        for body in given["bodies"]:
            self.add_body(body)
        for cut in given["cuts"]:
            self.add_loop_constraint(cut)
        for first, here, second, there, law in given["springs"]:
            entry, other = self.frames[first].getName(), self.frames[second].getName()
            points = vec3(*here), vec3(*there)
            self.model.addForce(opensim.ExpressionBasedPointToPointForce(entry, points[0], other, points[1], law))
        self.readers = {
            channel: [
                (getattr(self.frames[body], place), [getattr(self.coordinates[n], rate) for n in turning], angle)
                for body, turning, angle in given["read"]
            ]
            for channel, (place, rate) in KINEMATICS.items()
        }
        for number, (first, second, coefficient) in enumerate(given["dampers"]):
            ends, drag = (self.frames[first], self.frames[second]), vec3(0.0, 0.0, coefficient)
            still = vec3(), vec3(), vec3()
            self.model.addForce(opensim.BushingForce(f"damper{number}", *ends, *still, drag))
        for number, (body, anchor, law) in enumerate(given["loads"]):
            load = opensim.PrescribedForce(f"load{number}", self.frames[body])
            load.setPointFunctions(*(opensim.Constant(float(each)) for each in (*anchor, 0.0)))
            self.model.addForce(load)
            self.loads.append(load.setTorqueFunctions if components(law) == 1 else load.setForceFunctions)

    def add_body(self, body: Data) -> None:
        """Put a body, its frame at its mass centre, on its parent by a joint, and start its coordinate, if any.

        ``body`` is the adapter's data of it, by name.
        """
        number = len(self.joints) + 1
        frame = opensim.Body(f"body{number}", body["mass"], vec3(), opensim.Inertia(*[body["inertia"]] * 3))
        self.model.addBody(frame)
        sides = zip(body["points"], body["tilts"], strict=True)
        parent, child = ((vec3(*point), vec3(0.0, 0.0, tilt)) for point, tilt in sides)
        joint = getattr(opensim, body["joint"])(f"joint{number}", self.frames[body["parent"]], *parent, frame, *child)
        self.model.addJoint(joint)
        coordinate = None
        if body["joint"] != "WeldJoint":
            coordinate = joint.updCoordinate()
            coordinate.setDefaultValue(body["value"])
            coordinate.setDefaultSpeedValue(body["speed"])
        self.frames.insert(-1, frame)
        self.joints.append(joint)
        self.coordinates.append(coordinate)

    def add_loop_constraint(self, cut: Data) -> None:
        """Add a constraint for a joint that closes a loop, of which ``cut`` is the adapter's data, by name."""
        (first, second), (on_first, on_second) = cut["bodies"], (vec3(*anchor) for anchor in cut["anchors"])
        if cut["along"] is None:
            ends = self.frames[first], on_first, self.frames[second], on_second
            self.cuts.append(opensim.PointConstraint(*ends))
        else:
            line = self.frames[second], vec3(*cut["along"]), on_second
            self.cuts.append(opensim.PointOnLineConstraint(*line, self.frames[first], on_first))
        self.model.addConstraint(self.cuts[-1])

    def force(self, number: int, sign: float, state: Any) -> tuple[float, float]:  # noqa: ANN401
        """The force, N, that a joint of the tree exerts on its parent or, with the sign -1, on its body.

        It is in the ground frame, of joint ``number`` of the tree, at a realised state.
        """
        return in_plane(self.joints[number].calcReactionOnParentExpressedInGround(state).get(1), sign)

    def cut_force(self, number: int, state: Any) -> tuple[float, float]:  # noqa: ANN401
        """Force, N, ground frame, on the first body of the cut of this number, at a realised state.

        The constraint has its reverse, in the axes of the body that carries both.
        """
        cut, row = (
            self.given["cuts"][number],
            0 if self.given["cuts"][number]["along"] is None else 6,
        )  # behind a line's
        taken_up = vec3(*map(self.cuts[number].getRecordValues(state).get, (row, row + 1)))
        return in_plane(self.frames[cut["carrier"]].expressVectorInGround(state, taken_up), -1.0)

    def torque(self, state: Any) -> float:  # noqa: ANN401
        """The drive's torque, N m, or force along its slide, N, by the driven joint's reaction at a realised state."""
        number, sign, along = self.given["drive"]
        if along is None:
            reaction = self.joints[number].calcReactionOnParentExpressedInGround(state)
            return float(-reaction.get(0).get(2))
        host = self.frames[self.given["bodies"][number]["parent"]]
        line = in_plane(host.expressVectorInGround(state, vec3(*along)))
        return float(np.dot(self.force(number, sign, state), line))

    def joint_forces(self, state: Any) -> list[Any]:  # noqa: ANN401
        """Forces, N, on the joints' first bodies, in order; of a driven slider's, the part across its guide.

        They are in the ground frame, at a realised state.
        """
        forces = list[Any]()
        for is_cut, number, sign, normal in self.given["joints"].values():
            force = self.cut_force(number, state) if is_cut else self.force(number, sign, state)
            forces.append(force if normal is None else np.multiply(normal, np.dot(force, normal)))
        return forces

    def kinematics(self, channel: str, state: Any) -> list[tuple[float, ...]]:  # noqa: ANN401
        """Rows of x, y and angle, for "position", or their rates, of the bodies; angles are not wrapped."""
        rows = list[tuple[float, ...]]()
        for place, rates, angle in self.readers[channel]:
            turned = sum([rate(state) for rate in rates], angle if channel == "position" else 0.0)
            rows.append((*in_plane(place(state)), turned))
        return rows

    def read(self, channels: list[str], state: Any) -> Data:  # noqa: ANN401
        """The values of the requested channels at a state, by name; realises the state's accelerations."""
        self.model.realizeAcceleration(state)
        dynamics = {"torque": self.torque, "joint_force": self.joint_forces}
        return {name: dynamics[name](state) if name in dynamics else self.kinematics(name, state) for name in channels}


def components(law: Any) -> int:  # noqa: ANN401
    """Number of components of a load's law, as ``load_functions`` takes it: 2 for a force, 1 for a torque."""
    return len(law) if isinstance(law, list) else 1 if isinstance(law, dict) else len(law[1][0])


def load_functions(law: Any, time: Array, angle: Array) -> list[Any]:  # noqa: ANN401
    """Three functions of time for OpenSim: x and y of a force, and zero, or zeros and a torque.

    The law is a list of constants, a dictionary of ``times``, s, and ``torque`` with straight lines between and its end
    values beyond, or knots, cubics and a period over φ: it is then taken at ``angle`` (n,), φ at each ``time`` (n,), s,
    and splined between.
    """
    result = [opensim.Constant(0.0) for _ in range(3)]
    if isinstance(law, dict):
        result[2], times = opensim.PiecewiseLinearFunction(), law["times"]
        for point in zip((times[0] - 1.0, *times, times[-1] + 1.0), np.pad(law["torque"], 1, "edge"), strict=True):
            result[2].addPoint(*map(float, point))  # it goes on beyond as it does at its end
        return result
    first = 0 if components(law) > 1 else 2
    if isinstance(law, list):
        return result[:first] + [opensim.Constant(float(value)) for value in law] + result[first + len(law) :]
    for axis, values in enumerate(np.array([law_values(law, each) for each in angle]).T.tolist(), start=first):
        result[axis] = opensim.SimmSpline()
        for point in zip(time.tolist(), values, strict=True):
            result[axis].addPoint(*point)
    return result


def build(model: Data) -> SimbodyWorld:
    """The world of a model, the adapter's data, before its first part."""
    return SimbodyWorld(model)


def follow(world: SimbodyWorld, course: Data) -> Data:
    """Step through all parts of a course and return its samples; at a border of parts the later part's counts.

    They are times, s, and values by channel, and by joint under "joint_force". Raises ArithmeticError where Simbody
    gives up.
    """
    rows: list[tuple[float, Data]] = []
    for part in course["parts"]:
        rows[-1:] = part_states(world, part, course)
    return signals(rows, course["channels"], world.given["joints"])


def part_states(world: SimbodyWorld, part: Data, course: Data) -> Iterator[tuple[float, Data]]:
    """Step through a part and yield each sample: time, s, and values by channel.

    Raises ArithmeticError where Simbody gives up. OpenSim's clock restarts every segment. At the end the model keeps
    the state, from which the next part begins.
    """
    model, given = world.model, world.given
    time = np.linspace(part["start"], part["end"], part["samples"] + 1)
    zero, coefficients = part["segment"] or (0.0, [0.0])
    clock = time - zero
    angle = np.poly1d(coefficients[::-1])
    if part["segment"]:
        driver = world.coordinates[given["drive"][0]]
        driver.setPrescribedFunction(opensim.PolynomialFunction(opensim.Vector.createFromMat(angle.coeffs)))
        driver.setDefaultIsPrescribed(True)
    for apply, (_, _, law) in zip(world.loads, given["loads"], strict=True):
        apply(*load_functions(law, clock, angle(clock)))
    state = model.initSystem()
    state.setTime(clock[0])
    manager = opensim.Manager(model)
    manager.setWriteToStorage(False)
    if given["tolerance"] is not None:  # for velocities too, of which rounding leaves more where they are large
        speed = float(np.abs(angle.deriv()(clock)).max())
        manager.setIntegratorConstraintTolerance(given["tolerance"] * max(1.0, speed / RAPID))
    set_step = manager.setIntegratorFixedStepSize if given["fixed"] else manager.setIntegratorMaximumStepSize
    set_step((part["end"] - part["start"]) / part["samples"] / course["ratio"])
    try:
        manager.initialize(state)
        for at_time, instant in zip(time.tolist(), clock.tolist(), strict=True):
            manager.setIntegratorFinalTime(instant)  # or it steps beyond and interpolates
            state = manager.integrate(instant) if instant > clock[0] else manager.getState()
            yield at_time, world.read(course["channels"], state)
    except RuntimeError as error:
        raise ArithmeticError(f"Simbody gave up: {' '.join(str(error).rpartition('because:')[2].split())}") from error
    model.setPropertiesFromState(state)  # where the next part begins
