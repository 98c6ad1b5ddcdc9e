"""One pass in Pinocchio: the accelerations and forces of a state are Pinocchio's, the steps are taken here."""

from bisect import bisect_right
from collections.abc import Iterator
from math import tau
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

Array = NDArray[np.float64]
Data = dict[str, Any]

PROXIMAL = 0.0, 1e-8, 3  # accuracy, factor and iterations
LOADS = "forces", "torques", "springs", "dampers"
PLANE = [0, 1, 5]  # of a velocity's six components
# The states of a step after its first, position and velocity each, as shares of those of the first and of the
# accelerations of all before, apart from a power of the step. The last is the step's end.
POWERS = np.array([[0, 1, 2, 2, 2, 2], [0, 0, 1, 1, 1, 1]])
EULER = [[[1, 1, 1], [0, 1, 1]]]  # semi-implicit
RUNGE_KUTTA = [
    [[1, 1 / 2, 0, 0, 0, 0], [0, 1, 1 / 2, 0, 0, 0]],
    [[1, 1 / 2, 1 / 4, 0, 0, 0], [0, 1, 0, 1 / 2, 0, 0]],
    [[1, 1, 0, 1 / 2, 0, 0], [0, 1, 0, 0, 1, 0]],
    [[1, 1, 1 / 6, 1 / 6, 1 / 6, 0], [0, 1, 1 / 6, 1 / 3, 1 / 3, 1 / 6]],
]


class World:
    """The model in its start state: the ground is joint 0, the crank 1; the first constraint, of these two, drives."""

    def __init__(self, given: Data) -> None:
        self.given, self.model, self.centres = given, pin.Model(), [_frame(0j)]
        model, rows = self.model, [(pin.ContactType.CONTACT_6D, 1, _frame(0j), 0, _frame(0j))]
        model.gravity.linear = _space(complex(*given["gravity"]))
        for parent, place, turn, slides, mass, inertia, centre, *_ in given["joints"]:
            kind = pin.JointModelPX() if slides else pin.JointModelRZ()
            joint = model.addJoint(parent, kind, _frame(place, turn), f"joint {len(self.centres)}")
            self.centres.append(_frame(centre))
            model.appendBodyToJoint(joint, pin.Inertia(mass, np.zeros(3), inertia * np.eye(3)), self.centres[-1])
        for joint, point, other, there in given["cuts"]:
            rows.append((pin.ContactType.CONTACT_3D, joint, _frame(point), other, _frame(there)))
        constraints = [pin.RigidConstraintModel(kind, model, *ends, pin.LOCAL) for kind, *ends in rows]
        self.constraints = pin.StdVec_RigidConstraintModel(constraints)
        self.solved = pin.StdVec_RigidConstraintData([each.createData() for each in constraints])
        self.data, self.weightless, self.spare = model.createData(), model.copy(), model.createData()
        self.weightless.gravity.setZero()
        pin.initConstraintDynamics(model, self.data, self.constraints, self.solved)
        self.settings, self.efforts = pin.ProximalSettings(*PROXIMAL), np.zeros(model.nv)
        self.loads = pin.StdVec_Force([pin.Force.Zero() for _ in self.centres])
        self.state = np.array([(value, speed) for *_, value, speed in given["joints"]]).T
        pin.computeJointJacobians(model, self.data, self.state[0])
        self.turns = np.array([pin.getJointJacobian(model, self.data, n, pin.WORLD)[5] for n, _ in given["bodies"]])
        self.zero = [angle for _, angle in given["bodies"]] - self.turns @ self.state[0]

    def solve(self, time: float, position: Array, velocity: Array) -> Array:
        """Accelerations of a state."""
        if any(self.given[kind] for kind in LOADS):
            pin.forwardKinematics(self.model, self.data, position, velocity)
            self.set_loads(position[0])
            self.efforts = -pin.computeStaticTorque(self.weightless, self.spare, position, self.loads)
        desired = self.wanted(time) - 2.0 * self.rate * velocity[0] - self.rate**2 * position[0]
        self.solved[0].contact_acceleration_desired.angular[2] = desired
        state = position, velocity, self.efforts
        return pin.constraintDynamics(self.model, self.data, *state, self.constraints, self.solved, self.settings)

    def set_loads(self, angle: float) -> None:
        """The wrenches of all loads, springs and dampers on the bodies, in the frames of their joints."""
        given, data, loads = self.given, self.data, self.loads
        for load in loads:
            load.setZero()

        def push(joint: int, point: complex, force: Array) -> None:
            axes = pin.SE3(data.oMi[joint].rotation.T, _space(point))
            loads[joint] += axes.act(pin.Force(force, np.zeros(3)))

        def state(joint: int, point: complex) -> tuple[Array, Array]:
            place = _frame(point)
            rate = pin.getFrameVelocity(self.model, data, joint, place, pin.LOCAL_WORLD_ALIGNED)
            return (data.oMi[joint] * place).translation, rate.linear

        for joint, point, law in given["forces"]:
            push(joint, point, _space(complex(*law_values(law, angle))))
        for joint, law in given["torques"]:
            loads[joint].angular[2] += law_values(law, angle)[0]
        for first, point, second, other, stiffness, free_length, damping in given["springs"]:
            span, rate = np.subtract(state(first, point), state(second, other))
            length = np.linalg.norm(span) or 1.0  # ends that meet have no direction to pull in
            tension = stiffness * (length - free_length) + damping * (span @ rate) / length
            push(first, point, -tension * span / length)
            push(second, other, tension * span / length)
        for first, second, coefficient in given["dampers"]:
            drag = coefficient * (data.v[first].angular - data.v[second].angular)
            loads[first].angular -= drag
            loads[second].angular += drag

    def read(self, changes: Array) -> Data:
        """All channels at the state that was solved last."""
        model, data, loads, joints = self.model, self.data, self.loads.copy(), [n for n, _ in self.given["bodies"]]
        for tie, solved in zip(self.constraints, self.solved, strict=True):
            loads[tie.joint1_id] += tie.joint1_placement.act(solved.contact_force)
            loads[tie.joint2_id] -= (tie.joint2_placement * solved.c1Mc2.inverse()).act(solved.contact_force)
        pin.rnea(model, data, *self.state, changes, loads)
        forces = [place.rotation @ force.linear for place, force in zip(data.oMi, data.f, strict=True)]
        forces += [each.oMc1.rotation @ each.contact_force.linear for each in self.solved[1:]]
        pin.forwardKinematics(model, data, *self.state, changes)
        rates, seconds = (
            [call(model, data, n, self.centres[n], pin.LOCAL_WORLD_ALIGNED).vector[PLANE] for n in joints]
            for call in (pin.getFrameVelocity, pin.getFrameClassicalAcceleration)
        )
        places = [(data.oMi[n] * self.centres[n]).translation[:2] for n in joints]
        return {
            "position": np.column_stack([places, self.zero + self.turns @ self.state[0]]),
            "velocity": rates,
            "acceleration": seconds,
            "torque": self.solved[0].contact_force.angular[2],
            "joint_force": [sign * forces[number][:2] for number, sign in self.given["reactions"].values()],
        }

    def part_states(self, part: Data, ratio: int) -> Iterator[tuple[float, Data]]:
        """Instants of a part, s, and what is read at them."""
        steps, settle = part["samples"] * ratio, self.given["settle"]
        times, step = np.linspace(part["start"], part["end"], steps + 1, retstep=True)
        self.rate = rate = 1.0 / (settle * ratio * step) if settle else 0.0
        for each in self.constraints[1:]:
            each.m_baumgarte_parameters.Kp, each.m_baumgarte_parameters.Kd = rate**2, 2.0 * rate
        start, coefficients = part["segment"]
        angle = np.poly1d(coefficients[::-1])
        wanted = angle.deriv(2) + 2.0 * rate * angle.deriv() + rate**2 * angle
        self.wanted = lambda time: wanted(time - start)
        rule = np.array(RUNGE_KUTTA if settle else EULER, dtype=float)
        rule *= step ** POWERS[:, : rule.shape[2]]
        known = np.zeros((rule.shape[2], self.model.nv))
        for count, time in enumerate(times):
            known[:2] = state = self.state
            known[2] = self.solve(time, *state)
            if count % ratio == 0:
                yield time, self.read(known[2])
            for number, shares in enumerate(rule if count < steps else [], start=3):
                state = shares @ known
                if number < len(known):
                    known[number] = self.solve(time + shares[0, 1], *state)
            self.state = state


