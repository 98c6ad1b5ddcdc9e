"""Reduced dynamics: the linkage as a variable inertia and a torque at the crank (articles 000, 001 and 003).

The units are those of a turning crank; a driver that is pushed has its own (``analytic.signals.unit_of``).

Article 003, eqs (1)-(5) define Jeq; article 000 the equation of motion Jeq φ̈ + ½ Jeq' φ̇² + b φ̇ = Q + M1. Primes
are d/dφ, exact.

Functions of a sweep raise AssemblyError where the linkage cannot be assembled or moved, unless it collects ``faults``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any, Final, NamedTuple, TypedDict

import numpy as np
from numpy.typing import ArrayLike

from analytic.description.crank_motion import degrees
from analytic.description.law import FULL_TURN, Law, TimeLaw
from analytic.description.linkage import Link, LinkTorque, PointForce
from analytic.dynamics.friction import contacts
from analytic.dynamics.loads import Elastic, Load, applied_loads, drags, elastic_loads, stored_energy
from analytic.errors import AssemblyError, LinkproofError
from analytic.kinematics import frames
from analytic.kinematics.dead_centres import dead_centres, top_of_turn
from analytic.kinematics.frames import Pair, Scalar, is_zero
from analytic.kinematics.mechanism import Mechanism, once_per_mechanism
from analytic.kinematics.structure import Prismatic
from analytic.kinematics.sweep import Sweep
from analytic.numerics.arrays import Array, Booleans, distinct
from analytic.numerics.periodic_table import DEGREE, PeriodicTable, tabulate
from analytic.numerics.refine import extremes, grid, in_turn, zeros
from analytic.numerics.roots import root


def link_inertia(sweep: Sweep, link: str) -> Array:
    """One link's moment of inertia reduced to the crank, m |S'|² + J θ'², kg m², in the shape of the sweep's angles.

    ``link`` is its name; the array is read-only. Raises KeyError for an unknown link.
    """
    return np.broadcast_to(np.asarray(_link_inertia(sweep, link), dtype=float), sweep.angle.shape)


def _link_inertia(sweep: Sweep, link: str) -> Scalar:
    """A link's reduced inertia, kg m², a plain number where it is constant; of a pushed slider its mass, kg."""
    body = sweep.linkage.links[link]
    pivot = sweep.structure.pivot
    if pivot is not None and link == pivot.far:  # slides on the ground or turns about a fixed point: a constant
        if isinstance(pivot, Prismatic):
            return body.mass
        x, y = frames.minus(body.centre, pivot.far_local)
        return body.mass * (x * x + y * y) + _own_inertia(body)
    return _weighted_products(sweep, link, 1)


def _weighted_products(sweep: Sweep, link: str, order: int) -> Scalar:
    """A link's part of ½ Jeq', m S'·S'' + J θ' θ'', kg m²/rad, with ``order`` 2, and of Jeq, kg m², with 1.

    Zero factors are left out.
    """
    body = sweep.linkage.links[link]
    inertia = _own_inertia(body)
    moved = 0.0 if is_zero(body.mass) else body.mass * frames.dot(sweep.centre(link, 1), sweep.centre(link, order))
    if is_zero(inertia):
        return moved
    second = (sweep.rates if order == 1 else sweep.accelerations)(link)[2]
    turned = inertia * (sweep.rates(link)[2] * second)
    return turned if is_zero(moved) else moved + turned


def _own_inertia(body: Link) -> Scalar:
    """A link's moment of inertia about its mass centre, kg m²; 0 for a link without one."""
    return 0.0 if body.inertia is None else body.inertia


def reduced_inertia(sweep: Sweep, links: Iterable[str] | None = None) -> Array:
    """Jeq, kg m², in the shape of the sweep's angles: the sum over all links, or over those named."""
    names = list(sweep.linkage.links) if links is None else list(links)
    total = np.zeros(sweep.angle.shape)
    for name in names:
        total += _link_inertia(sweep, name)
    return total


