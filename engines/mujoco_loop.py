"""One pass in MuJoCo: the drive and the loads by the control callback, read-outs at samples between steps."""

from collections.abc import Callable, Iterator
from functools import reduce
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines.shared_loop import law_values, signals

Array = NDArray[np.float64]
Data = dict[str, Any]
Planar = list[complex]  # a vector in the plane for every body, the ground last

PLANE = np.array([1.0, 1j, 0.0])  # vectors of space as complex numbers
KINEMATICS = ("position", "velocity", "acceleration")


class MujocoWorld:
    """The compiled model in its start state; ``sums`` has for every body which hinges' angles add up to its own."""

    def __init__(self, given: Data) -> None:
        self.given = given
        try:
            self.model = model = mujoco.MjModel.from_xml_string(given["xml"])
        except ValueError as error:
            raise ArithmeticError(f"MuJoCo takes no such model: {error}") from error
        self.data = data = mujoco.MjData(model)
        self.numbers = [*(model.body(name).id for name in given["bodies"]), 0]  # of the scene's bodies and the ground
        self.crank = model.joint(given["driven"]).id
        if given["is_linear"]:  # a rod without a weight to speak of would make its drive as soft
            model.dof_invweight0[self.crank] = model.body_invweight0[self.numbers[:-1], 0].min()
        if given["settle"]:
            model.opt.tolerance, model.opt.iterations = 0.0, 2  # the second is for the rounding of the first
            lightest = model.body_invweight0[self.numbers].max(axis=0)
            weights = np.minimum(model.body_invweight0, lightest)  # blocks weigh nothing
            model.body_invweight0[:] = given["harder"] * weights
            model.dof_invweight0[:] *= given["harder"]
        for name, speed in given["speeds"].items():
            data.joint(name).qvel[:] = speed
        data.qfrc_applied[self.crank] = given["torque"]
        mujoco.mj_forward(model, data)
        hinges = [model.joint(number).name for number in range(model.nv)]
        self.sums = np.array([[name in own for name in hinges] for _, own in given["bodies"].values()], dtype=float)
        self.angles = np.array([angle for angle, _ in given["bodies"].values()])

    def kinematics(self, order: int) -> Array:
        """Rows x, y, angle of the bodies, or their first or second rates."""
        data = self.data
        frames = data.sensordata.reshape(len(self.angles), len(KINEMATICS), 3)[:, order, :2]
        turns = self.sums @ (data.qpos, data.qvel, data.qacc)[order]
        return np.column_stack([
            frames + self.given["gravity"] if order == 2 else frames, turns if order else turns + self.angles,
        ])  # fmt: skip

    def joint_forces(self) -> Array:
        """Forces on the first bodies of the joints, (joints, 2)."""
        model, data, forces = self.model, self.data, list[Array]()
        for kind, name, sign, normal in self.given["joints"].values():
            if kind == "equality":
                forces.append(data.efc_force[data.efc_id == model.equality(name).id][:2])
                continue
            force = sign * data.cfrc_int[model.body(name).id, 3:5]
            forces.append(np.multiply(normal, force @ normal) if normal else force)  # else the drive's is in it
        return np.array(forces)

    def torque(self) -> float:
        """The drive's torque, or the force of a linear drive."""
        return float(self.data.efc_force[0])

    def read(self, channels: list[str]) -> Data:
        """The requested channels at the present instant."""
        readers = {"torque": self.torque, "joint_force": self.joint_forces}
        return {
            name: readers[name]() if name in readers else self.kinematics(KINEMATICS.index(name)) for name in channels
        }

    def control(self, segment: tuple[float, list[float]] | None) -> Callable[[Any, Any], None] | None:
        """The callback of every stage: the drive's reference acceleration and the loads; None if it has nothing to set.

        The reference is ε + 2/τ (ω − q') + 1/τ² (φ − q), τ being the constraints' time constant.
        """
        data, crank, given, numbers = self.data, self.crank, self.given, self.numbers
        start, times, loaded = given["start"], given["torque_over_time"], given["loads"] or given["springs"]
        roots = self.model.body_rootid[numbers]
        if segment:
            zero, coefficients = segment
            rate = 1.0 / float(self.model.eq_solref[0, 0])
            angle = np.poly1d(coefficients[::-1])
            reference = (angle.deriv(2) + 2.0 * rate * angle.deriv() + rate**2 * (angle - start)).coeffs.tolist()

        def control(_model: object, stage: Any) -> None:  # noqa: ANN401
            if segment:
                x = stage.time - zero
                value = reduce(lambda total, coefficient: total * x + coefficient, reference)
                stage.efc_aref[0] = value - 2.0 * rate * data.qvel[crank] - rate**2 * data.qpos[crank]
            if times:
                data.qfrc_applied[crank] = given["torque"] + np.interp(stage.time, *times)
            if loaded:
                centre, direction = data.xipos[numbers] @ PLANE, data.xmat[numbers][:, [0, 3, 6]] @ PLANE
                spin, arm = data.cvel[numbers, 2], centre - data.subtree_com[roots] @ PLANE
                velocity = data.cvel[numbers, 3:] @ PLANE + 1j * spin * arm  # MuJoCo's is at the tree's mass centre
                state = (centre.tolist(), direction.tolist(), velocity.tolist(), spin.tolist())
                data.xfrc_applied[np.ix_(numbers, (0, 1, 5))] = load_rows(given, start + data.qpos[crank], state)

        return control if segment or times or loaded else None

    def states(self, part: Data, course: Data, warnings: list[str]) -> Iterator[tuple[float, Data]]:
        """Instants of a part, s, and what is read at them."""
        model, data, settle = self.model, self.data, self.given["settle"]
        sample = (part["end"] - part["start"]) / part["samples"]
        model.opt.timestep = sample / course["ratio"]
        model.eq_solref[:, 0] = settle * sample or 0.02  # s, as shipped
        mujoco.set_mjcb_control(self.control(part["segment"]))
        for instant in np.linspace(part["start"], part["end"], part["samples"] + 1).tolist():
            if instant > part["start"]:
                mujoco.mj_step(model, data, nstep=course["ratio"])
            data.time = instant
            if settle:
                mujoco.mj_forward(model, data)  # or forces and accelerations are those of the last step's last stage
            mujoco.mj_rnePostConstraint(model, data)
            if warnings:
                raise ArithmeticError(f"MuJoCo warns: {warnings[0]}")
            yield instant, self.read(course["channels"])


