"""The textbook's first way: accelerations from one system with the multipliers, integrated by fixed Runge-Kutta steps.

Joints are held on acceleration level only (index 1), so positions and velocities drift off them and nothing pulls them
back. This is what the naive setting is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engines.direct_adapter.assembly import UnsolvableError
from engines.direct_adapter.equations import Arms, Equations, Pose, Reals
from engines.direct_adapter.instants import Instants, coordinates, joint_forces, metres
from engines.direct_adapter.loads import applied_loads
from engines.scene import Prescribed


@dataclass(frozen=True)
class State:
    """One instant's coordinates and rates, (1, bodies, 3), in units and rad."""

    position: Reals
    rate: Reals

    def after(self, step: float, slope: State) -> State:
        """The state a step of the given slope later."""
        return State(self.position + step * slope.position, self.rate + step * slope.rate)


@dataclass(frozen=True)
class Balance:
    """Forces and accelerations of one state: (1, bodies, 3) in units and rad, drive torque, N m, multipliers, N."""

    pose: Pose
    arms: Arms
    acceleration: Reals
    torque: Reals
    multipliers: Reals


def step_through(equations: Equations, time: Reals, largest_gap: float) -> list[Instants]:
    """Step from the scene's start state through the evenly spaced times.

    Raises UnsolvableError where the joints are further apart than ``largest_gap`` units of length.
    """
    state = _start(equations)
    drive = _drive(equations, time)
    found = []
    for number, now in enumerate(time):
        balance = _balance(equations, state, drive[2 * number])
        _check_joints(equations, balance, float(now), largest_gap)
        found.append(_instant(equations, state, balance))
        if number + 1 < len(time):
            step = float(time[number + 1] - now)
            state = _runge_kutta(equations, state, balance, step, drive[2 * number + 1 : 2 * number + 3])
    return found


def _start(equations: Equations) -> State:
    bodies = equations.scene.bodies
    rate = np.array([[*((*body.velocity, body.angular_velocity) for body in bodies), (0.0, 0.0, 0.0)]])
    return State(coordinates(equations, equations.start()) / metres(equations), rate / metres(equations))


def _drive(equations: Equations, time: Reals) -> list[float]:
    """What the drive sets at every time and half-way to the next: the crank's acceleration, or the torque on it."""
    drive = equations.scene.drive
    halves = np.linspace(time[0], time[-1], 2 * len(time) - 1)
    if isinstance(drive, Prescribed):
        return [float(value) for value in drive.motion.acceleration(halves)]
    return [drive.torque] * len(halves)


def _runge_kutta(equations: Equations, state: State, first: Balance, step: float, drive: list[float]) -> State:
    def slope(at: State, balance: Balance) -> State:
        return State(at.rate, balance.acceleration)

    def stage(size: float, before: State, driven: float) -> State:
        at = state.after(size, before)
        return slope(at, _balance(equations, at, driven))

    one = slope(state, first)
    two = stage(0.5 * step, one, drive[0])
    three = stage(0.5 * step, two, drive[0])
    four = stage(step, three, drive[1])
    outer = state.after(step / 6.0, one).after(step / 6.0, four)
    return outer.after(step / 3.0, two).after(step / 3.0, three)


def _balance(equations: Equations, state: State, driven: float) -> Balance:
    """Accelerations and multipliers of a state, from one system."""
    angle = state.position[..., 2]
    pose = Pose(state.position[..., :2], angle, np.cos(angle), np.sin(angle))
    arms = equations.arms(pose)
    velocity = state.rate * metres(equations)
    loads = applied_loads(equations.scene, equations, pose, velocity, angle[:, equations.crank])
    bend, jacobian = equations.bend(arms, state.rate)[0], equations.jacobian(arms)[0]
    if isinstance(equations.scene.drive, Prescribed):
        bend[equations.crank_row] = driven
        acceleration, multipliers = _saddle_point(equations, jacobian, loads, bend)
        return Balance(pose, arms, acceleration, multipliers[:, equations.crank_row] * equations.unit, multipliers)
    loads[:, equations.crank, 2] += driven
    joints = slice(0, equations.crank_row)
    acceleration, multipliers = _saddle_point(equations, jacobian[joints], loads, bend[joints])
    return Balance(pose, arms, acceleration, np.array([driven]), multipliers)


def _saddle_point(equations: Equations, jacobian: Reals, loads: Reals, bend: Reals) -> tuple[Reals, Reals]:
    """M q̈ − Gᵀ λ = F with G q̈ = γ, by one dense solve."""
    factors = np.array([1.0, 1.0, equations.unit])
    inertia = equations.gather((equations.mass * metres(equations) / factors)[None])[0]
    rows, size = jacobian.shape
    matrix = np.zeros((size + rows, size + rows))
    matrix[range(size), range(size)] = inertia
    matrix[:size, size:] = -jacobian.T
    matrix[size:, :size] = jacobian
    equations.solves += 1
    try:
        solution = np.linalg.solve(matrix, np.concatenate([equations.gather(loads / factors)[0], bend]))
    except np.linalg.LinAlgError:
        raise UnsolvableError("the system of accelerations and joint forces is singular") from None
    return equations.spread(solution[None, :size]), solution[None, size:]


def _check_joints(equations: Equations, balance: Balance, now: float, largest_gap: float) -> None:
    """Raise UnsolvableError when the joints have come apart or the motion is no number any more."""
    gap = float(np.max(np.abs(equations.residual(balance.pose, balance.arms))))
    if not np.isfinite(gap):
        raise UnsolvableError(f"the motion is no number any more at {now:.4g} s")
    if gap > largest_gap:
        millimetres = gap * equations.unit * 1e3
        raise UnsolvableError(f"the joints have drifted apart by {millimetres:.3g} mm at {now:.4g} s")


def _instant(equations: Equations, state: State, balance: Balance) -> Instants:
    """What is recorded."""
    return Instants(
        coordinates(equations, balance.pose),
        state.rate * metres(equations),
        balance.acceleration * metres(equations),
        balance.torque,
        joint_forces(equations, balance.arms, balance.multipliers),
    )