def group_inertia(sweep: Sweep) -> dict[str, Array]:
    """Jeq, kg m², of the driven link, "crank (class I)", and of every Assur group by its name, in order of solving.

    Each is of the shape of the sweep's angles. Where a cylinder drives there are groups alone.
    """
    linkage = sweep.linkage
    parts = {f"{linkage.crank} (class I)": link_inertia(sweep, linkage.crank)} if linkage.crank else {}
    for group in sweep.structure.groups:
        parts[group.name] = reduced_inertia(sweep, [name for name in group.links if name in linkage.links])
    return parts


def half_inertia_derivative(sweep: Sweep) -> Array:
    """½ Jeq' = Σ m S'·S'' + J θ' θ'', kg m²/rad: the dot product, not the product of the moduli."""
    total = np.zeros(sweep.angle.shape)
    for name in sweep.linkage.links:
        if name != sweep.linkage.crank:  # its part of Jeq is a constant
            total += _weighted_products(sweep, name, 2)
    return total


def gravity_force(sweep: Sweep) -> Array:
    """Generalised force of gravity, Σ m g·S', N m; exactly zero without a gravity vector."""
    gravity = sweep.linkage.gravity
    total = np.zeros(sweep.angle.shape)
    if frames.is_origin(gravity):
        return total
    for name, body in sweep.linkage.links.items():
        if not is_zero(body.mass):
            total += body.mass * _product_with_constant(gravity, sweep.centre(name, 1))
    return total


def _product_with_constant(constant: Pair, vector: Pair) -> Scalar:
    """Scalar product with a constant vector, without work for its zero components."""
    x, y = constant
    return y * vector[1] if is_zero(x) else x * vector[0] + y * vector[1]


def load_forces(sweep: Sweep, speed: ArrayLike = 0.0) -> Iterator[tuple[PointForce | LinkTorque | Elastic, Array]]:
    """Yield each force, torque and spring with its generalised force over φ, N m; dashpots and dampers are left out.

    Loads of one direction act by the sign of ``speed``, at rest as if φ grew.
    """
    for load in sweep.linkage.applied:
        yield load, power(sweep, applied_loads(sweep, load, speed))
    for spring, both in elastic_loads(sweep):
        yield spring, power(sweep, both)


def power(sweep: Sweep, loads: Iterable[Load]) -> Any:  # noqa: ANN401 - plain or traced
    """The power at unit speed of the driver of one load or more together.

    It is in N m of a crank, in N of a driver that is pushed. Raises ValueError without a load.
    """
    first, *rest = (load.power(sweep) for load in loads)
    return sum(rest, first)


def generalised_force(sweep: Sweep, speed: ArrayLike = 0.0) -> Array:
    """The generalised force Q over φ, N m, of gravity and all loads; one-way loads act by the sign of ``speed``."""
    total: Array = gravity_force(sweep)
    for _, part in load_forces(sweep, speed):
        total += part
    return total


def damping_coefficient(sweep: Sweep) -> Array:
    """Damping b reduced to the crank, N m s: the drag torque is b φ̇; constant if the only damper sits on the crank."""
    total = np.zeros(sweep.angle.shape)
    for both in drags(sweep):
        total -= power(sweep, both)
    return total


def kinetic_energy(sweep: Sweep, speed: ArrayLike) -> Array:
    """Teq = ½ Jeq ω², J, at the crank's ``speed``, rad/s, of the sweep's shape or scalar."""
    return np.asarray(0.5 * reduced_inertia(sweep) * np.square(speed))


def potential_energy(sweep: Sweep) -> Array:
    """Energy of gravity, counted from the ground frame's origin, and of the springs, from their free state, J."""
    linkage = sweep.linkage
    total = np.zeros(sweep.angle.shape)
    if linkage.gravity != (0.0, 0.0):
        for name, body in linkage.links.items():
            if body.mass:
                total -= body.mass * _product_with_constant(linkage.gravity, sweep.centre(name))
    return np.asarray(total + stored_energy(sweep))


