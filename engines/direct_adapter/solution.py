"""Positions, velocities, accelerations and joint forces at given instants, each instant solved by itself.

Lengths are counted in the scene's own *unit*: ``Equations.unit``, m, a power of two near the scene's size. The driver's
coordinate φ is in rad for a crank, and in these units for a slider or cylinder: "rad or units".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853, OdeSolution

from analytic.description.law import FULL_TURN
from engines.contract import Array, History, Signal
from engines.mechanics.joints import Arms, JointEquations, applied_loads, joint_friction
from engines.mechanics.states import Pose, Reals, pose_of
from engines.scene import Channel
from engines.stepping.intervals import DivergedError

# The joints' equations of a scene, solved for many instants at once: linear systems in G, and Newton's method.


MOST_ITERATIONS = 12  # of Newton's method
SHRINKING = 0.25  # of a correction over the one before it
UNFINISHED = 1e-9  # units and rad: a correction that no longer shrinks is rounding if it is smaller, failure if not
EPS = float(np.finfo(float).eps)


class UnsolvableError(DivergedError):
    """The scene cannot be put together or solved somewhere; the message is the run's reason."""


class Equations(JointEquations):
    """The joints' equations with a count of the linear systems solved, one for every right-hand side of an instant."""

    solves = 0

    @cached_property
    def start_coordinates(self) -> Reals:
        """x, y and angle of all bodies at the start, (1, bodies, 3), units and rad; the ground is the last."""
        return self.start().coordinates()

    def solve(self, matrix: Reals, right: Reals, *, refines: bool = True) -> Reals:
        """Solve ``matrix`` x = ``right``, (n, k, k) and (n, k), by default refined once; adds n to ``solves``.

        Raises UnsolvableError where a matrix is singular.
        """
        self.solves += len(right)
        try:
            first = np.linalg.solve(matrix, right[..., None])
            if not refines:
                return np.asarray(first[..., 0])
            return np.asarray((first + np.linalg.solve(matrix, right[..., None] - matrix @ first))[..., 0])
        except np.linalg.LinAlgError:
            raise UnsolvableError("the constraint equations are singular") from None

    def close_joints(self, pose: Pose, coordinate: Reals) -> Pose:
        """New poses with all joints closed, by Newton's method, from ``pose``, n poses that are near them.

        ``coordinate`` (n,) is φ there, rad or units. Raises UnsolvableError where the method does not settle or a
        matrix is singular.
        """
        before = math.inf
        for _ in range(MOST_ITERATIONS):
            residual, matrix = self.violation(pose, coordinate)
            step = self.solve(matrix, -residual)
            worst = float(np.max(np.abs(step)))
            if not worst <= max(SHRINKING * before, UNFINISHED):
                break
            pose = pose.moved(self.spread(step))
            if worst <= EPS or worst > SHRINKING * before:
                return pose
            before = worst
        raise UnsolvableError("the joints cannot be closed")


# Positions, velocities, accelerations and joint forces at given instants, each instant solved by itself.

MOST_ROUNDS, SETTLED = 400, 1e-15  # of friction; a change of the largest force that is rounding
FORCES = frozenset({Channel.TORQUE, Channel.JOINT_FORCE})
KINETIC = FORCES | {Channel.ACCELERATION}


class Crank(NamedTuple):
    """The driver's motion at n instants, rad or units, and s.

    Its ``acceleration`` is prescribed, or follows from its ``torque``, in N m, or of a linear driver in N times the
    unit.
    """

    angle: Reals
    speed: Reals
    acceleration: Reals | None
    torque: Reals | None = None

    def part(self, instants: slice) -> Crank:
        """A copy with those of the instants that a slice takes."""
        return Crank(*(values if values is None else values[instants] for values in self))  # type: ignore[arg-type]


class Solution(NamedTuple):
    """The results of n instants, SI, by channel: bodies' coordinates (n, bodies, 3), the drive's torque (n,).

    ``joint_force`` is (n, joints, 2). None is what was not asked for.
    """

    position: Reals
    velocity: Reals | None = None
    acceleration: Reals | None = None
    torque: Reals | None = None
    joint_force: Reals | None = None


