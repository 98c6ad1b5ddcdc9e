"""One pass in MuJoCo: the drive and the loads by the control callback, read-outs at samples between steps.

Data are the adapter's ``model``, in SI or the scene's own units. A course has ``parts`` of the motion, ``ratio`` steps
to a sample, and the ``channels`` to record. A part has its ``start`` and ``end``, s, a number of ``samples``, and a
``segment``: its own start, s, and φ's coefficients from then on, lowest power first, or None for a free driver.
"""

import math
from collections.abc import Callable, Iterator
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines.shared_loop import law_values

Array = NDArray[np.float64]
Data = dict[str, Any]
Planar = list[complex]  # a vector in the plane for every body, the ground last

PLANE = np.array([1.0, 1j, 0.0])  # vectors of space as complex numbers
KINEMATICS = {"position": "qpos", "velocity": "qvel", "acceleration": "qacc"}
MOST_ROUNDS, SETTLED = 400, 1e-8  # of friction; its change over the largest; the softness leaves some 1e-10
READ = (*KINEMATICS.values(), "sensordata", "cfrc_int", "efc_force")


class MujocoWorld:
    """The compiled model in its start state.

    ``sums`` has for every body which hinges' angles add up to its own, ``sources`` for every joint where its force is:
    rows of ``efc_force``, or the number of a body; its sign, and along what alone.
    """

    def __init__(self, given: Data) -> None:
        """Build MuJoCo's model from the adapter's data, its XML; raises ArithmeticError if MuJoCo refuses it."""
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
        self.rubbing = [0.0] * len(given["friction"])
        self.angles = np.array([angle for angle, _ in given["bodies"].values()])
        self.sources = {
            joint: (np.flatnonzero(data.efc_id == model.equality(name).id)[:2], None, 1.0, None)
            if kind == "equality"
            else (None, model.body(name).id, sign, normal)
            for joint, (kind, name, sign, normal) in given["joints"].items()
        }

    def read(self, instant: float) -> tuple[Any, ...]:
        """A tuple of the instant, s, and copies of MuJoCo's arrays named in ``READ``."""
        return instant, *(getattr(self.data, name).copy() for name in READ)

    def samples(self, rows: list[tuple[Any, ...]], channels: list[str]) -> Data:
        """Times, s, and values of these channels, by channel, from rows that ``read`` has returned.

        "joint_force" has a pair for each joint. Where a joint has friction, torque and joint forces lack the samples at
        rest.
        """
        time, *values = map(np.array, zip(*rows, strict=True))
        found, result = dict(zip(READ, values, strict=True)), Data()
        frames = found["sensordata"].reshape(len(time), len(self.angles), len(KINEMATICS), 3)[..., :2]
        frames[:, :, 2] += self.given["gravity"]
        for order, (name, coordinates) in enumerate(KINEMATICS.items()):
            turns = found[coordinates] @ self.sums.T + (0.0 if order else self.angles)
            result[name] = time, np.concatenate([frames[:, :, order], turns[..., None]], axis=-1)
        result["torque"] = time, found["efc_force"][:, 0]  # or the force of a linear drive
        result["joint_force"] = {}
        for joint in self.sources:
            result["joint_force"][joint] = time, self.joint_force(joint, found["cfrc_int"], found["efc_force"])
        if self.given["friction"]:  # at rest there is no direction that it acts against
            moves = found["qvel"][:, self.crank] != 0.0
            result["torque"] = time[moves], result["torque"][1][moves]
            result["joint_force"] = {k: (time[moves], f[moves]) for k, (_, f) in result["joint_force"].items()}
        return {name: result[name] for name in channels}

    def joint_force(self, joint: str, cfrc_int: Array, efc_force: Array) -> Array:
        """Force on a joint's first body, N, (..., 2), from MuJoCo's arrays of one or several instants."""
        rows, body, sign, normal = self.sources[joint]
        force = sign * (cfrc_int[..., body, 3:5] if rows is None else efc_force[..., rows])
        return np.multiply.outer(force @ normal, normal) if normal else force

    def settle_forces(self) -> None:
        """Compute the forces of the present state, with friction by repeated substitution.

        Raises ArithmeticError where they grow without end.
        """
        model, data = self.model, self.data
        for _ in range(MOST_ROUNDS):
            mujoco.mj_forward(model, data)
            before = self.rubbing
            self.rub()
            if all(abs(a - b) <= SETTLED * max(self.rubbing) for a, b in zip(self.rubbing, before, strict=True)):
                return
        raise ArithmeticError("the friction of the joints grows without end, as in a linkage that locks itself")

    def rub(self) -> None:
        """Set ``rubbing``, the friction of every joint that has it, N or N m, by the joints' forces computed last."""
        data = self.data
        mujoco.mj_rnePostConstraint(self.model, data)
        self.rubbing = [
            size * float(np.hypot(*self.joint_force(joint, data.cfrc_int, data.efc_force)))
            for joint, size, *_ in self.given["friction"]
        ]

    def control(self, segment: tuple[float, list[float]] | None) -> Callable[[Any, Any], None] | None:
        """The function that MuJoCo calls at every stage to set reference acceleration, torque and loads.

        None without any. It takes MuJoCo's model and data. ``segment`` is the start, s, of a piece of prescribed motion
        and its coefficients, lowest order first, None if the crank is free. The reference is ε + 2/τ (ω − q') +
        1/τ² (φ − q), τ being the constraints' time constant.
        """
        data, crank, given, numbers = self.data, self.crank, self.given, self.numbers
        position, velocity, pushed = data.qpos, data.qvel, np.ix_(numbers, (0, 1, 5))
        start, times = given["start"], given["torque_over_time"]
        loaded = given["loads"] or given["springs"] or given["friction"]
        roots = self.model.body_rootid[numbers]
        if segment:
            zero, coefficients = segment
            rate = 1.0 / float(self.model.eq_solref[0, 0])
            angle = np.poly1d(coefficients[::-1])
            reference = (angle.deriv(2) + 2.0 * rate * angle.deriv() + rate**2 * (angle - start)).coeffs.tolist()

        def control(_model: object, stage: Any) -> None:  # noqa: ANN401
            """Set the drive's reference acceleration, its torque and the loads at a stage, MuJoCo's data, of a step."""
            if segment:
                x, value = stage.time - zero, 0.0
                for coefficient in reference:
                    value = value * x + coefficient
                stage.efc_aref[0] = value - 2.0 * rate * velocity.item(crank) - rate**2 * position.item(crank)
            if times:
                data.qfrc_applied[crank] = given["torque"] + np.interp(stage.time, *times)
            if loaded:
                centre, direction = data.xipos[numbers] @ PLANE, data.xmat[numbers][:, [0, 3, 6]] @ PLANE
                spin, arm = data.cvel[numbers, 2], centre - data.subtree_com[roots] @ PLANE
                speed = data.cvel[numbers, 3:] @ PLANE + 1j * spin * arm  # MuJoCo's is at the tree's mass centre
                state = (centre.tolist(), direction.tolist(), speed.tolist(), spin.tolist())
                data.xfrc_applied[pushed] = load_rows(given, start + position.item(crank), state, self.rubbing)

        return control if segment or times or loaded else None

    def states(self, part: Data, course: Data, warnings: list[str]) -> Iterator[tuple[Any, ...]]:
        """Step through a part and yield its samples, start and end included, as ``read`` returns them.

        ``warnings`` are MuJoCo's so far; raises ArithmeticError for any, and for friction that grows without end. Sets
        MuJoCo's control callback, and leaves it set.
        """
        model, data, settle = self.model, self.data, self.given["settle"]
        sample = (part["end"] - part["start"]) / part["samples"]
        model.opt.timestep = sample / course["ratio"]
        model.eq_solref[:, 0] = settle * sample or 0.02  # s, as shipped
        mujoco.set_mjcb_control(self.control(part["segment"]))
        for instant in np.linspace(part["start"], part["end"], part["samples"] + 1).tolist():
            if instant > part["start"]:
                mujoco.mj_step(model, data, nstep=course["ratio"])
            data.time = instant
            if settle:  # or forces and accelerations are those of the last step's last stage
                self.settle_forces()
            else:
                self.rub()
            if warnings:
                raise ArithmeticError(f"MuJoCo warns: {warnings[0]}")
            yield self.read(instant)


