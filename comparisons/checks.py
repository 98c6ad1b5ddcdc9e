"""The invariants of a run as records of their own, each judged like a deviation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from comparisons import invariants
from comparisons.case import Case
from comparisons.deviations import near_jumps
from comparisons.judging import judge
from comparisons.motion import ObservedMotion
from comparisons.records import Record
from engines.contract import Channel, Signal


def checks(case: Case, motion: ObservedMotion, blank: Record) -> tuple[Record, ...]:
    """Joint gaps, energy balance and the torque by two routes, as records of their own."""
    gaps = invariants.joint_gaps(motion)
    energy = _away_from_jumps(case, invariants.energy_balance(motion))
    routes = _two_routes(case, motion)
    torque_peak = _torque_scale(case, motion)
    kinetic_peak = float(np.max(motion.kinetic_energy().values))
    accelerations = len(motion.signal(Channel.ACCELERATION).time)

    def check(name: str, unit: str, signal: Signal, scale: float, total: int) -> Record:
        return _check(replace(blank, quantity=name, unit=unit), signal, scale, total)

    return (
        check("joint_gap", "m", gaps, case.mechanism.linkage.shortest_length(), len(gaps.time)),
        check("energy_balance", "J", energy, kinetic_peak, len(motion.signal(Channel.TORQUE).time)),
        check("torque_two_routes", "N m", routes, torque_peak, accelerations),
    )


def _torque_scale(case: Case, motion: ObservedMotion) -> float:
    """Peak drive torque, N m; of a released crank the peak of Jeq ε, which ½ Jeq' ω² all but cancels, if larger."""
    peak = float(np.max(np.abs(motion.signal(Channel.TORQUE).values)))
    if case.is_prescribed:
        return peak
    energy = motion.kinetic_energy()
    speed = motion.crank(Channel.VELOCITY, energy.time)
    fast = np.abs(speed) >= case.least_speed
    inertia = 2.0 * energy.values[fast] / speed[fast] ** 2
    return max(peak, float(np.max(np.abs(inertia * motion.crank(Channel.ACCELERATION, energy.time)[fast]))))


def _two_routes(case: Case, motion: ObservedMotion) -> Signal:
    """Torque by power balance less torque by constraint, away from standstill and acceleration jumps."""
    by_power = invariants.power_torque(motion, case.least_speed)
    torque = motion.on_clock(Channel.TORQUE, by_power.time)
    return _away_from_jumps(case, Signal(by_power.time, by_power.values - torque))


def _away_from_jumps(case: Case, signal: Signal) -> Signal:
    """A signal without its samples at acceleration jumps, where interpolating between samples means nothing."""
    kept = ~near_jumps(signal.time, case.motion.jumps)
    return Signal(signal.time[kept], signal.values[kept])


def _check(blank: Record, signal: Signal, scale: float, total: int) -> Record:
    """A record of a signal that should be zero everywhere, relative to a scale."""
    relative = np.abs(signal.values) / (scale or 1.0)
    worst = int(np.argmax(relative))
    return judge(
        replace(
            blank,
            error_max=float(relative[worst]),
            error_rms=float(np.sqrt(np.mean(relative**2))),
            peak=scale,
            worst_time=float(signal.time[worst]),
            samples=len(relative),
            left_out=total - len(relative),
        )
    )
