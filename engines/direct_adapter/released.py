"""The free crank: the constrained bodies' equation of motion projected on q', over a table of φ, integrated by SciPy.

With q̇ = q' φ̇ and q̈ = q' φ̈ + q'' φ̇² (coordinate partitioning: R. A. Wehage, E. J. Haug, ASME Journal of Mechanical
Design 104, 1982), the projection of M q̈ = F + Gᵀ λ on q' has no joint forces in it and reads

    (q'ᵀ M q') φ̈ = M1 + q'ᵀ F − (q'ᵀ M q'') φ̇²

whose coefficients depend on φ alone. They are solved from the bodies and tabulated. Loads over the crank angle need not
be smooth: only the levers they act on are tabulated, the loads are evaluated.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
from scipy.integrate import DOP853, DenseOutput, OdeSolution
from scipy.interpolate import BSpline, make_interp_spline

from analytic.description.law import FULL_TURN
from engines.contract import Array
from engines.direct_adapter.solution import Equations, Path, UnsolvableError, transfer, velocity_terms
from engines.mechanics.driver import driven
from engines.mechanics.joints import applied_loads
from engines.mechanics.states import body_numbers, point_velocity, start_motion
from engines.scene import Free, Scene

RELATIVE, ABSOLUTE = 2.3e-14, 1e-14  # of φ and φ̇; SciPy takes no smaller one
STEP = 0.5  # of the longest step within that: between its ends DOP853 is known to its seventh order only
DEGREE = 7
COUNTS = (257, 513, 1025, 2049, 4097, 8193)  # places of a table, doubled until it is exact
EXACT = 1e-13  # of a coefficient's terms
BLOCK = 512  # instants solved at once: their matrices stay in a processor's cache


def released_motion(equations: Equations, path: Path, drive: Free) -> OdeSolution:
    """φ and φ̇, rad or units, over time, of a crank let go in its start state.

    Raises UnsolvableError where it cannot be followed.
    """
    scene, driver = equations.scene, equations.driver
    start = [float(value[0]) / driver.scale for value in driven(scene, *start_motion(scene)[:2])]
    rate = _rate_function(equations, path, drive)
    kinks = () if drive.over_time is None else [kink for kink in drive.over_time.times if 0.0 < kink < drive.duration]
    times, pieces, turned = [0.0], [], np.zeros((2, 1))
    for begin, end in pairwise([0.0, *kinks, drive.duration]):
        run = DOP853(rate, begin, start, end, rtol=RELATIVE, atol=ABSOLUTE)
        while run.status == "running":
            if run.step() is not None:
                reason = "the free crank cannot be followed, the linkage locks or all but locks"
                raise UnsolvableError(f"{reason} at {run.t:.4g} s")
            run.max_step = STEP * run.h_abs
            times.append(run.t)
            pieces.append(_shifted(run.dense_output(), turned))
            if path.turns is not None:  # rounded as an angle of many turns is, the state would lose energy
                whole = FULL_TURN * np.floor((run.y - path.low) / FULL_TURN) * (1.0, 0.0)
                run.y, turned = run.y - whole, turned + whole[:, None]
        start = run.y.tolist()
    return OdeSolution(times, pieces)


def _shifted(piece: DenseOutput, offset: Array) -> Callable[[Array], Array]:
    """A piece of the motion with whole periods of φ added."""
    return lambda time: np.asarray(piece(time) + offset)


def _rate_function(equations: Equations, path: Path, drive: Free) -> Callable[[float, Array], tuple[float, float]]:
    """The rate of the state (φ, φ̇), for an integrator; nan outside the path."""
    scene, scale = equations.scene, equations.driver.scale
    table = _coefficient_table(equations, path)
    laws = [load.force for load in scene.forces if not load.force.is_constant]
    laws += [load.torque for load in scene.torques if not load.torque.is_constant]
    low, high, repeats = path.low, path.high, path.turns is not None

    def rate(time: float, state: Array) -> tuple[float, float]:
        angle, speed = state.tolist()
        place = low + (angle - low) % FULL_TURN if repeats else angle
        if not low <= place <= high:
            return np.nan, np.nan
        inertia, bend, at_rest, drag, *levers = table(place).tolist()
        torque = drive.torque + (0.0 if drive.over_time is None else float(drive.over_time(time)))
        loads = [float(part) for law in laws for part in law(angle * scale)]
        moment = torque * scale + at_rest - drag * speed - bend * speed * speed
        return speed, (moment + sum(map(float.__mul__, loads, levers))) / inertia

    return rate


def _coefficient_table(equations: Equations, path: Path) -> BSpline:
    """Coefficients over a path as a spline, at as many places as make it exact.

    Raises UnsolvableError where they are not finite.
    """
    for count in COUNTS:
        places = np.linspace(path.low, path.high, count)
        halves = 0.5 * (places[1:] + places[:-1])
        parts = [_coefficients(equations, path, part) for part in np.array_split(places, -(-count // BLOCK))]
        values, sizes = (np.concatenate(each, axis=1) for each in zip(*parts, strict=True))
        if not np.all(np.isfinite(values)):
            raise UnsolvableError("the equation of motion is not finite everywhere; check masses, inertias and loads")
        table = make_interp_spline(places, values.T, DEGREE)
        looks = halves[:: max(1, count // 256)]
        errors = np.abs(_coefficients(equations, path, looks)[0] - table(looks).T)
        if np.all(errors.max(axis=1) <= EXACT * sizes.max(axis=1)):
            break
    return table


def _coefficients(equations: Equations, path: Path, angle: Array) -> tuple[Array, Array]:
    """Rows (c, n): q'ᵀMq', q'ᵀMq'', q'ᵀF at rest, drag per φ̇, and the levers of loads over φ; and their terms' sizes.

    The sizes take each coordinate's lever for at least one unit of length: what is small beside them is cancellation.
    """
    pose = path.closed_pose(angle)
    arms, metric = equations.arms(pose), pose.scaled(equations.unit)
    matrix = equations.jacobian(arms)
    first = transfer(equations, matrix)
    lever, second = first * equations.metres, velocity_terms(equations, arms, matrix, first) * equations.metres
    steady, varying = _split_loads(equations.scene)
    at_rest, moving = (applied_loads(steady, metric, rate) for rate in (np.zeros_like(lever), lever))
    forces = [equations.mass * lever, equations.mass * second, at_rest, at_rest - moving]
    values = [np.sum(lever * force, axis=(1, 2)) for force in forces]
    sizes = [np.sum((np.abs(lever) + equations.metres) * np.abs(force), axis=(1, 2)) for force in forces]
    numbers, levers = body_numbers(steady), []
    for load in varying.forces:
        body = numbers[load.body]
        levers += list(point_velocity(metric.arm(body, load.anchor), lever[:, body]).T)
    levers += [lever[:, numbers[load.body], 2] for load in varying.torques]
    return np.stack([*values, *levers]), np.stack([*sizes, *(np.abs(each) + equations.unit for each in levers)])


def _split_loads(scene: Scene) -> tuple[Scene, Scene]:
    """The scene without its loads over φ, and the scene with no other loads."""
    steady, varying = (
        replace(
            scene,
            forces=tuple(load for load in scene.forces if load.force.is_constant is constant),
            torques=tuple(load for load in scene.torques if load.torque.is_constant is constant),
        )
        for constant in (True, False)
    )
    return steady, varying