def drive_torque(sweep: Sweep, speed: ArrayLike, acceleration: ArrayLike) -> Array:
    """Mkr = Jeq ε + ½ Jeq' ω² + b ω − Q, N m: the torque of the drive, without the friction of joints.

    ``speed`` (rad/s) and ``acceleration`` (rad/s²) of the crank, signed, of the sweep's shape or scalar.
    """
    speed, acceleration = np.asarray(speed, dtype=float), np.asarray(acceleration, dtype=float)
    inertia = reduced_inertia(sweep) if np.any(acceleration) else np.zeros(sweep.angle.shape)
    return balance(sweep, inertia, speed, acceleration)


def balance(sweep: Sweep, inertia: Array, speed: Array, acceleration: Array) -> Array:
    """Mkr as from ``drive_torque``, N m, for a given Jeq, kg m², speed, rad/s, and acceleration, rad/s².

    These are of the sweep's shape or scalar; at rest no second derivative is computed.
    """
    turns = bool(np.any(speed))
    torque = inertia * acceleration
    if turns:
        torque += half_inertia_derivative(sweep) * (speed * speed)
    torque -= generalised_force(sweep, speed)
    for both in drags(sweep) if turns else ():
        torque -= power(sweep, both) * speed
    return torque


# The equation of motion of a linkage, solved for the crank's acceleration.
#
# Article 000, eqs (22) and (32): k1 φ̈ + k2 φ̇² + b φ̇ = Q1, here Jeq φ̈ + ½ Jeq' φ̇² + b φ̇ = Q + M1. The article
# builds k2 from the moduli |S'|·|S''| (eqs (29) and (30)) where Lagrange's equation has the scalar product S'·S''; that
# is not the derivative of Jeq, and engines refute it.


NO_INERTIA: Final = 1e-12  # of the peak of Jeq: a smooth minimum this deep is a zero to rounding


class TimeDependence(TypedDict, total=False):
    """Arguments of ``analytic.numerics.integration.integrate``."""

    push: Callable[[Array, Array], Array]
    knots: Sequence[float]