def load_rows(
    given: Data, angle: float, state: tuple[Planar, Planar, Planar, list[float]], rubbing: list[float]
) -> list[list[float]]:
    """Rows of force x, y, N, and moment about the mass centre, N m, on each body and, last, the ground.

    They are those of loads, springs and friction. ``angle`` is φ, rad or m. The state is every body's mass centre,
    direction (of length one), velocity, complex, and angular velocity. ``rubbing`` is the friction of every joint that
    has it, N or N m.
    """
    centre, direction, velocity, spin = state
    rows = [[0.0, 0.0, 0.0] for _ in centre]

    def push(body: int, arm: complex, force: complex) -> None:
        """Add a force, N, at an ``arm`` from a body's mass centre to the body's row; vectors are complex."""
        row = rows[body]
        row[0] += force.real
        row[1] += force.imag
        row[2] += (arm.conjugate() * force).imag

    travel = advance = 0.0
    if given["travel"]:
        body, anchor, along, zero = given["travel"]
        arm = anchor * direction[body]
        travel = zero - (along.conjugate() * (centre[body] + arm)).real
        advance = -(along.conjugate() * (velocity[body] + 1j * spin[body] * arm)).real
    for body, anchor, law, over, when, frame, other in given["loads"]:
        if when and (when == "advance") != (advance >= 0.0):
            continue
        components = law_values(law, travel if over == "S" else angle)
        if len(components) == 1:
            rows[body][2] += components[0]
            continue
        arm, force = anchor * direction[body], complex(*components) * direction[frame]
        push(body, arm, force)
        if other < len(centre) - 1:  # what reacts is no ground
            push(other, centre[body] + arm - centre[other], -force)
    for first, first_anchor, second, second_anchor, stiffness, free_length, damping in given["springs"]:
        arm, other = first_anchor * direction[first], second_anchor * direction[second]
        span = centre[first] + arm - centre[second] - other
        rate = velocity[first] + 1j * spin[first] * arm - velocity[second] - 1j * spin[second] * other
        length = abs(span)
        along = span / (length or 1.0)  # ends that meet have no direction to pull in
        tension = stiffness * (length - free_length) + damping * (along.conjugate() * rate).real
        push(first, arm, -tension * along)
        push(second, other, tension * along)
    for (_, _, body, host, anchor, guide), size in zip(given["friction"], rubbing, strict=True):
        if guide is None:
            turn = math.copysign(size, spin[body] - spin[host])
            rows[body][2] -= turn
            rows[host][2] += turn
            continue
        arm, along = anchor * direction[body], guide * direction[host]
        other = centre[body] + arm - centre[host]
        rate = velocity[body] + 1j * spin[body] * arm - velocity[host] - 1j * spin[host] * other
        rub = math.copysign(size, (along.conjugate() * rate).real) * along
        push(body, arm, -rub)
        push(host, other, rub)
    return rows


def build(model: Data) -> MujocoWorld:
    """The world of a model, in its start state; raises ArithmeticError if MuJoCo refuses it."""
    return MujocoWorld(model)


def follow(world: MujocoWorld, course: Data) -> Data:
    """Step through all parts of a course and return its samples; at a border of parts the later part's counts.

    They are times, s, and values by channel, and by joint under "joint_force". Raises ArithmeticError where MuJoCo
    warns or friction grows without end.
    """
    rows: list[tuple[Any, ...]] = []
    warnings: list[str] = []
    mujoco.set_mju_user_warning(warnings.append)  # or they go to the terminal and into a file
    try:
        for part in course["parts"]:
            rows[-1:] = world.states(part, course, warnings)
    finally:
        mujoco.set_mjcb_control(None)
        mujoco.set_mju_user_warning(None)
    return world.samples(rows, course["channels"])