def solve(equations: Equations, pose: Pose, crank: Crank, channels: frozenset[Channel]) -> Solution:
    """Motion and forces at the instants, SI, computed only as far as the channels need.

    ``pose`` has closed joints, in units; ``crank`` is the driver's motion at the same instants. Raises UnsolvableError
    for singular equations, or friction that grows without end.
    """
    arms, metric = equations.arms(pose), pose.scaled(equations.unit)
    if channels <= {Channel.POSITION}:
        return Solution(metric.coordinates())
    matrix = equations.jacobian(arms)
    lever = transfer(equations, matrix)
    rate = lever * crank.speed[:, None, None]
    velocity = rate * equations.metres
    if not channels & KINETIC:
        return Solution(metric.coordinates(), velocity)
    bend = velocity_terms(equations, arms, matrix, rate)
    loads: Reals = np.zeros(0)
    second = crank.acceleration
    if second is None or channels & FORCES:  # a prescribed crank moves as it does whatever pulls at the links
        loads = applied_loads(equations.scene, metric, velocity)
        if crank.torque is not None:
            push = equations.driver.gradient(arms.driver, len(loads)) / equations.metres
            loads = loads + crank.torque[:, None, None] * push
    if second is None:  # d'Alembert's principle along q'
        along = lever * equations.metres
        power = np.sum(along * (loads - equations.mass * bend * equations.metres), axis=(1, 2))
        second = power / np.sum(along * along * equations.mass, axis=(1, 2))
    acceleration = (bend + lever * second[:, None, None]) * equations.metres
    if not channels & FORCES:
        return Solution(metric.coordinates(), velocity, acceleration)
    way = lever * np.where(np.signbit(crank.speed), -1.0, 1.0)[:, None, None]  # at rest the one that would begin
    multipliers = _joint_multipliers(equations, arms, matrix, way, equations.mass * acceleration - loads)
    scale = equations.driver.scale
    # The row of a free driver takes nothing: rounding, no torque.
    torque = multipliers[:, equations.crank_row] * equations.unit if crank.torque is None else crank.torque
    forces = equations.joint_forces(arms, multipliers) if Channel.JOINT_FORCE in channels else None
    return Solution(metric.coordinates(), velocity, acceleration, torque / scale, forces)


def _joint_multipliers(equations: Equations, arms: Arms, matrix: Reals, rate: Reals, needs: Reals) -> Reals:
    """λ (n, rows), N, of joints that give the bodies what they need, (n, bodies, 3), friction taken in repeatedly.

    ``matrix`` is G; ``needs`` are N and N m; ``rate`` (n, bodies, 3) is the motion that friction is against. Raises
    UnsolvableError where G is singular or friction grows without end: the linkage locks.
    """
    transposed = matrix.swapaxes(1, 2)
    multipliers = equations.solve(transposed, equations.generalised(needs))
    for _ in range(MOST_ROUNDS if equations.scene.friction else 0):
        rubbed = needs - joint_friction(equations, arms, rate, multipliers)
        before, multipliers = multipliers, equations.solve(transposed, equations.generalised(rubbed))
        largest = np.max(np.abs(multipliers))
        if not np.max(np.abs(multipliers - before)) > SETTLED * largest:
            return multipliers
    if equations.scene.friction:
        raise UnsolvableError("the friction of the joints grows without end, as in a linkage that locks itself")
    return multipliers


def transfer(equations: Equations, matrix: Reals) -> Reals:
    """The derivatives q' = dq/dφ of all coordinates, (n, bodies, 3), in units and rad; ``matrix`` is G.

    Raises UnsolvableError where that is singular.
    """
    return equations.spread(equations.solve(matrix, equations.crank_unit(len(matrix))))