@dataclass(frozen=True)
class EquationOfMotion:
    """φ̈ as a function of φ and φ̇; ``torque`` is M1 on the crank, N m, beside the linkage's own loads.

    A torque ``over_time`` acts besides, so that φ̈ depends on time too: ``push`` is its part of φ̈. With a ``table``
    the terms are read from it; without one AssemblyError is raised where the linkage cannot be assembled or moved.
    """

    mechanism: Mechanism
    torque: Law
    table: PeriodicTable | None = None
    over_time: TimeLaw | None = None

    def terms(self, angle: Array) -> Array:
        """(Q + M1)/Jeq, b/Jeq and ½Jeq'/Jeq at crank angles, rad; shape (3, *angle.shape).

        Under a torque over time 1/Jeq is a fourth.
        """
        return self.closed_form(angle) if self.table is None else self.table(angle)

    def closed_form(self, angle: Array) -> Array:
        """The ``terms`` at crank angles, rad, from the closed form, whether there is a table or not.

        Shape (3 or 4, *angle.shape). Raises AssemblyError where the linkage cannot be assembled or moved.
        """
        return self._terms_of(self.mechanism.sweep(angle))

    def _terms_of(self, sweep: Sweep) -> Array:
        """The ``terms`` at the crank angles of a sweep, computed in closed form."""
        inertia = reduced_inertia(sweep)
        moment = generalised_force(sweep) + self.torque(sweep.angle)[0]
        slope = half_inertia_derivative(sweep)
        timed = [] if self.over_time is None else [np.ones_like(inertia)]
        return np.stack([moment, damping_coefficient(sweep), slope, *timed]) / inertia

    @cached_property
    def peak_moment(self) -> float:
        """Largest |Q + M1|/Jeq, rad/s², over the angles that the crank can reach.

        A torque over time counts with its largest magnitude, added to |Q + M1|.
        """
        seen = self.mechanism.turn.angle
        most = 0.0 if self.over_time is None else max(map(abs, self.over_time.torque))

        def moment(terms: Array) -> Array:
            """The size |Q + M1|/Jeq, rad/s², from ``terms`` (3 or 4, ...), with the torque over time at its largest."""
            return np.asarray(np.abs(terms[0]) + most * np.abs(terms[3]) if most else np.abs(terms[0]))

        if self.table is not None:
            return float(np.max(moment(self.table(seen))))
        return float(
            np.nanmax(self.mechanism.where_assembled(lambda at: moment(self._terms_of(at)), seen), initial=0.0)
        )

    def acceleration(self, angle: ArrayLike, speed: ArrayLike) -> Array:
        """φ̈, rad/s², at crank angles φ, rad, and speeds φ̇, rad/s, of one shape, without ``push``."""
        angle, speed = np.asarray(angle, dtype=float), np.asarray(speed, dtype=float)
        moment, damping, slope = self.terms(angle)[:3]
        return np.asarray(moment - speed * (damping + slope * speed))

    def push(self, time: ArrayLike, angle: ArrayLike) -> Array:
        """The part of φ̈ that the torque over time adds, rad/s², at instants, s, and angles, rad, of one shape."""
        if self.over_time is None:
            return np.zeros(np.shape(time))
        return np.asarray(self.over_time(time) * self.terms(np.asarray(angle, dtype=float))[3])

    @property
    def period(self) -> float:
        """Period of every term in φ, rad; infinite for a driver that is pushed."""
        return math.inf if self.mechanism.linkage.is_linear else self.mechanism.cycle

    @property
    def timing(self) -> TimeDependence:
        """The torque over time as keyword arguments of ``integrate``; {} without such a torque.

        They are ``push``, its part of φ̈, and ``knots``, the times of its kinks, s.
        """
        return {} if self.over_time is None else {"push": self.push, "knots": self.over_time.times}

    def tabulated(self, degree: int = DEGREE) -> EquationOfMotion:
        """A copy that is read from a table over its period, which is faster; itself for a crank without full turns.

        ``degree`` is that of the table's polynomials. A driver that is pushed has no full turns.
        """
        if self.mechanism.linkage.is_linear:
            return self
        try:
            table = tabulate(self.closed_form, degree, period=self.period)
        except AssemblyError:
            return self
        return replace(self, table=table)


def equation_of_motion(
    mechanism: Mechanism, torque: float | Law = 0.0, over_time: TimeLaw | None = None
) -> EquationOfMotion:
    """The equation under a crank torque M1, N m, constant or a law of φ, and a torque ``over_time`` besides.

    Raises LinkproofError where it has no solution: Jeq is 0 somewhere, a joint has friction, a load acts one way, or M1
    is not finite.
    """
    _check_inertia(mechanism)
    if mechanism.linkage.friction:
        raise LinkproofError(
            f"'{mechanism.linkage.name}': expected joints without friction, got some with it, and a released crank "
            "would stick and slip; leave friction out, or give the crank a motion"
        )
    if mechanism.linkage.has_one_way_loads:
        raise LinkproofError(
            f"'{mechanism.linkage.name}': expected loads that depend on the position alone, got one with when = ..., "
            "and a released crank may turn back; leave when out, or give the crank a motion"
        )
    return EquationOfMotion(mechanism, crank_torque(torque), over_time=over_time)


