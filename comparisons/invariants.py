"""What must hold in any true motion, checked on the engine's own: joints closed, energy and power balanced.

No closed form enters here, so that a wrong motion is caught even where no reference exists.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from analytic.linkage import GROUND, Vector
from comparisons.interpolation import resample
from comparisons.loads import conservative_power, other_power, potential_energy
from comparisons.motion import ObservedMotion
from engines.contract import Channel, Prescribed, Signal

Array = NDArray[np.float64]

# A fourth-order quadrature is off by a fifteenth of its difference from the one on half its samples; jumps spoil that.
DOUBT_SHARE = 0.25

INVARIANTS: Mapping[str, frozenset[Channel]] = {
    "joint_gap": frozenset({Channel.POSITION}),
    "energy_balance": frozenset({Channel.POSITION, Channel.VELOCITY, Channel.TORQUE}),
    "torque_two_routes": frozenset({Channel.POSITION, Channel.VELOCITY, Channel.ACCELERATION, Channel.TORQUE}),
}


def joint_gaps(motion: ObservedMotion) -> Signal:
    """Largest opening of any joint, m, over time: pins apart, sliders and slot pins off their line."""
    time = motion.signal(Channel.POSITION).time
    worst = np.zeros(len(time))
    for pin in motion.scene.pins:
        first = motion.point(pin.first, pin.first_anchor, time)
        gap = first - motion.point(pin.second, pin.second_anchor, time)
        worst = np.maximum(worst, np.hypot(*gap.T))
    for joint in motion.scene.guided:
        gap_vector = motion.point(joint.body, joint.anchor, time) - motion.point(joint.host, joint.through, time)
        x, y = _direction(motion, joint.host, joint.along, time)
        worst = np.maximum(worst, np.abs(x * gap_vector[:, 1] - y * gap_vector[:, 0]))
    return Signal(time, worst)


def _direction(motion: ObservedMotion, host: str, along: Vector, time: Array) -> tuple[Array, Array]:
    if host == GROUND:
        return np.full(len(time), along[0]), np.full(len(time), along[1])
    return motion.arm(host, along, time)


def energy_balance(motion: ObservedMotion) -> Signal:
    """Energy gained beyond the work put in, J: T + V − (T + V)₀ − ∫ (Mkr ω + loads) dt, on the torque's clock.

    What the quadrature itself leaves in doubt, seen by halving its samples, is not held against the engine.
    """
    torque = motion.signal(Channel.TORQUE)
    time = torque.time
    power = torque.values * motion.crank(Channel.VELOCITY, time) + other_power(motion, time)
    drive = motion.scene.drive
    jumps = drive.motion.jumps if isinstance(drive, Prescribed) else ()
    work = integral(Signal(time, power), jumps)
    coarse = Signal(time[::2], integral(Signal(time[::2], power[::2]), jumps))
    doubt = DOUBT_SHARE * np.maximum.accumulate(np.abs(resample(coarse, time) - work))
    velocity = motion.on_clock(Channel.VELOCITY, time)
    kinetic = 0.5 * np.einsum("nbk,bk->n", velocity**2, motion.masses)
    energy = kinetic + potential_energy(motion, time)
    gained = energy - energy[0] - work
    return Signal(time, np.sign(gained) * np.maximum(np.abs(gained) - doubt, 0.0))


def integral(signal: Signal, jumps: tuple[float, ...]) -> Array:
    """∫ dt from the first sample to each, fourth order between the times at which the signal jumps.

    A sample on a jump has two values, so that it is dropped and both sides are extrapolated to it.
    """
    time = signal.time
    near = 1e-6 * float(time[1] - time[0])
    on_jump = np.any([np.abs(time - jump) <= near for jump in jumps] or [np.zeros(len(time), dtype=bool)], axis=0)
    borders = [float(time[0]), *(jump for jump in jumps if time[0] < jump < time[-1]), float(time[-1])]
    result = np.zeros(len(time))
    total = 0.0
    for start, end in itertools.pairwise(borders):
        inside = (time >= start) & (time <= end) & ~on_jump
        stretch = Signal(time[inside], signal.values[inside])
        nodes = np.unique(np.concatenate([[start], stretch.time, [end]]))
        sums = total + _cumulative(nodes, resample(stretch, nodes))
        here = (time >= start - near) & (time <= end + near)
        result[here] = sums[np.clip(np.searchsorted(nodes, time[here] - near), 0, len(nodes) - 1)]
        total = float(sums[-1])
    return result


def _cumulative(time: Array, power: Array) -> Array:
    """∫ power dt by the trapezoid rule with its end correction, fourth order where the power is smooth."""
    step = np.diff(time)
    slope = np.gradient(power, time, edge_order=2)
    parts = step * (power[1:] + power[:-1]) / 2.0 + step**2 * (slope[:-1] - slope[1:]) / 12.0
    return np.concatenate([[0.0], np.cumsum(parts)])


def power_torque(motion: ObservedMotion, least_speed: float) -> Signal:
    """The drive torque by the other route, N m: (dT/dt − power of all loads) / ω, where the crank is fast enough."""
    time = motion.signal(Channel.ACCELERATION).time
    speed = motion.crank(Channel.VELOCITY, time)
    power = motion.kinetic_power(time) - conservative_power(motion, time) - other_power(motion, time)
    fast = np.abs(speed) >= least_speed
    return Signal(time[fast], power[fast] / speed[fast])