def velocity_terms(equations: Equations, arms: Arms, matrix: Reals, rate: Reals) -> Reals:
    """The accelerations q'' φ̇² that the bodies' rates alone cause, (n, bodies, 3), in units/s² and rad/s².

    ``matrix`` is G, ``rate`` (n, bodies, 3) in units and rad per s; for q', the rate over φ, the result is q'' itself.
    Raises UnsolvableError where G is singular.
    """
    return equations.spread(equations.solve(matrix, equations.bend(arms, rate)))


def history(time: Array, blocks: Sequence[Solution], joints: Iterable[str], channels: frozenset[Channel]) -> History:
    """The requested channels as signals over ``time``, s, SI, from consecutive blocks of instants.

    ``joints`` are the joints' names in the order of the forces. The ground is left out of the bodies.
    """
    whole = {channel: np.concatenate([getattr(block, channel.value) for block in blocks]) for channel in channels}
    forces = whole.pop(Channel.JOINT_FORCE).swapaxes(0, 1) if Channel.JOINT_FORCE in channels else ()
    # The ground, the last body, is left out.
    signals = {c.value: Signal(time, values[:, :-1] if values.ndim == 3 else values) for c, values in whole.items()}
    return History(
        **signals, joint_force={name: Signal(time, force) for name, force in zip(joints, forces, strict=False)}
    )


# The smooth motion of the start state over the driver's coordinate φ.
#
# The velocity q' of the joints' equations, G q' = e, is integrated over φ by SciPy. What the integration is off by
# stays small, as the joints' own violation pulls it back (J. Baumgarte, Computer Methods in Applied Mechanics and
# Engineering 1, 1972), and Newton's method removes it from every pose that is used.


RELATIVE, ABSOLUTE = 1e-6, 1e-6  # of the integration, units and rad: near enough for Newton's method
PULL = 4.0  # 1/rad, at which a violation of the joints fades
LONGEST = FULL_TURN / 16.0  # rad or units, between two poses of which one could be in another assembly mode
EVALUATIONS = 5000  # a turn; an integration that needs more has come to a stop, where steps shrink without end
FINEST, PARTS = 1e-4, 33  # rad or units, to which a place that is not passed is found; of a step that is looked into
LOOKED_BACK = 16  # steps, after which they are looked at for a crossing
RETURNED = 1e-5  # units and rad between the two ends of a full turn


@dataclass(frozen=True)
class Path:
    """Poses from ``low`` to ``high``, rad or units, both at most as far as the linkage can move.

    ``gain`` gives, for φ (n,), the free coordinates' change since the start, (n, k). ``turns`` (bodies,) is each body's
    turn in rad over a full turn of the crank, after which all repeats; None where the path has two ends.
    """

    equations: Equations
    low: float
    high: float
    gain: Callable[[Reals], Reals]
    turns: Reals | None

    def closed_pose(self, coordinate: Reals) -> Pose:
        """The poses at φ (n,), rad or units, the driver exactly there; raises UnsolvableError where they do not close.

        Of a path that repeats φ may be any.
        """
        number = np.zeros(len(coordinate))
        if self.turns is not None:
            number = np.floor((coordinate - self.low) / FULL_TURN)
        pose = _pose(self.equations, self.gain(coordinate - FULL_TURN * number), coordinate)
        pose = self.equations.close_joints(pose, coordinate)
        if self.turns is None:
            return pose
        angle = pose.angle + number[:, None] * self.turns
        angle[:, self.equations.driver.crank] = coordinate
        return Pose(pose.place, angle, pose.cosine, pose.sine)


def reach(equations: Equations, low: float, high: float) -> Path:
    """The path that holds φ from ``low`` up to ``high``, or as much of it as can be reached from the start state.

    Both are in rad or units, and the start's φ lies between them. Where more than a turn of a crank is asked for and
    all repeats after one, the path is the turn from the start on.
    """
    at_start = equations.start()
    start = float(equations.driver.value(at_start)[0])
    if equations.driver.turns and high - low > FULL_TURN:
        end, above = _follow_path(equations, start, start + FULL_TURN)
        gained = equations.spread(above(np.array([end])))[0]
        turns = FULL_TURN * np.round(gained[:, 2] / FULL_TURN)
        gained[:, 2] -= turns
        if end == start + FULL_TURN and np.max(np.abs(gained)) <= RETURNED:
            return Path(equations, start, end, above, turns)
    bottom, below = _follow_path(equations, start, low)
    top, above = _follow_path(equations, start, high)

    def gain(coordinate: Reals) -> Reals:
        """The coordinates' gain (n, k) at φ (n,): of the path below the start, or above it."""
        return np.where(coordinate[:, None] < start, below(coordinate), above(coordinate))

    return Path(equations, bottom, top, gain, None)