def _check_inertia(mechanism: Mechanism) -> None:
    """Raise LinkproofError where Jeq vanishes at a crank angle, so that no acceleration follows from the loads."""

    def inertia(angle: Array) -> Array:
        """Jeq, kg m², at crank angles, rad, of any shape; NaN where the linkage is not assembled."""
        return mechanism.where_assembled(reduced_inertia, angle.ravel()).reshape(angle.shape)

    linkage = mechanism.linkage
    if linkage.crank and np.any(link_inertia(mechanism.sweep(0.0), linkage.crank)):
        return  # a crank with an inertia about its pivot has it at every angle
    if linkage.is_linear:
        seen = inertia(mechanism.turn.angle)
        if not np.nanmin(seen) > NO_INERTIA * np.nanmax(seen):
            raise LinkproofError(
                f"'{linkage.name}': expected a linkage that resists being moved, got one without mass or inertia "
                "somewhere in its range; give its links mass"
            )
        return
    least = extremes(lambda angle: np.nan_to_num(inertia(angle), nan=np.inf))
    if least.minimum <= NO_INERTIA * np.nanmax(inertia(grid()), initial=0.0):
        raise LinkproofError(
            f"'{mechanism.linkage.name}': expected a linkage that resists being moved, got none at crank angle "
            f"{degrees(least.minimum_angle)}, where its reduced inertia Jeq is 0 and a released crank has no "
            "acceleration; give the crank a mass or an inertia"
        )


def crank_torque(torque: float | Law) -> Law:
    """A crank torque, N m, as a law of φ; a number becomes a constant law. Raises LinkproofError unless finite."""
    law = torque if isinstance(torque, Law) else Law(np.array([torque], dtype=float))
    if not np.all(np.isfinite(law.values)):
        raise LinkproofError("crank torque: expected finite numbers in N m, got nan or infinity; correct them")
    return law


# Crank angles at which a linkage stays at rest under its loads and a crank torque, and whether it returns to them.


# A moment smaller than this share of what the links' weights could make is rounding: the linkage is balanced.
NEGLIGIBLE: Final = 1e-12


class Equilibrium(NamedTuple):
    """A crank angle, rad in [0, 2π), where Q + M1 = 0; stable where the moment drives the crank back to it.

    For a driver that is pushed it is a travel or a length, m.
    """

    angle: float
    stable: bool


def equilibria(mechanism: Mechanism, torque: float | Law = 0.0) -> tuple[Equilibrium, ...]:
    """Every value of φ at which the moment on the crank changes sign, in increasing order.

    ``torque`` is M1, N m, a number or a law of φ. Empty without an equilibrium: the torque outweighs the loads, or
    there is no moment at any angle. Where the moment passes through infinity, in a dead position, is none. A crank that
    cannot make a full turn is searched where it can be assembled, a driver that is pushed over its range; two angles
    nearer to each other than half a degree may be missed. Raises LinkproofError for a torque that is not finite.
    """
    law = crank_torque(torque)

    def moment_of(sweep: Sweep) -> Array:
        """Moment on the crank, N m, of all loads and the crank torque, at the angles of a sweep."""
        return np.asarray(generalised_force(sweep) + law(sweep.angle)[0])

    def moment(angle: Array) -> Array:
        """Moment on the crank, N m, at crank angles, rad."""
        return moment_of(mechanism.sweep(angle))

    is_linear = mechanism.linkage.is_linear
    start = mechanism.turn.angle if is_linear else grid()
    before = mechanism.where_assembled(moment_of, start)
    peak = float(np.nanmax(np.abs(before), initial=0.0))
    if peak <= NEGLIGIBLE * _moment_scale(mechanism):
        return ()
    after = np.roll(before, -1)
    if is_linear:
        after[-1] = np.nan
    changes = np.flatnonzero((np.signbit(before) != np.signbit(after)) & np.isfinite(before) & np.isfinite(after))
    equilibria = []
    for change in changes:
        left, step = float(start[change]), float(start[1] - start[0])
        angle = root(lambda phi: float(moment(np.asarray(phi))), left, left + step)
        ends = max(abs(before[change]), abs(after[change]))
        if abs(float(moment(np.asarray(angle)))) <= ends:  # else it passes through infinity, at a dead position
            place = angle if is_linear else float(in_turn(angle))
            equilibria.append(Equilibrium(place, bool(after[change] < before[change])))
    return tuple(sorted(equilibria))


