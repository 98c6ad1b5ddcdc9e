"""The energy of an observed motion against the work put in, and what an error of it does to a released crank."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from comparisons.invariants.corrections import speed_errors, undissipated_error
from comparisons.invariants.inspection import Inspection
from comparisons.observed_motion import ObservedMotion, error_bound, error_estimate, integral
from engines.contract import History, Signal
from engines.mechanics.states import start_motion
from engines.scene import Channel, Free, Prescribed

Array = NDArray[np.float64]

TINY = float(np.finfo(float).tiny)


def energy(motion: ObservedMotion, time: Array) -> Array:
    """T + V at these times, J."""
    return motion.kinetic_energy(time) + motion.potential_energy(time)


def energy_scale(motion: ObservedMotion) -> float:
    """Peak kinetic energy, range of the potential energy and work of all other loads, J."""
    time = motion.signal(Channel.POSITION).time
    work = integral(Signal(time, motion.load_power(time)), ())
    stored = np.ptp(motion.potential_energy(time))
    return float(np.max(motion.kinetic_energy(motion.signal(Channel.VELOCITY).time)) + stored + np.max(np.abs(work)))


@dataclass(frozen=True)
class EnergyBalance:
    """Energy gained beyond the work put in, at the samples of a clock, with an estimate and a bound of its error, J."""

    time: Array
    gained: Array
    error_estimate: Array
    error_bound: Array

    @property
    def excess(self) -> Array:
        """Energy gained beyond the error bound, J: it certainly has no source."""
        return np.asarray(np.sign(self.gained) * np.maximum(np.abs(self.gained) - self.error_bound, 0.0))


def energy_balance(inspection: Inspection) -> EnergyBalance:
    """T + V − (T + V)₀ − ∫ (Mkr ω + loads) dt on the torque's clock.

    The error is that of the quadrature and, where the motion changes within a sample or two, all that changes there.
    """
    motion, drive = inspection.motion, inspection.motion.scene.drive
    torque = motion.signal(Channel.TORQUE)
    time = torque.time
    power, done = motion.load_power(time), np.zeros(len(time))
    jumps: tuple[float, ...] = ()
    if isinstance(drive, Prescribed):
        power = power + torque.values * motion.crank(Channel.VELOCITY, time)
        jumps = drive.motion.jumps
    else:  # a constant torque does its work by the angle alone
        angle = motion.crank(Channel.POSITION, time)
        done = drive.torque * (angle - angle[0])
        if drive.over_time is not None:
            power = power + drive.over_time(time) * motion.crank(Channel.VELOCITY, time)
    work = integral(Signal(time, power), jumps)
    stored = energy(motion, time) - done
    swing = np.abs(np.diff(stored)) + np.abs(np.diff(work))
    unresolved = np.concatenate([[0.0], np.cumsum(np.where(inspection.unresolved_intervals(time), swing, 0.0))])
    errors = (error(Signal(time, power), work, jumps) + unresolved for error in (error_estimate, error_bound))
    return EnergyBalance(time, stored - stored[0] - work, *errors)


def angle_error_from_energy(inspection: Inspection) -> Signal:
    """Upper estimate of a released crank's angle error, rad, on the torque's clock.

    ∫ δE/(2T) ω dt of energy without a source, and the angle less the integral of the speed.
    """
    motion = inspection.motion
    time = motion.signal(Channel.TORQUE).time
    angle, speed = motion.crank(Channel.POSITION, time), motion.crank(Channel.VELOCITY, time)
    kinetic = motion.kinetic_energy(time)
    gained = energy_balance(inspection).excess + _start_excess(motion, time[:1])
    gained = undissipated_error(gained, 2.0 * inspection.relaxation_rate(time), time)
    share = gained / (2.0 * np.maximum(kinetic, np.abs(gained)) + TINY)
    # An engine's torque may begin after the start state: until then the speed changes, so the integral begins at 0 s.
    later = int(time[0] > 0.0)
    rates = Signal(np.insert(time, 0, [0.0] * later), np.insert(speed, 0, [inspection.start[1]] * later))
    turned = integral(rates, ())
    slip = np.abs(angle - inspection.start[0] - turned[later:])
    slip = np.maximum(slip - error_bound(rates, turned, ())[later:], 0.0)
    return Signal(time, np.abs(integral(Signal(time, share * speed), ())) + slip)


def _start_excess(motion: ObservedMotion, first: Array) -> float:
    """Energy at the first sample's time (1,) beyond the start state's and the work done since, J."""
    scene, clock = motion.scene, np.zeros(1)
    position, velocity = (np.asarray(part[:, :-1], dtype=float) for part in start_motion(scene)[:2])
    start = ObservedMotion(scene, History(position=Signal(clock, position), velocity=Signal(clock, velocity)))
    work = float(first[0] * start.load_power(clock)[0])
    if isinstance(scene.drive, Free):
        work += float(scene.drive.torque_at(0.0)) * float(motion.crank(Channel.POSITION, first)[0] - scene.crank_angle)
    return float(energy(motion, first)[0] - energy(start, clock)[0]) - work


def speed_drift(inspection: Inspection) -> Signal:
    """Crank speed less what the start and the claimed acceleration make of it and the error of that, over its peak."""
    motion, start = inspection.motion, inspection.start
    time = motion.signal(Channel.VELOCITY).time
    rate = inspection.relaxation_rate(time)
    speed, acceleration = motion.crank(Channel.VELOCITY, time), motion.crank(Channel.ACCELERATION, time)
    if time[0] > 0.0:
        time, rate = np.insert(time, 0, 0.0), np.insert(rate, 0, rate[0])
        speed = np.insert(speed, 0, start[1])
        acceleration = np.insert(acceleration, 0, start[2])
    drift = speed_errors(time, speed, acceleration, rate, float(speed[0]) - start[1])
    return Signal(time, drift / (float(np.max(np.abs(speed))) or 1.0))