def law_values(law: Any, angle: float) -> Any:  # noqa: ANN401
    """A load's components at an angle: constants, or cubics that repeat or keep their end values."""
    if isinstance(law, list):
        return law
    knots, pieces, repeats = law
    angle = knots[0] + (angle - knots[0]) % tau if repeats else min(max(angle, knots[0]), knots[-1])
    piece = min(bisect_right(knots, angle), len(pieces)) - 1
    return [np.polyval(cubic[::-1], angle - knots[piece]) for cubic in pieces[piece]]


def _space(vector: complex) -> Array:
    return np.array([vector.real, vector.imag, 0.0])


def _frame(place: complex, turn: float = 0.0) -> Any:  # noqa: ANN401
    return pin.SE3(pin.utils.rotate("z", turn), _space(place))


def build(model: Data) -> World:
    """The world of a model."""
    return World(model)


def follow(world: World, course: Data) -> Data:
    """The samples of a course; of the two between parts the later part's counts."""
    rows: list[tuple[float, Data]] = []
    for part in course["parts"]:
        rows[-1:] = world.part_states(part, course["ratio"])
    time = np.array([instant for instant, _ in rows])
    samples: Data = {name: (time, np.array([row[name] for _, row in rows])) for name in course["channels"]}
    if "joint_force" in samples:
        _, forces = samples["joint_force"]
        samples["joint_force"] = {joint: (time, forces[:, n]) for n, joint in enumerate(world.given["reactions"])}
    return samples
