"""The quantities that are compared: what each is in the closed form, and how it is read from an engine's motion.

A quantity is one row of ``QUANTITIES``; adding one adds nothing elsewhere. S is the output's displacement from its top
dead centre (positive away from it), v and a its time derivatives, as in article 003.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from analytic import dynamics
from analytic.errors import LinkproofError, UnknownNameError
from analytic.harmonics import top_dead_centre
from analytic.linkage import Output, Vector
from analytic.mechanism import Mechanism
from analytic.regimes import CrankMotion
from analytic.sweep import Sweep
from comparisons.motion import ObservedMotion
from engines.contract import Channel, Signal

Array = NDArray[np.float64]

# Jeq = 2T/ω² says nothing near standstill: samples slower than this share of the peak speed are left out.
SLOW_SHARE = 0.05


@dataclass(frozen=True)
class Case:
    """One mechanism under one prescribed crank motion: the truth an engine is held against."""

    mechanism: Mechanism
    motion: CrankMotion

    @property
    def output(self) -> Output:
        """The linkage's output; S, v and a need one."""
        output = self.mechanism.linkage.output
        if output is None:
            raise LinkproofError(
                f"'{self.mechanism.linkage.name}' names no output, so S, v and a are undefined: add "
                "output = { point = ..., along = [x, y] } to its file, or leave these quantities out"
            )
        return output

    @property
    def least_speed(self) -> float:
        """Crank speed, rad/s, below which quantities divided by ω are left out."""
        return SLOW_SHARE * self.motion.peak_speed

    def sweep(self, time: Array) -> Sweep:
        """The closed form along the motion."""
        return self.mechanism.sweep(self.motion.angle(time))

    def output_anchor(self) -> Vector:
        """The output point relative to its link's mass centre, link frame, m."""
        link = self.mechanism.linkage.links[self.output.link]
        point = link.points[self.output.point]
        return (point[0] - link.centre[0], point[1] - link.centre[1])

    def along(self, vectors: Array) -> Array:
        """Component of (n, 2) vectors along the output's direction."""
        return np.asarray(vectors @ np.asarray(self.output.along))


@dataclass(frozen=True)
class Quantity:
    """A compared quantity: ``reference(case, time)`` is the truth, ``observed(case, motion)`` what the engine did."""

    name: str
    unit: str
    title: str
    channels: frozenset[Channel]
    reference: Callable[[Case, Array], Array]
    observed: Callable[[Case, ObservedMotion], Signal]
    holds_acceleration: bool = False
    needs_output: bool = False


def _inertia(case: Case, motion: ObservedMotion) -> Signal:
    energy = motion.kinetic_energy()
    speed = motion.crank(Channel.VELOCITY, energy.time)
    fast = np.abs(case.motion.speed(energy.time)) >= case.least_speed
    return Signal(energy.time[fast], 2.0 * energy.values[fast] / speed[fast] ** 2)


def _power(case: Case, motion: ObservedMotion) -> Signal:
    torque = motion.signal(Channel.TORQUE)
    return Signal(torque.time, torque.values * motion.crank(Channel.VELOCITY, torque.time))


def _displacement(case: Case, motion: ObservedMotion) -> Signal:
    time = motion.signal(Channel.POSITION).time
    place = case.along(motion.point(case.output.link, case.output_anchor(), time))
    return Signal(time, top_dead_centre(case.mechanism).coordinate - place)


def _velocity(case: Case, motion: ObservedMotion) -> Signal:
    time = motion.signal(Channel.VELOCITY).time
    return Signal(time, -case.along(motion.point_velocity(case.output.link, case.output_anchor(), time)))


def _acceleration(case: Case, motion: ObservedMotion) -> Signal:
    time = motion.signal(Channel.ACCELERATION).time
    return Signal(time, -case.along(motion.point_acceleration(case.output.link, case.output_anchor(), time)))


def _true_torque(case: Case, time: Array) -> Array:
    return dynamics.drive_torque(case.sweep(time), case.motion.speed(time), case.motion.acceleration(time))


def _true_displacement(case: Case, time: Array) -> Array:
    return top_dead_centre(case.mechanism).coordinate - case.sweep(time).output()


def _true_acceleration(case: Case, time: Array) -> Array:
    sweep, speed = case.sweep(time), case.motion.speed(time)
    second = sweep.output(2) * speed**2
    return -(second + sweep.output(1) * case.motion.acceleration(time))


QUANTITIES: Mapping[str, Quantity] = {
    quantity.name: quantity
    for quantity in (
        Quantity(
            name="Jeq",
            unit="kg m²",
            title="reduced moment of inertia",
            channels=frozenset({Channel.VELOCITY}),
            reference=lambda case, time: dynamics.reduced_inertia(case.sweep(time)),
            observed=_inertia,
        ),
        Quantity(
            name="Teq",
            unit="J",
            title="kinetic energy",
            channels=frozenset({Channel.VELOCITY}),
            reference=lambda case, time: dynamics.kinetic_energy(case.sweep(time), case.motion.speed(time)),
            observed=lambda case, motion: motion.kinetic_energy(),
        ),
        Quantity(
            name="Mkr",
            unit="N m",
            title="crank torque",
            channels=frozenset({Channel.TORQUE}),
            reference=_true_torque,
            observed=lambda case, motion: motion.signal(Channel.TORQUE),
            holds_acceleration=True,
        ),
        Quantity(
            name="Peq",
            unit="W",
            title="drive power",
            channels=frozenset({Channel.TORQUE, Channel.VELOCITY}),
            reference=lambda case, time: _true_torque(case, time) * case.motion.speed(time),
            observed=_power,
            holds_acceleration=True,
        ),
        Quantity(
            name="S",
            unit="m",
            title="output displacement",
            channels=frozenset({Channel.POSITION}),
            reference=_true_displacement,
            observed=_displacement,
            needs_output=True,
        ),
        Quantity(
            name="v",
            unit="m/s",
            title="output velocity",
            channels=frozenset({Channel.POSITION, Channel.VELOCITY}),
            reference=lambda case, time: -case.sweep(time).output(1) * case.motion.speed(time),
            observed=_velocity,
            needs_output=True,
        ),
        Quantity(
            name="a",
            unit="m/s²",
            title="output acceleration",
            channels=frozenset({Channel.POSITION, Channel.VELOCITY, Channel.ACCELERATION}),
            reference=_true_acceleration,
            observed=_acceleration,
            holds_acceleration=True,
            needs_output=True,
        ),
    )
}


def quantity(name: str) -> Quantity:
    """The quantity of that name; raises UnknownNameError with the nearest known one."""
    if name not in QUANTITIES:
        raise UnknownNameError("quantity", name, QUANTITIES)
    return QUANTITIES[name]
