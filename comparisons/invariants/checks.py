"""The invariants of a run as records of their own, each judged like a deviation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from comparisons.invariants import invariants
from comparisons.invariants.energy_account import energy_at_play, energy_gained
from comparisons.invariants.inspection import Inspection
from comparisons.judging.deviations import near_jumps
from comparisons.judging.records import Record
from comparisons.judging.verdicts import judge
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.case import Case
from engines.contract import Signal
from engines.scene import Channel

LARGEST = 1e150  # however far off a motion is, its square is a number


def checks(case: Case, motion: ObservedMotion, blank: Record) -> tuple[Record, ...]:
    """One record per invariant; the balance of joint forces only where they were recorded."""
    return tuple(_checks(case, motion, blank))


def _checks(case: Case, motion: ObservedMotion, blank: Record) -> Iterator[Record]:
    seen = Inspection(motion)
    torque, acceleration = motion.signal(Channel.TORQUE), motion.signal(Channel.ACCELERATION)

    def check(name: str, unit: str, signal: Signal, scale: float, total: int) -> Record:
        return _check(replace(blank, quantity=name, unit=unit), signal, scale, total)

    gaps = invariants.joint_gaps(motion)
    yield check("joint_gap", "m", gaps, case.mechanism.linkage.shortest_length(), len(gaps.time))
    closure, count = _closure(case, seen)
    yield check("closure", "", closure, 1.0, count)
    mode = seen.assembly_mode()
    yield check("assembly_mode", "", mode, 1.0, len(mode.time))
    phase = invariants.crank_phase(seen)
    yield check("crank_phase", "rad", phase, 1.0, len(phase.time))
    energy = _away_from_jumps(case, energy_gained(seen))
    yield check("energy_balance", "J", energy, energy_at_play(motion), len(torque.time))
    required = _away_from_jumps(case, seen.torque_required())
    routes = Signal(required.time, required.values - motion.on_clock(Channel.TORQUE, required.time))
    yield check("torque_two_routes", "N m", routes, _torque_scale(case, motion), len(acceleration.time))
    if motion.history.joint_force:
        forces = _away_from_jumps(case, seen.force_balance())
        yield check("force_balance", "", forces, 1.0, len(acceleration.time))


def _closure(case: Case, seen: Inspection) -> tuple[Signal, int]:
    """The corrections of all levels one after the other, and how many there were before any was left out."""
    levels = invariants.closure(seen)
    count = sum(len(signal.time) for signal in levels.values())
    levels[Channel.ACCELERATION.value] = _away_from_jumps(case, levels[Channel.ACCELERATION.value])
    joined = [np.concatenate([getattr(s, part) for s in levels.values()]) for part in ("time", "values")]
    return Signal(*joined), count


def _torque_scale(case: Case, motion: ObservedMotion) -> float:
    """Peak drive torque, N m; of a released crank the peak of Jeq ε, which ½ Jeq' ω² all but cancels, if larger."""
    peak = float(np.max(np.abs(motion.signal(Channel.TORQUE).values)))
    if case.is_prescribed:
        return peak
    time = motion.signal(Channel.VELOCITY).time
    speed = motion.crank(Channel.VELOCITY, time)
    fast = np.abs(speed) >= case.least_speed
    inertia = 2.0 * motion.kinetic_energy(time)[fast] / speed[fast] ** 2
    return max(peak, float(np.max(np.abs(inertia * motion.crank(Channel.ACCELERATION, time)[fast]))))


def _away_from_jumps(case: Case, signal: Signal) -> Signal:
    """A signal without its samples at acceleration jumps, where interpolating between samples means nothing."""
    kept = ~near_jumps(signal.time, case.motion.jumps)
    return Signal(signal.time[kept], signal.values[kept])


def _check(blank: Record, signal: Signal, scale: float, total: int) -> Record:
    """A record of a signal that should be zero everywhere, relative to a scale; what is undefined is left out."""
    told = ~np.isnan(signal.values)
    time, relative = signal.time[told], np.minimum(np.abs(signal.values[told]) / (scale or 1.0), LARGEST)
    worst = int(np.argmax(relative)) if len(relative) else 0
    return judge(
        replace(
            blank,
            error_max=float(relative[worst]) if len(relative) else 0.0,
            error_rms=float(np.sqrt(np.mean(relative**2))) if len(relative) else 0.0,
            peak=scale,
            worst_time=float(time[worst]) if len(relative) else None,
            samples=len(relative),
            left_out=total - len(relative),
        )
    )
