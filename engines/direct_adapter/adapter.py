"""The suite's own second derivation as an engine: constrained bodies, every instant solved exactly, by NumPy and SciPy.

It shares no formula with the closed form: no Assur groups, no angles from triangles, no transfer functions in closed
form; only joints as equations between bodies (``engines.mechanics.joints``). So where the two agree to
rounding, both are right. A prescribed motion needs no time steps: positions, velocities, accelerations and forces of an
instant depend on nothing but that instant. A free crank follows the bodies' own equation of motion
(``engines.direct_adapter.adapter``).

Lengths are counted in the scene's own *unit*: ``Equations.unit``, m, a power of two near the scene's size. The driver's
coordinate φ is in rad for a crank, and in these units for a slider or cylinder: "rad or units".
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from scipy.integrate import DOP853, DenseOutput, OdeSolution
from scipy.interpolate import BSpline, make_interp_spline

from analytic.description.law import FULL_TURN
from analytic.description.linkage import DriverKind
from analytic.errors import UnknownNameError
from engines.contract import Abilities, Array, History, Method, ReadOut, Run, Setting
from engines.direct_adapter.solution import (
    Crank,
    Equations,
    Path,
    UnsolvableError,
    history,
    reach,
    solve,
    transfer,
    velocity_terms,
)
from engines.mechanics.joints import applied_loads, force_levers, output_travel
from engines.mechanics.start_check import data_obstacle
from engines.mechanics.states import body_numbers, driven, start_coordinate, start_motion
from engines.registry import installed_version
from engines.scene import GUIDES, LOADS, Channel, Free, Prescribed, Scene, TurnSpring
from engines.stepping.intervals import Cost, DivergedError, UnsupportedError, check_step, run_stepping

# The free crank: the constrained bodies' equation of motion projected on q', over a table of φ, integrated by SciPy.
#
# With q̇ = q' φ̇ and q̈ = q' φ̈ + q'' φ̇² (coordinate partitioning: R. A. Wehage, E. J. Haug, ASME Journal of Mechanical
# Design 104, 1982), the projection of M q̈ = F + Gᵀ λ on q' has no joint forces in it and reads
#
#     (q'ᵀ M q') φ̈ = M1 + q'ᵀ F − (q'ᵀ M q'') φ̇²
#
# whose coefficients depend on φ alone. They are solved from the bodies and tabulated. Loads over the crank angle need
# not be smooth: only the levers they act on are tabulated, the loads are evaluated.


RELATIVE, ABSOLUTE = 2.3e-14, 1e-14  # of φ and φ̇; SciPy takes no smaller one
STEP = 0.5  # of the longest step within that: between its ends DOP853 is known to its seventh order only
DEGREE = 7
COUNTS = (257, 513, 1025, 2049, 4097, 8193)  # places of a table, doubled until it is exact
EXACT = 1e-13  # of a coefficient's terms
BLOCK = 512  # instants solved at once: their matrices stay in a processor's cache


def released_motion(equations: Equations, path: Path, drive: Free) -> OdeSolution:
    """φ and φ̇, rad or units and per s, of a driver let go in its start state, as a function of time, s.

    Its values are (2,) or, at times (n,), (2, n). ``path`` is that of all poses it may take. Raises UnsolvableError
    where the linkage locks or leaves the path, or its equation of motion is not finite.
    """
    scene, driver = equations.scene, equations.driver
    start = [float(value[0]) / driver.scale for value in driven(scene, *start_motion(scene)[:2])]
    rate = _rate_function(equations, path, drive)
    periods = [load.force.period for load in scene.forces] + [load.torque.period for load in scene.torques]
    cycle = max((period for period in periods if period), default=FULL_TURN)
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
                whole = cycle * np.floor((run.y - path.low) / cycle) * (1.0, 0.0)
                run.y, turned = run.y - whole, turned + whole[:, None]
        start = run.y.tolist()
    return OdeSolution(times, pieces)


def _shifted(piece: DenseOutput, offset: Array) -> Callable[[Array], Array]:
    """A function of time, s, that gives a piece of the motion with ``offset`` (2, 1), whole periods of φ, added."""
    return lambda time: np.asarray(piece(time) + offset)


def _rate_function(equations: Equations, path: Path, drive: Free) -> Callable[[float, Array], tuple[float, float]]:
    """The rate (φ̇, φ̈) of the state (φ, φ̇) as a function of time, s, and state, for an integrator; NaN off the path.

    φ is in rad or units. Raises UnsolvableError where the equation of motion is not finite or joints cannot be closed.
    """
    scene, scale = equations.scene, equations.driver.scale
    table = _coefficient_table(equations, path)
    starts = np.unique(table.t)[:-1]
    series = [table(starts, power) / math.factorial(power) for power in reversed(range(DEGREE + 1))]
    edges, pieces = starts.tolist(), np.stack(series, axis=-1).tolist()
    laws = [load.force for load in scene.forces if not load.force.is_constant]
    laws += [load.torque for load in scene.torques if not load.torque.is_constant]
    low, high, repeats = path.low, path.high, path.turns is not None

    def rate(time: float, state: Array) -> tuple[float, float]:
        """φ̇ and φ̈ at a time, s, in a state (φ, φ̇); NaN outside the path."""
        angle, speed = state.tolist()
        place = low + (angle - low) % FULL_TURN if repeats else angle
        if not low <= place <= high:
            return np.nan, np.nan
        piece = bisect_right(edges, place) - 1
        inertia, bend, at_rest, drag, *levers = _polynomial_values(pieces[piece], place - edges[piece])
        torque = drive.torque + (0.0 if drive.over_time is None else float(drive.over_time(time)))
        loads = [float(part) for law in laws for part in law(levers[-1] if law.over == "S" else angle * scale)]
        moment = torque * scale + at_rest - drag * speed - bend * speed * speed
        return speed, (moment + sum(map(float.__mul__, loads, levers))) / inertia

    return rate


def _polynomial_values(polynomials: Sequence[Sequence[float]], x: float) -> list[float]:
    """Values of polynomials, each its coefficients, highest power first, at a number; SciPy takes ten times as long."""
    values = []
    for coefficients in polynomials:
        value = 0.0
        for coefficient in coefficients:
            value = value * x + coefficient
        values.append(value)
    return values


def _coefficient_table(equations: Equations, path: Path) -> BSpline:
    """The c coefficients of ``_coefficients`` over φ, rad or units, of a path, as a spline with values (n, c).

    It has as many places as make it exact, or the last of COUNTS. Raises UnsolvableError where they are not finite or
    joints cannot be closed.
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
    """Rows (c, n): q'ᵀMq', q'ᵀMq'', q'ᵀF at rest, drag per φ̇, levers of varying loads; and their terms' sizes, (c, n).

    ``angle`` (n,) is φ, rad or units; all else is SI, over φ. F has the constant loads; a varying force has a lever
    for each component, a torque one. S itself, m, is last where loads depend on it. The sizes take each coordinate's
    lever for at least one unit of length: what is small beside them is cancellation. Raises UnsolvableError where
    joints cannot be closed.
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
        levers += [np.sum(lever * part, axis=(1, 2)) for part in force_levers(steady, load, metric)]
    levers += [lever[:, numbers[load.body], 2] for load in varying.torques]
    if steady.travel is not None:
        levers.append(output_travel(steady, metric, lever)[0])
    return np.stack([*values, *levers]), np.stack([*sizes, *(np.abs(each) + equations.unit for each in levers)])


def _split_loads(scene: Scene) -> tuple[Scene, Scene]:
    """Copies of the scene with only those forces and torques that are constant, and with only those that are not."""
    steady, varying = (
        replace(
            scene,
            forces=tuple(load for load in scene.forces if load.force.is_constant is constant),
            torques=tuple(load for load in scene.torques if load.torque.is_constant is constant),
        )
        for constant in (True, False)
    )
    return steady, varying


# The engine.


# The motion of a scene under its drive: sampled instants, each solved by itself.


LEAST_SAMPLES = 1400
SAMPLES_PER_TURN = 120
FREE_SPACING = 1e-3  # s
LARGEST_TRAVEL = 16.0  # units that a free linear driver is followed from its start
STOP_MARGIN = 1e-3  # rad or units before a position that the path cannot pass
LEAST_STEPS = 8  # fewer intervals cannot be read between


def _sample_times(duration: float, spacing: float | None, turns: float, least: int = LEAST_SAMPLES) -> Array:
    """Instants (n,), s, evenly from 0 to ``duration``, at most ``spacing``, s, apart, in LEAST_STEPS intervals or more.

    For None they are SAMPLES_PER_TURN over each of the driver's ``turns``, in ``least`` intervals or more.
    """
    samples = max(least, round(SAMPLES_PER_TURN * turns))
    if spacing is not None:
        samples = max(LEAST_STEPS, math.ceil(duration / spacing - 1e-6))
    return np.linspace(0.0, duration, samples + 1)


def _prescribed_motion(equations: Equations, drive: Prescribed, spacing: float | None) -> tuple[History, int]:
    """History, SI, of a driver with a prescribed motion, and the number of its instants.

    They are at most ``spacing``, s, apart, or as chosen for None. Raises UnsolvableError where the joints cannot be
    closed or the friction grows without end.
    """
    crank, scale = drive.motion, equations.driver.scale
    time = _sample_times(crank.duration, spacing, crank.duration * crank.peak_speed / FULL_TURN)
    angle = crank.angle(time) / scale
    path = reach(equations, float(np.min(angle)), float(np.max(angle)))
    _check_reach(path, time, angle)
    return _solved_samples(path, time, Crank(angle, crank.speed(time) / scale, crank.acceleration(time) / scale)), len(
        time
    )


def _check_reach(path: Path, time: Array, angle: Array) -> None:
    """Raise UnsolvableError, with the instant and the end, if the path does not hold every φ (n,), rad or units.

    ``time`` (n,), s, are their instants. A path that repeats holds all.
    """
    outside = (angle < path.low) | (angle > path.high)
    if path.turns is None and np.any(outside):
        first = int(np.argmax(outside))
        end = path.low if angle[first] < path.low else path.high
        driver = path.equations.driver
        where = f"crank angle of {math.degrees(end):.4g}°"
        if not driver.turns:
            where = f"length of {end * driver.scale:.4g} m of its {driver.kind}"
        raise UnsolvableError(
            f"the joints cannot be closed at {time[first]:.4g} s: the linkage locks, or passes a change point, at a "
            f"{where}"
        )


def _solved_samples(path: Path, time: Array, crank: Crank) -> History:
    """The history, SI, at instants (n,), s, each solved by itself, in blocks that bound the memory.

    ``crank`` is the driver's motion there. Raises UnsolvableError where the joints cannot be closed or the friction
    grows without end.
    """
    equations, channels = path.equations, path.equations.scene.channels
    blocks = []
    for start in range(0, len(time), BLOCK):
        part = crank.part(slice(start, start + BLOCK))
        blocks.append(solve(equations, path.closed_pose(part.angle), part, channels))
    return history(time, blocks, equations.joints, channels)


def _free_motion(equations: Equations, drive: Free, spacing: float | None) -> tuple[History, int]:
    """History, SI, of a free driver, and the number of time steps of its integration.

    Samples are at most ``spacing``, s, apart, or as chosen for None. Raises UnsolvableError where the driver cannot be
    followed, a crank's linkage is in another pose after a turn, or friction grows without end.
    """
    scale = equations.driver.scale
    start, far = start_coordinate(equations.scene) / scale, FULL_TURN if equations.driver.turns else LARGEST_TRAVEL
    low, high = start - far, start + far
    path = reach(equations, low, high)
    if path.turns is None:
        if equations.driver.turns and path.high - path.low > FULL_TURN:
            raise UnsolvableError("the linkage is in another pose after a turn of its crank")
        path = replace(
            path, low=path.low + STOP_MARGIN * (path.low > low), high=path.high - STOP_MARGIN * (path.high < high)
        )
    free = released_motion(equations, path, drive)
    turns = drive.duration * float(np.max(np.abs(free(free.ts)[1]))) / FULL_TURN  # or spans as long
    time = _sample_times(drive.duration, spacing, turns, max(LEAST_SAMPLES, round(drive.duration / FREE_SPACING)))
    angle, speed = free(time)
    return _solved_samples(path, time, Crank(angle, speed, None, drive.torque_at(time) * scale)), free.n_segments


DISTRIBUTION = "linkproof"
METHODS = (Method("exact", "every instant by Newton's method and linear systems; a free crank by DOP853"),)
SINGULAR = 1e-9  # smallest over largest singular value of the constraint equations


class DirectEngine:
    """Constrained planar bodies in descriptor form."""

    name = "direct"
    is_control = True
    abilities = Abilities(
        readouts={
            Channel.POSITION: ReadOut("the joints' equations, closed by Newton's method"),
            Channel.VELOCITY: ReadOut("their first derivative over the crank angle, times its speed"),
            Channel.ACCELERATION: ReadOut("their second derivative"),
            Channel.TORQUE: ReadOut("multiplier of the crank's equation", drive="drive only"),
            Channel.JOINT_FORCE: ReadOut("multipliers of the joint's equations", drive="without drive"),
        },
        drives=frozenset({Prescribed, Free}),
        timed_torque=True,
        joints=GUIDES,
        loads=LOADS | {TurnSpring},
        load_states=True,
        friction=True,
        drivers=frozenset(DriverKind),
    )

    def version(self) -> str:
        """The version of the installed linkproof; "source" for a checkout that is not installed."""
        return installed_version(DISTRIBUTION) or "source"  # run from a checkout: nothing else is needed

    def run(self, scene: Scene, setting: Setting) -> Run:
        """Solve the scene, whatever the setting: there is nothing to tune.

        A scene that is unsupported, or cannot be solved somewhere, is an outcome.
        """
        return _run(scene, None, Cost())  # a control has no defaults to be naive with, and nothing left to extrapolate

    def methods(self, scene: Scene) -> tuple[Method, ...]:
        """The one method there is, for any scene."""
        return METHODS

    def run_method(self, scene: Scene, method: Method, step: float) -> Run:
        """Solve the scene with samples at most ``step`` seconds apart; what prevents it is an outcome, as for ``run``.

        Raises UnknownNameError for another method, LinkproofError for a step that is not positive and finite.
        """
        check_step(step)
        if method.name != METHODS[0].name:
            raise UnknownNameError("method", method.name, [METHODS[0].name])
        return _run(scene, step, Cost(details={"method": method.name}))


def _run(scene: Scene, spacing: float | None, cost: Cost) -> Run:
    """The run of a scene; an UnsupportedError or a DivergedError becomes its outcome and reason.

    Samples are at most ``spacing``, s, apart, or as the adapter chooses for None.
    """
    return run_stepping(cost, lambda: _solved_history(scene, spacing, cost))


def _solved_history(scene: Scene, spacing: float | None, cost: Cost) -> History:
    """Build the equations and solve the motion, in SI; samples at most ``spacing``, s, apart, or as chosen for None.

    Times and steps go into ``cost``. Raises UnsupportedError or DivergedError with the reason.
    """
    turns = scene.driver_kind is DriverKind.CRANK
    if turns and any(body.name == scene.crank and body.inertia is None for body in scene.bodies):
        raise UnsupportedError(f"crank '{scene.crank}' has no inertia, so it cannot turn; give it one")
    with cost.timing("setup_seconds"):
        reason = data_obstacle(scene, massless=True)
        if reason is not None:
            raise DivergedError(reason)
        equations = _checked_equations(scene)
    with cost.timing("seconds"), np.errstate(all="ignore"):  # numbers that are not finite are named later
        history, cost.steps = (
            _prescribed_motion(equations, scene.drive, spacing)
            if isinstance(scene.drive, Prescribed)
            else _free_motion(equations, scene.drive, spacing)
        )
    return history


def _checked_equations(scene: Scene) -> Equations:
    """The scene's equations; raises UnsupportedError where by count, or at the start, they do not fix its motion."""
    equations = Equations(scene)
    given, expected = equations.rows - 1, equations.size - 1
    if given != expected:
        surplus = "some are redundant" if given > expected else "more than the crank can move"
        raise UnsupportedError(f"the joints give {given} equations where {expected} leave one freedom: {surplus}")
    reason = _degeneracy(equations)
    if reason is not None:
        raise UnsupportedError(reason)
    return equations


def _degeneracy(equations: Equations) -> str | None:
    """The reason, as a sentence, why the equations do not fix the motion at the start; None where they do."""
    matrix = equations.jacobian(equations.arms(equations.start()))[0]
    if not np.all(np.isfinite(matrix)):
        return "the start state is not finite"
    for rows, meaning in (
        (slice(0, equations.crank_row), "the joints are redundant, or at a change point, in the start state"),
        (slice(0, None), "the crank cannot move the linkage from its start state: it is at a dead point"),
    ):
        sizes = np.linalg.svd(matrix[rows], compute_uv=False)
        if not sizes[-1] > SINGULAR * sizes[0]:
            return f"{meaning} (singular values {sizes[-1]:.2g} to {sizes[0]:.2g})"
    return None