def _moment_scale(mechanism: Mechanism) -> float:
    """Moment of all links' weights at the largest lever arm in the drawing, N m."""
    linkage = mechanism.linkage
    return float(sum(link.mass for link in linkage.links.values()) * np.hypot(*linkage.gravity) * linkage.extent())


# Where loads have corners, and friction jumps.


BESIDE, NEAR_JUMP = 1e-9, 1e-4  # rad from a jump: either side; where an engine may be on either


def load_corners(mechanism: Mechanism, low: float, high: float) -> Array:
    """The values of φ between two others, rad or m, ascending, at which a load has a corner, or sets in.

    ``low`` and ``high`` themselves are left out. Of a joint with friction they are the two sides of each reversal,
    where the friction jumps. Raises LinkproofError for a load of the output where that stands still over a full turn.
    """
    laws = mechanism.linkage.laws
    places = [(corner, law.period) for law in laws if law.over == "phi" for corner in law.corners]
    places += [(corner, mechanism.period) for corner in _corners_of_turn(mechanism)]
    places += [(place + side, mechanism.period) for place in _reversals(mechanism) for side in (-BESIDE, BESIDE)]
    corners = [
        corner + (period * np.arange(np.floor((low - corner) / period), (high - corner) / period) if period else 0.0)
        for corner, period in places
    ]
    every = np.concatenate([[], *map(np.atleast_1d, corners)])
    return distinct(every[(every > low) & (every < high)])


def near_load_jumps(mechanism: Mechanism, angle: Array) -> Booleans:
    """Which values of φ (n,), rad, are within 1e-4 rad of where forces jump, True there.

    Friction turns back, or a load of one way sets in.
    """
    away = np.asarray(angle)[:, None] - [*_reversals(mechanism), *_turning_places(mechanism)]
    away -= mechanism.period * np.round(away / mechanism.period)
    return np.asarray(np.any(np.abs(away) <= NEAR_JUMP, axis=1))


def _turning_places(mechanism: Mechanism) -> list[float]:
    """The dead centres, rad, if a load acts one way, since it sets in there; [] if none does or without a full turn."""
    sets_in = mechanism.linkage.has_one_way_loads and top_of_turn(mechanism) is not None
    return [centre.angle for centre in dead_centres(mechanism)] if sets_in else []


@once_per_mechanism
def _corners_of_turn(mechanism: Mechanism) -> list[float]:
    """Crank angles, rad, at which a load over S has a corner, or one of a direction sets in; none without a turn.

    They are computed once per mechanism and not sorted.
    """
    laws, turns = mechanism.linkage.laws, round(mechanism.period / FULL_TURN)
    corners = {corner for law in laws if law.over == "S" for corner in law.corners}
    places = _turning_places(mechanism)
    for corner in sorted(corners) if corners and top_of_turn(mechanism) is not None else ():
        height = mechanism.zero_of_s() - corner
        places += zeros(lambda phi, height=height: mechanism.sweep(phi).output() - height, turns=turns).tolist()  # type: ignore[misc]
    return places


@once_per_mechanism
def _reversals(mechanism: Mechanism) -> list[float]:
    """Crank angles, rad, at which the relative motion in a joint with friction turns back; none without a turn.

    They are computed once per mechanism, joint by joint.
    """
    if not mechanism.linkage.friction or mechanism.linkage.is_linear or not mechanism.crank_range().is_full_turn:
        return []
    turns = round(mechanism.period / FULL_TURN)

    def rate(phi: Array, number: int) -> Array:
        """Rate over φ of the relative motion in the joint with friction of this number, at crank angles, rad."""
        sweep = mechanism.sweep(phi)
        return np.broadcast_to([*contacts(sweep)][number].rate, phi.shape)

    count = len([*contacts(mechanism.sweep(0.0))])
    return [place for k in range(count) for place in zeros(partial(rate, number=k), turns=turns).tolist()]
