"""One pass in Pinocchio: the accelerations and forces of a state are Pinocchio's, the steps are taken here."""

import cmath
from bisect import bisect_right
from collections.abc import Iterator
from math import tau
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

Array = NDArray[np.float64]
Data = dict[str, Any]

CHANNELS = "position", "velocity", "acceleration", "torque"
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
    """The model in its start state.

    ``state`` has positions and velocities of all coordinates and, last, a 0 for the ground's; ``places`` has where
    among them x, y and angle of a body are.
    """

    def __init__(self, given: Data) -> None:
        self.given, self.model, numbers, ties = given, pin.Model(), {"ground": 0}, []
        model = self.model
        model.gravity.linear = np.array([*given["gravity"], 0.0])
        for name, host, place, turn, mass, inertia, *start in given["joints"]:
            joint = pin.JointModelComposite()
            for kind in (pin.JointModelPX, pin.JointModelPY, pin.JointModelRZ)[: len(start[0])]:
                joint.addJoint(kind())
            numbers[name] = model.addJoint(numbers[host], joint, _frame(place, turn), name)
            model.inertias[numbers[name]] = pin.Inertia(mass, np.zeros(3), inertia * np.eye(3))
        for _, is_rigid, _, (name, *here), (other, *there) in given["ties"]:
            kind = pin.ContactType.CONTACT_6D if is_rigid else pin.ContactType.CONTACT_3D
            ends = numbers[name], _frame(*here), numbers[other], _frame(*there)
            ties.append(pin.RigidConstraintModel(kind, model, *ends, pin.LOCAL))
        self.ties = pin.StdVec_RigidConstraintModel(ties)
        self.solved = pin.StdVec_RigidConstraintData([tie.createData() for tie in ties])
        self.drive, self.axes = self.solved[0], self.ties[0].joint1_placement.rotation[:2, :2]
        # Two iterations of the proximal term 1e-8: without such a term the empty rows make all NaN.
        self.data, self.settings = model.createData(), pin.ProximalSettings(0.0, 1e-8, 2)
        pin.initConstraintDynamics(model, self.data, self.ties, self.solved)
        starts = list(zip(*given["joints"], strict=True))[-2:]
        self.state, self.efforts = np.array([np.concatenate([*each, [0.0]]) for each in starts]), np.zeros(model.nv + 1)
        self.places = {name: [model.idx_vs[numbers[name]] + n for n in range(3)] for name in given["bodies"]}
        self.places["ground"] = [model.nv] * 3

    def solve(self, target: Array, position: Array, velocity: Array) -> Array:
        """Accelerations of a state, with the crank's target: rotation, and its acceleration in the other sense."""
        if any(self.given[kind] for kind in ("forces", "torques", "dampers")):
            self.set_loads(position, velocity)
        self.axes[:], self.drive.contact_acceleration_desired.angular[2] = target[:4].reshape(2, 2), target[4]
        state = position[:-1], velocity[:-1], self.efforts[:-1]
        return pin.constraintDynamics(self.model, self.data, *state, self.ties, self.solved, self.settings)

    def set_loads(self, position: Array, velocity: Array) -> None:
        """The efforts along the coordinates of all loads at a state."""
        given, efforts, places = self.given, self.efforts, self.places
        angle = position[places[given["ties"][0][-1][0]][2]]  # the crank's
        efforts[:] = 0.0
        for body, anchor, law in given["forces"]:
            force, arm = complex(*law_values(law, angle)), complex(*anchor) * cmath.rect(1.0, position[places[body][2]])
            efforts[places[body]] += force.real, force.imag, (arm.conjugate() * force).imag
        for body, law in given["torques"]:
            efforts[places[body][2]] += law_values(law, angle)[0]
        for first, second, coefficient in given["dampers"]:
            turns = [places[first][2], places[second][2]]
            efforts[turns] += coefficient * (velocity[turns[::-1]] - velocity[turns])

    def read(self, time: float, changes: Array) -> tuple[Any, ...]:
        """The instant, and all channels at the state that was solved last."""
        bodies = [values[list(self.places.values())[:-1]] for values in (*self.state, changes)]
        forces = [each.oMc1.rotation @ each.contact_force.linear for each in self.solved]
        reactions = [sign * force[:2] for (_, _, sign, *_), force in zip(self.given["ties"], forces, strict=True)]
        return time, *bodies, -self.drive.contact_force.angular[2], reactions

    def part_states(self, part: Data, ratio: int) -> Iterator[tuple[Any, ...]]:
        """What is read at the samples of a part."""
        steps, settle, (start, coefficients) = part["samples"] * ratio, self.given["settle"], part["segment"]
        times, step = np.linspace(part["start"], part["end"], steps + 1, retstep=True)
        rule = np.array(RUNGE_KUTTA if settle else EULER, dtype=float)
        rule *= step ** POWERS[:, : rule.shape[2]]
        rate = 1.0 / (settle * ratio * step) if settle else 0.0
        for tie in self.ties:
            tie.m_baumgarte_parameters.Kp, tie.m_baumgarte_parameters.Kd = rate**2, 2.0 * rate
        angle, clock = np.poly1d(coefficients[::-1]), np.add.outer(times - start, [0.0, *rule[:-1, 0, 1]])
        c, s, wanted = np.cos(angle(clock)), np.sin(angle(clock)), (angle.deriv(2) + 2.0 * rate * angle.deriv())(clock)
        targets = np.stack([c, -s, s, c, -wanted], axis=-1)
        known = np.zeros((rule.shape[2], self.model.nv + 1))
        for count, (time, target) in enumerate(zip(times, targets, strict=True)):
            known[:2] = state = self.state
            known[2, :-1] = self.solve(target[0], *state)
            if count % ratio == 0:
                yield self.read(time, known[2])
            for number, shares in enumerate(rule if count < steps else [], start=1):
                state = shares @ known
                if number < len(target):
                    known[2 + number, :-1] = self.solve(target[number], *state)
            self.state = state


def law_values(law: Any, angle: float) -> Any:  # noqa: ANN401
    """A load's components at an angle: constants, or cubics that repeat."""
    if isinstance(law, list):
        return law
    knots, pieces, _ = law
    angle = knots[0] + (angle - knots[0]) % tau
    piece = bisect_right(knots, angle) - 1
    x = angle - knots[piece]
    return [a + x * (b + x * (c + x * d)) for a, b, c, d in pieces[piece]]


def _frame(place: tuple[float, float], turn: float) -> Any:  # noqa: ANN401
    return pin.SE3(pin.utils.rotate("z", turn), np.array([*place, 0.0]))


def build(model: Data) -> World:
    """The world of a model."""
    return World(model)


def follow(world: World, course: Data) -> Data:
    """The samples of a course; of the two between parts the later part's counts."""
    rows: list[tuple[Any, ...]] = []
    for part in course["parts"]:
        rows[-1:] = world.part_states(part, course["ratio"])
    time, *channels, forces = (np.array(values) for values in zip(*rows, strict=True))
    samples = {name: (time, each) for name, each in zip(CHANNELS, channels, strict=True) if name in course["channels"]}
    if "joint_force" in course["channels"]:
        samples["joint_force"] = {name: (time, forces[:, n]) for n, (name, *_) in enumerate(world.given["ties"])}
    return samples