def load_rows(given: Data, angle: float, state: tuple[Planar, Planar, Planar, list[float]]) -> list[list[float]]:
    """Force x, y, N, and moment about the mass centre, N m, of loads and springs on every body and the ground.

    The state is every body's mass centre, direction (of length one), velocity, complex, and angular velocity.
    """
    centre, direction, velocity, spin = state
    rows = [[0.0, 0.0, 0.0] for _ in centre]

    def push(body: int, arm: complex, force: complex) -> None:
        row = rows[body]
        row[0] += force.real
        row[1] += force.imag
        row[2] += (arm.conjugate() * force).imag

    for body, anchor, law in given["loads"]:
        components = law_values(law, angle)
        if len(components) > 1:
            push(body, anchor * direction[body], complex(*components))
        else:
            rows[body][2] += components[0]
    for first, first_anchor, second, second_anchor, stiffness, free_length, damping in given["springs"]:
        arm, other = first_anchor * direction[first], second_anchor * direction[second]
        span = centre[first] + arm - centre[second] - other
        rate = velocity[first] + 1j * spin[first] * arm - velocity[second] - 1j * spin[second] * other
        length = abs(span)
        along = span / (length or 1.0)  # ends that meet have no direction to pull in
        tension = stiffness * (length - free_length) + damping * (along.conjugate() * rate).real
        push(first, arm, -tension * along)
        push(second, other, tension * along)
    return rows


def build(model: Data) -> MujocoWorld:
    """The world of a model."""
    return MujocoWorld(model)


def follow(world: MujocoWorld, course: Data) -> Data:
    """The samples of a course; of the two between parts the later part's counts."""
    rows: list[tuple[float, Data]] = []
    warnings: list[str] = []
    mujoco.set_mju_user_warning(warnings.append)  # or they go to the terminal and into a file
    try:
        for part in course["parts"]:
            rows[-1:] = world.states(part, course, warnings)
    finally:
        mujoco.set_mjcb_control(None)
        mujoco.set_mju_user_warning(None)
    return signals(rows, course["channels"], world.given["joints"])