def _follow_path(equations: Equations, start: float, end: float) -> tuple[float, Callable[[Reals], Reals]]:
    """φ up to which the path can be followed from ``start`` towards ``end``, in its assembly mode, and the gain.

    φ is in rad or units. The gain is a function of φ (n,): the change (n, k) of the k free coordinates since the start.
    """
    unit, pull = equations.crank_unit(1), PULL if end > start else -PULL
    most = equations.solves + EVALUATIONS * (1.0 + abs(end - start) / FULL_TURN)

    def rate(coordinate: float, state: Reals) -> Reals:
        """Derivatives (k,) over φ of the gain ``state`` (k,), drawn back onto the joints; NaN where G is singular.

        NaN, too, after the most solutions allowed.
        """
        if equations.solves > most:
            return np.full_like(state, np.nan)
        place = np.array([coordinate])
        residual, matrix = equations.violation(_pose(equations, state[None], place), place)
        try:
            return np.asarray(equations.solve(matrix, unit - pull * residual, refines=False)[0])
        except UnsolvableError:
            return np.full_like(state, np.nan)  # a step that is too long

    if end == start:
        return start, lambda coordinate: np.zeros((len(coordinate), equations.size))
    solver = DOP853(rate, start, np.zeros(equations.size), end, max_step=LONGEST, rtol=RELATIVE, atol=ABSOLUTE)
    places, steps, last = [start], [], end
    while solver.status == "running":
        solver.step()
        if solver.status != "failed":
            places.append(float(solver.t))
            steps.append(solver.dense_output())
        if solver.status != "running" or len(steps) % LOOKED_BACK == 0:  # beyond a crossing the steps would not end
            gain = OdeSolution(places, steps)
            last = _last_before_crossing(equations, gain, np.array(places[-LOOKED_BACK - 1 :]))
            if last != places[-1]:
                break
    return last, lambda coordinate: np.asarray(gain(coordinate).T)


def _last_before_crossing(equations: Equations, gain: OdeSolution, places: Reals) -> float:
    """φ up to which a path over some places (n,) crosses no other one, within FINEST; the last place if none.

    All are in rad or units. ``gain`` gives the free coordinates' change since the start there, (k, n).
    """
    while np.any(crossing := _crossings(equations, _pose(equations, gain(places).T, places))):
        first = int(np.argmax(crossing))
        if abs(places[first + 1] - places[first]) < FINEST:
            return float(places[first])
        places = np.linspace(places[first], places[first + 1], PARTS)
    return float(places[-1])


def _crossings(equations: Equations, pose: Pose) -> NDArray[np.bool_]:
    """Where the path crosses another one between neighbouring poses (n,): a truth value per step, (n - 1,).

    Between two matrices on a line there is a singular one where one over the other has a negative eigenvalue: several
    groups that cross at once leave the determinant its sign. What is repeated need not come out real.
    """
    matrices = equations.jacobian(equations.arms(pose))
    return np.asarray(np.any(np.linalg.eigvals(np.linalg.solve(matrices[:-1], matrices[1:])).real < 0.0, axis=1))


def _pose(equations: Equations, gain: Reals, coordinate: Reals) -> Pose:
    """The poses for gains (n, k) of the free coordinates since the start, the driver exactly at φ (n,)."""
    coordinates = equations.start_coordinates + equations.spread(gain)
    if equations.driver.turns:
        coordinates[..., equations.driver.crank, 2] = coordinate
    return pose_of(coordinates)
