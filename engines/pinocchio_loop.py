"""One pass in Pinocchio: the accelerations and forces of a state are Pinocchio's, the steps are taken here.

Data are the adapter's ``model``, in SI or the scene's own units. A course has ``parts`` of the motion, ``ratio`` steps
to a sample, and the ``channels`` to record. A part has its ``start`` and ``end``, s, a number of ``samples``, and a
``segment``: its own start, s, and φ's coefficients from then on, lowest power first.
"""

import cmath
from collections.abc import Iterator
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from engines.shared_loop import law_values, signals

Array = NDArray[np.float64]
Data = dict[str, Any]

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


class PinocchioWorld:
    """The model in its start state; ``columns`` are the coordinates x, y and angle of the scene's bodies.

    ``axes``, ``desired`` and ``forces`` are views of Pinocchio's memory: what is set of the drive, and what is read.
    """

    def __init__(self, given: Data) -> None:
        """Build Pinocchio's model of joints and ties from the adapter's data."""
        self.given, model, numbers, ties = given, pin.Model(), {"ground": 0}, []
        model.gravity.linear = np.array([*given["gravity"], 0.0])
        for name, host, place, turn, mass, inertia, *start in given["joints"]:
            joint = pin.JointModelComposite()
            for kind in (pin.JointModelPX, pin.JointModelPY, pin.JointModelRZ)[: len(start[0])]:
                joint.addJoint(kind())
            numbers[name] = model.addJoint(numbers[host], joint, _frame(place, turn), f"joint {len(numbers)}")
            model.inertias[numbers[name]] = pin.Inertia(mass, np.zeros(3), inertia * np.eye(3))
        for _, is_rigid, _, (name, *here), (other, *there) in given["ties"]:
            kind = pin.ContactType.CONTACT_6D if is_rigid else pin.ContactType.CONTACT_3D
            ends = numbers[name], _frame(*here), numbers[other], _frame(*there)
            ties.append(pin.RigidConstraintModel(kind, model, *ends, pin.LOCAL))
        self.ties = pin.StdVec_RigidConstraintModel(ties)
        self.solved = pin.StdVec_RigidConstraintData([tie.createData() for tie in ties])
        self.drive, self.axes = self.solved[0], self.ties[0].joint1_placement.rotation[:2, :2]
        self.desired = self.drive.contact_acceleration_desired.angular
        self.forces = [(each.oMc1.rotation, each.contact_force.linear) for each in self.solved]
        self.signs = np.array([[sign] for _, _, sign, *_ in given["ties"]])
        # Two iterations with a proximal term, 1e-8: without such a term empty rows make every number NaN.
        self.system, self.settings = (model, model.createData()), pin.ProximalSettings(0.0, 1e-8, 2)
        pin.initConstraintDynamics(*self.system, self.ties, self.solved)
        starts = list(zip(*given["joints"], strict=True))[-2:]
        self.state = np.array([np.concatenate(values) for values in starts])
        self.rows = {name: row for row, name in enumerate(given["bodies"])}
        self.columns = np.array([model.idx_vs[numbers[name]] + np.arange(3) for name in self.rows])
        self.pushed = [self.columns[self.rows[body], 2] for body, *_ in given["forces"]]
        self.damping = np.zeros((model.nv, model.nv))
        for *ends, coefficient in given["dampers"]:
            turns = [self.columns[self.rows[end], 2] for end in ends if end in self.rows]  # not the ground
            self.damping[np.ix_(turns, turns)] += coefficient * (2.0 * np.eye(len(turns)) - 1.0)

    def solve(self, target: list[Any], position: Array, velocity: Array) -> Any:  # noqa: ANN401
        """Joint accelerations in a state; the ties' forces are then in ``forces``.

        ``target`` has the axes (2, 2) of the crank's frame, the acceleration, rad/s², that Pinocchio desires of its
        tie, the efforts along the coordinates, to which dampers and couples are added in place, and each force's
        couple, N m: the imaginary part of a complex number that is turned back by the body's angle.
        """
        self.axes[:], self.desired[2], efforts, couples = target
        if self.given["dampers"]:
            efforts -= self.damping.dot(velocity)
        for turn, couple in zip(self.pushed, couples, strict=True) if self.pushed else ():
            efforts[turn] += (couple * cmath.rect(1.0, -position[turn])).imag
        return pin.constraintDynamics(*self.system, position, velocity, efforts, self.ties, self.solved, self.settings)

    def read(self, changes: Array) -> Data:
        """Motion, torque and joint forces, by channel, of the state solved last; ``changes`` are its accelerations.

        Forces are on the joints' first bodies, ground frame.
        """
        position, velocity, acceleration = (values[self.columns] for values in (*self.state, changes))
        return {
            "position": position,
            "velocity": velocity,
            "acceleration": acceleration,
            "torque": -self.drive.contact_force.angular[2],
            "joint_force": self.signs * [(axes @ force)[:2] for axes, force in self.forces],
        }

    def part_states(self, part: Data, ratio: int) -> Iterator[tuple[float, Data]]:
        """Step through a part, ``ratio`` steps to a sample, and yield each sample: time, s, and data as from ``read``.

        The world's state goes along.
        """
        steps, settle, (start, coefficients) = part["samples"] * ratio, self.given["settle"], part["segment"]
        times, step = np.linspace(part["start"], part["end"], steps + 1, retstep=True)
        rule = np.array(RUNGE_KUTTA if settle else EULER, dtype=float)
        rule *= step ** POWERS[:, : rule.shape[2]]
        rate = 1.0 / (settle * ratio * step) if settle else 0.0
        for tie in self.ties:
            tie.m_baumgarte_parameters.Kp, tie.m_baumgarte_parameters.Kd = rate**2, 2.0 * rate
        clock, angle = np.add.outer(times - start, [0.0, *rule[:-1, 0, 1]]), np.poly1d(coefficients[::-1])
        wanted, angles = (angle.deriv(2) + 2.0 * rate * angle.deriv())(clock), angle(clock)
        c, s = np.cos(angles), np.sin(angles)
        turned = np.array([[c, -s], [s, c]]).transpose(2, 3, 0, 1)
        efforts = np.zeros((*clock.shape, len(self.damping)))
        couples = np.zeros((*clock.shape, len(self.pushed)), complex)
        for number, (body, anchor, law) in enumerate(self.given["forces"]):
            force = np.array([law_values(law, each) for each in angles.flat]).reshape(*angles.shape, 2)
            efforts[..., self.columns[self.rows[body], :2]] += force
            couples[..., number] = force @ [1.0, 1j] * complex(*anchor).conjugate()  # of the body at its angle 0
        for body, law in self.given["torques"]:
            moment = np.array([law_values(law, each) for each in angles.flat])
            efforts[..., self.columns[self.rows[body], 2]] += moment.reshape(angles.shape)
        known = np.zeros((rule.shape[2], len(self.damping)))
        for count, (time, *targets) in enumerate(zip(times, turned, -wanted, efforts, couples, strict=True)):
            known[:2] = state = self.state
            for number, (shares, *target) in enumerate(zip(rule, *targets, strict=True), start=2):
                known[number] = self.solve(target, *state)
                if number == 2 and count % ratio == 0:
                    yield time, self.read(known[2])
                state = shares.dot(known)
            self.state = state if count < steps else self.state


def _frame(place: tuple[float, float], turn: float) -> Any:  # noqa: ANN401
    """A frame of Pinocchio's, an SE3, at a place in the plane, m, turned by an angle, rad."""
    return pin.SE3(pin.utils.rotate("z", turn), np.array([*place, 0.0]))


def build(model: Data) -> PinocchioWorld:
    """The world of a model, the adapter's data, in its start state."""
    return PinocchioWorld(model)


def follow(world: PinocchioWorld, course: Data) -> Data:
    """Step through all parts of a course and return its samples; at a border of parts the later part's counts.

    They are times, s, and values by channel, and by joint under "joint_force".
    """
    rows: list[tuple[float, Data]] = []
    for part in course["parts"]:
        rows[-1:] = world.part_states(part, course["ratio"])
    return signals(rows, course["channels"], [name for name, *_ in world.given["ties"]])
