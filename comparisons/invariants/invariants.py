"""Invariants of any true motion, checked on the engine's own motion, without the closed form.

So a wrong motion is caught even where no reference exists. For a linkage of one degree of freedom these checks are
complete: what passes them all is the motion of the scene, short of what their limits let through.

- *Positions.* A crank angle and the assembly mode of every Assur group fix all positions. ``crank_phase`` holds the
  crank to the angle its drive prescribes, ``closure`` the bodies to the joints at that angle, not by how far a joint is
  open but by how far a body is off because of it, which near a dead position is much more. ``assembly_mode`` holds
  each group to the mode it starts in: its equations' determinant changes sign where the other one is entered.
- *Velocities and accelerations* are fixed by the positions and the crank's: ``closure`` on the next two levels.
- *Torque and joint forces* are fixed by those and the loads, standstill included: ``torque_two_routes`` and
  ``force_balance``.
- *A released crank* obeys φ' = ω, ω' = ε and the equation of motion for ε: ``crank_phase``, ``closure`` and
  ``torque_two_routes`` hold it to each. What each of them lets through adds up over turns, but moves the energy: δE in
  it makes δE/2T of the speed, and ``crank_phase`` is what that has come to, beside what ω does not integrate to. (On
  its way past an unstable equilibrium an error of phase grows as in any true motion, and no balance tells how far.)
- Samples half a turn apart show no motion, and ``crank_phase`` says so. What they leave out of their own steps is seen
  before anything is judged (``comparisons.runs.run_engine``).

``energy_balance`` and ``joint_gap`` say nothing beyond these for a prescribed motion. The joints' equations and the
loads are those of ``engines.mechanics``, shared with ``direct``: no formula is shared with the closed form.
"""

from __future__ import annotations

import numpy as np

from comparisons.invariants.corrections import LEVELS
from comparisons.invariants.energy_account import released_phase, speed_drift
from comparisons.invariants.inspection import Inspection
from comparisons.observation.observed_motion import ObservedMotion
from engines.contract import Signal
from engines.scene import Channel, Free, Prescribed

HALF_TURN = np.pi  # rad between two samples: beyond it they show no motion


def joint_gaps(motion: ObservedMotion) -> Signal:
    """Largest opening of any joint, m, over time: pins apart, sliders and slot pins off their line."""
    time = motion.signal(Channel.POSITION).time
    return Signal(time, np.max(list(motion.joint_gaps(time).values()), axis=0))


def closure(seen: Inspection) -> dict[str, Signal]:
    """``Inspection.corrections`` and, of a released crank, ``drift``: its speed against its acceleration."""
    drift = {"drift": speed_drift(seen)} if isinstance(seen.motion.scene.drive, Free) else {}
    return seen.corrections() | drift


def crank_phase(seen: Inspection) -> Signal:
    """The driver's distance from its prescribed or released motion, or the largest gap between samples, rad or m."""
    drive, time = seen.motion.scene.drive, seen.motion.signal(Channel.POSITION).time
    if isinstance(drive, Prescribed):
        signal = Signal(time, np.abs(seen.motion.crank(Channel.POSITION, time) - drive.motion.angle(time)))
    else:
        signal = released_phase(seen)
    return Signal(signal.time, np.maximum(signal.values, _gap(seen)))


def _gap(seen: Inspection) -> float:
    """Largest angle between two samples of a channel, rad, where it is more than half a turn; else 0."""
    motion = seen.motion
    signals = [motion.signal(channel) for channel in (*LEVELS, Channel.TORQUE) if motion.has(channel)]
    clocks = [signal.time for signal in (*signals, *motion.history.joint_force.values())]
    turned = max(float(np.max(np.abs(np.diff(motion.crank(Channel.POSITION, time))))) for time in clocks)
    return turned if turned > HALF_TURN * seen.radian else 0.0
