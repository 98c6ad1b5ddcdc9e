"""The equation of motion of a linkage, solved for the crank's acceleration.

Article 000, eqs (22) and (32): k1 φ̈ + k2 φ̇² + b φ̇ = Q1, here Jeq φ̈ + ½ Jeq' φ̇² + b φ̇ = Q + M1. The article builds k2
from the moduli |S'|·|S''| (eqs (29) and (30)) where Lagrange's equation has the scalar product S'·S''; that is not the
derivative of Jeq, and engines refute it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, NamedTuple, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.crank_motion import degrees
from analytic.description.law import FULL_TURN, Law, TimeLaw
from analytic.dynamics import reduced
from analytic.errors import AssemblyError, LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.numerics.periodic_table import DEGREE, PeriodicTable, tabulate
from analytic.numerics.refine import extremes, grid, in_turn
from analytic.numerics.roots import evaluate_assembled, root

Array = NDArray[np.float64]
NO_INERTIA: Final = 1e-12  # of the peak of Jeq: a smooth minimum this deep is a zero to rounding


class TimeDependence(TypedDict, total=False):
    """Arguments of ``analytic.numerics.integration.integrate``."""

    push: Callable[[Array, Array], Array]
    knots: Sequence[float]


@dataclass(frozen=True)
class EquationOfMotion:
    """φ̈ as a function of φ and φ̇; ``torque`` is M1 on the crank, N m, beside the linkage's own loads.

    A torque ``over_time`` acts besides, so that φ̈ depends on time too: ``push`` is its part of φ̈.
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
        """The ``terms`` from the closed form, whether there is a table or not; shape (3 or 4, *angle.shape)."""
        sweep = self.mechanism.sweep(angle)
        inertia = reduced.reduced_inertia(sweep)
        moment = reduced.generalised_force(sweep) + self.torque(angle)[0]
        slope = reduced.half_inertia_derivative(sweep)
        timed = [] if self.over_time is None else [np.ones_like(inertia)]
        return np.stack([moment, reduced.damping_coefficient(sweep), slope, *timed]) / inertia

    @cached_property
    def peak_moment(self) -> float:
        """Largest |Q + M1|/Jeq over the angles that the crank can reach, rad/s²."""
        seen = self.mechanism.turn.angle if self.mechanism.linkage.is_linear else grid()
        most = 0.0 if self.over_time is None else max(map(abs, self.over_time.torque))

        def moment(angle: Array) -> Array:
            terms = np.abs(self.terms(angle))
            return np.asarray(terms[0] + most * terms[3] if most else terms[0])

        return float(np.nanmax(evaluate_assembled(moment, seen), initial=0.0))

    def acceleration(self, angle: ArrayLike, speed: ArrayLike) -> Array:
        """φ̈, rad/s², at crank angles φ, rad, and speeds φ̇, rad/s, of one shape, without ``push``."""
        angle, speed = np.asarray(angle, dtype=float), np.asarray(speed, dtype=float)
        moment, damping, slope = self.terms(angle)[:3]
        return np.asarray(moment - speed * (damping + slope * speed))

    def push(self, time: ArrayLike, angle: ArrayLike) -> Array:
        """The part of φ̈ that the torque over time adds, rad/s², at instants, s, and crank angles, rad, of one shape."""
        if self.over_time is None:
            return np.zeros(np.shape(time))
        return np.asarray(self.over_time(time) * self.terms(np.asarray(angle, dtype=float))[3])

    @property
    def period(self) -> float:
        """Period of every term in φ, rad; infinite for a driver that is pushed."""
        return math.inf if self.mechanism.linkage.is_linear else self.mechanism.period

    @property
    def timing(self) -> TimeDependence:
        """What an integrator needs of the torque over time: its part of φ̈, and the times of its kinks, s."""
        return {} if self.over_time is None else {"push": self.push, "knots": self.over_time.times}

    def tabulated(self, degree: int = DEGREE) -> EquationOfMotion:
        """The equation read from a table over its period, which is faster; unchanged for a crank without full turns."""
        if self.mechanism.linkage.is_linear:
            return self
        try:
            table = tabulate(self.closed_form, degree, ends=(0.0, self.period), period=self.period)
        except AssemblyError:
            return self
        return replace(self, table=table)


def equation_of_motion(
    mechanism: Mechanism, torque: float | Law = 0.0, over_time: TimeLaw | None = None
) -> EquationOfMotion:
    """The equation under a crank torque M1, N m, constant or a law of φ, and a torque ``over_time`` besides."""
    _check_inertia(mechanism)
    return EquationOfMotion(mechanism, crank_torque(torque), over_time=over_time)


def _check_inertia(mechanism: Mechanism) -> None:
    """Raise LinkproofError where Jeq vanishes at a crank angle, so that no acceleration follows from the loads."""

    def inertia(angle: Array) -> Array:
        return evaluate_assembled(lambda at: reduced.reduced_inertia(mechanism.sweep(at)), angle.ravel()).reshape(
            angle.shape
        )

    linkage = mechanism.linkage
    if linkage.crank and np.any(reduced.link_inertia(mechanism.sweep(0.0), linkage.crank)):
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
    """A crank torque given as a number, N m, or as a law of φ."""
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
    """Every angle at which the moment on the crank changes sign, in increasing order.

    ``torque`` is M1, N m, a number or a law of φ. Empty without an equilibrium: the torque outweighs the loads,
    or there is no moment at any angle. A crank that cannot make a full turn is searched over its range, like a driver
    that is pushed; two angles nearer to each other than half a degree may be missed.
    """
    law = crank_torque(torque)

    def moment(angle: Array) -> Array:
        return np.asarray(reduced.generalised_force(mechanism.sweep(angle)) + law(angle)[0])

    is_linear = mechanism.linkage.is_linear
    start = mechanism.turn.angle if is_linear else grid()
    before = evaluate_assembled(moment, start)
    peak = float(np.nanmax(np.abs(before), initial=0.0))
    if peak <= NEGLIGIBLE * _moment_scale(mechanism):
        return ()
    after = np.roll(before, -1)
    if is_linear:
        after[-1] = np.nan
    changes = np.flatnonzero((np.signbit(before) != np.signbit(after)) & np.isfinite(before) & np.isfinite(after))
    equilibria = []
    for change in changes:
        left = float(start[change])
        right = float(start[change + 1]) if is_linear else left + FULL_TURN / len(start)
        angle = root(lambda phi: float(moment(np.asarray(phi))), left, right)
        ends = max(abs(before[change]), abs(after[change]))
        if abs(float(moment(np.asarray(angle)))) <= ends:  # else it passes through infinity, at a dead position
            place = angle if is_linear else float(in_turn(angle))
            equilibria.append(Equilibrium(place, bool(after[change] < before[change])))
    return tuple(sorted(equilibria))


def _moment_scale(mechanism: Mechanism) -> float:
    """Moment of all links' weights at the largest lever arm in the drawing, N m."""
    linkage = mechanism.linkage
    return float(sum(link.mass for link in linkage.links.values()) * np.hypot(*linkage.gravity) * linkage.extent())
