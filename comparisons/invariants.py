"""What must hold in any true motion, checked on the engine's own; no closed form enters.

So a wrong motion is caught even where no reference exists. For a linkage of one degree of freedom these checks are
complete: what passes them all is the motion of the scene, short of what their limits let through.

- *Positions.* A crank angle and the assembly mode of every Assur group fix all positions. ``crank_phase`` holds the
  crank to the angle its drive prescribes, ``closure`` the bodies to the joints at that angle, not by how far a joint is
  open but by how far a body is off because of it, which near a dead position is much more. ``assembly_mode`` holds
  each group to the mode it starts in: its equations' determinant changes sign where the other one is entered.
- *Velocities and accelerations* are fixed by the positions and the crank's: ``closure`` on the next two levels.
- *Torque and joint forces* are fixed by those and the loads, standstill included: ``torque_two_routes`` and
  ``force_balance``.
- *A released crank* moves by its energy: ω² = 2 (E₀ + work − V) / Jeq, so that energy held to the start state's leaves
  only its sense and whether it rests at a turning point, where ``torque_two_routes``, then the equation of motion,
  forbids it. But an error too small for ``energy_balance`` adds up over turns: δE in the energy makes δE/2T of the speed,
  and ``crank_phase`` is what that has come to, beside what the speed itself does not integrate to. (On its way past an
  unstable equilibrium an error of phase grows as it would in any true motion, and no balance tells how far.)
- ``crank_phase`` also holds a history to its whole duration: half a motion is not a motion.

``energy_balance`` and ``joint_gap`` say nothing beyond these for a prescribed motion; they share no equation with them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from analytic.linkage import GROUND, Vector
from comparisons.body_states import States
from comparisons.corrections import LEVELS, Findings, findings
from comparisons.joint_equations import JointEquations
from comparisons.interpolation import POINTS, resample
from comparisons.loads import dissipation, other_power, potential_energy
from comparisons.motion import ObservedMotion
from comparisons.quadrature import doubt, integral
from comparisons.relaxation import forgotten, speed_errors
from engines.contract import Channel, Free, History, Prescribed, Signal

Array = NDArray[np.float64]

KINEMATICS = frozenset(LEVELS)
INVARIANTS: Mapping[str, frozenset[Channel]] = {
    "joint_gap": frozenset({Channel.POSITION}),
    "closure": KINEMATICS,
    "assembly_mode": frozenset({Channel.POSITION}),
    "crank_phase": KINEMATICS | {Channel.TORQUE},
    "energy_balance": frozenset({Channel.POSITION, Channel.VELOCITY, Channel.TORQUE}),
    "torque_two_routes": KINEMATICS | {Channel.TORQUE},
    "force_balance": KINEMATICS | {Channel.JOINT_FORCE},
}

# Steps by which a history may begin late or end early: a sample at either end can be missing.
MISSING_STEPS = 2.0
# A joint's peak force below this share of the largest is nothing to measure its own error by.
FAINT_FORCE = 1e-9
# A determinant that changes by this share of itself from sample to sample leaves a peak between them unseen; so many
# samples on either side are as doubtful.
SHARP, REACH = 0.3, 2.0
TINY = float(np.finfo(float).tiny)
STANDSTILL = 1e-12  # of the peak kinetic energy: of less, no rate of damping can be told
COARSE = 0.5  # rad of crank between samples: a dozen of a turn show its energy, not the work done between them


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
    """``Inspection.energy_balance`` of a motion."""
    return Inspection(motion).energy_balance()


def power_torque(motion: ObservedMotion, least_speed: float = 0.0) -> Signal:
    """The drive torque by the other route, N m: by virtual power, where the crank turns at least so fast."""
    required = Inspection(motion).torque_required()
    fast = np.abs(motion.crank(Channel.VELOCITY, required.time)) >= least_speed
    return Signal(required.time[fast], required.values[fast])


@dataclass(frozen=True)
class Inspection:
    """One observed motion with all that its joints' equations say of it, on each of its clocks."""

    motion: ObservedMotion

    @cached_property
    def equations(self) -> JointEquations:
        """The scene's."""
        return JointEquations(self.motion.scene)

    @cached_property
    def _findings(self) -> dict[bytes, Findings]:
        """By clock, each looked at up to the highest derivative that has it, so that channels on one share the work."""
        orders: dict[bytes, int] = {}
        clocks: dict[bytes, Array] = {}
        for order, channel in enumerate(LEVELS):
            time = self.motion.signal(channel).time
            orders[time.tobytes()], clocks[time.tobytes()] = order, time
        return {key: findings(self.motion, self.equations, clocks[key], order) for key, order in orders.items()}

    def on(self, channel: Channel) -> Findings:
        """What is found at a channel's samples."""
        return self._findings[self.motion.signal(channel).time.tobytes()]

    def closure(self) -> dict[str, Signal]:
        """The largest correction of any body, by level, that fits it to the joints and a prescribed crank.

        Displacements over the scene's size, turns in rad; of velocities and accelerations over their peak in the run.
        A released crank has one more, ``drift``: by how much its speed is not what its acceleration makes of it.
        """
        result = {}
        for order, channel in enumerate(LEVELS):
            found = self.on(channel)
            scale = float(np.max(found.moving[order])) if order else 1.0
            result[channel.value] = Signal(found.time, found.lacking[order] / (scale or 1.0))
        return result | ({"drift": self._drift()} if isinstance(self.motion.scene.drive, Free) else {})

    def _drift(self) -> Signal:
        """Crank speed beyond what the start and the claimed acceleration make of it, over its peak; doubt left out."""
        motion, scene = self.motion, self.motion.scene
        time = motion.signal(Channel.VELOCITY).time
        crank = next(body for body in scene.bodies if body.name == scene.crank)
        kinetic = motion.kinetic_energy().values
        moving = kinetic > STANDSTILL * np.max(kinetic)
        rate = 0.5 * dissipation(motion, time) / np.where(moving, kinetic, 1.0)
        rate = np.interp(time, time[moving], rate[moving]) if moving.any() else np.zeros(len(time))
        speed, acceleration = motion.crank(Channel.VELOCITY, time), motion.crank(Channel.ACCELERATION, time)
        if time[0] > 0.0:
            time, rate = np.insert(time, 0, 0.0), np.insert(rate, 0, rate[0])
            speed = np.insert(speed, 0, crank.angular_velocity)
            acceleration = np.insert(acceleration, 0, crank.angular_acceleration)
        drift = speed_errors(time, speed, acceleration, rate, speed[0] - crank.angular_velocity)
        scale = float(np.max(np.abs(speed))) or 1.0
        return Signal(time, drift / scale)

    def assembly_mode(self) -> Signal:
        """How far any group is into the mode it did not start in, over the farthest it is from a dead position."""
        found = self.on(Channel.POSITION)
        depth = np.maximum(-found.determinants * np.sign(self._start_determinants()), 0.0)
        return Signal(found.time, np.max(depth / np.max(np.abs(found.determinants), axis=0), axis=1))

    def _start_determinants(self) -> Array:
        bodies, size = self.motion.scene.bodies, self.equations.size
        places = [(b.position[0] / size, b.position[1] / size, b.angle) for b in bodies]
        start = States(self.equations.numbers, size, np.array([places]))
        return self.equations.group_determinants(self.equations.jacobian(start))[0]

    def torque_required(self) -> Signal:
        """Drive torque by the power that the motion and its loads take, N m, on the acceleration's clock.

        By virtual power, so that it is defined at standstill too; of a prescribed crank for the acceleration it ought
        to have. Where the claimed torque has no samples there is nothing to hold it against.
        """
        found, clock = self.on(Channel.ACCELERATION), self.motion.signal(Channel.TORQUE).time
        kept = (found.time >= clock[0]) & (found.time <= clock[-1])
        return Signal(found.time[kept], found.torque[kept])

    def force_balance(self) -> Signal:
        """How far any joint's force is from what the bodies' balance requires of it, over its own peak."""
        found, claimed = self.on(Channel.ACCELERATION), self.motion.history.joint_force
        joints = [*self.motion.scene.pins, *self.motion.scene.guided]
        clock = next(iter(claimed.values())).time
        kept = (found.time >= clock[0]) & (found.time <= clock[-1])
        peaks = np.nanmax(np.hypot(found.forces[..., 0], found.forces[..., 1]), axis=0, initial=0.0)
        scales = np.maximum(peaks, FAINT_FORCE * np.max(peaks)) + TINY
        worst = np.zeros(int(kept.sum()))
        for number, joint in enumerate(joints):
            difference = resample(claimed[joint.name], found.time[kept]) - found.forces[kept, number]
            worst = np.maximum(worst, np.hypot(*difference.T) / scales[number])
        return Signal(found.time[kept], worst)

    def energy_balance(self) -> Signal:
        """Energy gained beyond the work put in, J: T + V − (T + V)₀ − ∫ (Mkr ω + loads) dt, on the torque's clock.

        What the quadrature itself leaves in doubt is not held against the engine.
        """
        motion, drive = self.motion, self.motion.scene.drive
        torque = motion.signal(Channel.TORQUE)
        time = torque.time
        power, done = other_power(motion, time), np.zeros(len(time))
        borders: tuple[float, ...] = ()
        if isinstance(drive, Free):  # a constant torque does its work by the angle alone
            angle = motion.crank(Channel.POSITION, time)
            done = drive.torque * (angle - angle[0])
        else:
            power = power + torque.values * motion.crank(Channel.VELOCITY, time)
            borders = tuple(segment.start for segment in drive.motion.segments)
        work = integral(Signal(time, power), borders)
        energy = self.energy(time)
        gained = energy - energy[0] - done - work
        unsure = doubt(Signal(time, power), work, borders)
        swing = np.abs(np.diff(energy - done)) + np.abs(np.diff(work))
        unsure += np.concatenate([[0.0], np.cumsum(np.where(self._unresolved(time), swing, 0.0))])
        return Signal(time, np.sign(gained) * np.maximum(np.abs(gained) - unsure, 0.0))

    def energy(self, time: Array) -> Array:
        """T + V at these times, J."""
        velocity = self.motion.on_clock(Channel.VELOCITY, time)
        kinetic = 0.5 * np.einsum("nbk,bk->n", velocity**2, self.motion.masses)
        return np.asarray(kinetic + potential_energy(self.motion, time))

    def energy_scale(self) -> float:
        """The energy at play, J: peak kinetic energy, range of the potential energy, work of all other loads."""
        time = self.motion.signal(Channel.POSITION).time
        work = integral(Signal(time, other_power(self.motion, time)), ())
        stored = np.ptp(potential_energy(self.motion, time))
        return float(np.max(self.motion.kinetic_energy().values) + stored + np.max(np.abs(work)))

    def _unresolved(self, time: Array) -> NDArray[np.bool_]:
        """Intervals of a clock in which the motion changes faster than its samples tell.

        Beside a dead position a group's determinant changes by much of itself from sample to sample; a piece of the
        prescribed motion may be over within a few samples; and a turn may have no more than a few.
        """
        found = self.on(Channel.POSITION)
        size = np.abs(found.determinants)
        sharp = np.abs(np.diff(found.determinants, axis=0)) > SHARP * np.minimum(size[1:], size[:-1])
        steps = np.flatnonzero(sharp.any(axis=1))
        reach = REACH * np.diff(found.time)[steps]
        spans = list(zip(found.time[steps] - reach, found.time[steps + 1] + reach, strict=True))
        drive = self.motion.scene.drive
        for segment in drive.motion.segments if isinstance(drive, Prescribed) else ():
            if np.count_nonzero((time >= segment.start) & (time <= segment.end)) < 2 * POINTS:
                spans.append((segment.start, segment.end))
        result = np.abs(np.diff(self.motion.crank(Channel.POSITION, time))) > COARSE
        for start, end in spans:
            result |= (time[:-1] <= end) & (time[1:] >= start)
        return result

    def crank_phase(self) -> Signal:
        """By how much the crank is, or by its own account must be, away from where it should be, rad."""
        drive, time = self.motion.scene.drive, self.motion.signal(Channel.POSITION).time
        if isinstance(drive, Prescribed):
            found = Signal(time, np.abs(self.motion.crank(Channel.POSITION, time) - drive.motion.angle(time)))
        else:
            found = self._released_phase()
        return Signal(found.time, np.maximum(found.values, self._missing()))

    def _missing(self) -> float:
        """Angle that the crank turns in the time a history leaves out at its start and its end, rad."""
        drive, history = self.motion.scene.drive, self.motion.history
        duration = drive.duration if isinstance(drive, Free) else drive.motion.duration
        signals = [getattr(history, c.value) for c in (*LEVELS, Channel.TORQUE)] + list(history.joint_force.values())
        left_out = 0.0
        for time in (signal.time for signal in signals if signal is not None):
            allowed = MISSING_STEPS * float(np.max(np.diff(time)))
            gap = max(float(time[0]), duration - float(time[-1]))
            left_out = max(left_out, 0.0 if gap <= allowed else gap)
        speed = self.motion.signal(Channel.VELOCITY).values[:, self.equations.numbers[self.motion.scene.crank], 2]
        return left_out * float(np.max(np.abs(speed)))

    def _released_phase(self) -> Signal:
        """∫ δE/(2T) ω dt, and how far the angle is from the integral of the speed."""
        motion, scene = self.motion, self.motion.scene
        time = motion.signal(Channel.TORQUE).time
        angle, speed = motion.crank(Channel.POSITION, time), motion.crank(Channel.VELOCITY, time)
        kinetic = 0.5 * np.einsum("nbk,bk->n", motion.on_clock(Channel.VELOCITY, time) ** 2, motion.masses)
        gained = self.energy_balance().values + self._start_excess(time[:1])
        gained = forgotten(gained, dissipation(motion, time) / (kinetic + TINY), time)
        share = gained / (2.0 * np.maximum(kinetic, np.abs(gained)) + TINY)
        crank = next(body for body in scene.bodies if body.name == scene.crank)
        turned = integral(Signal(time, speed), ())
        slip = np.abs(angle - crank.angle - crank.angular_velocity * time[0] - turned)
        slip = np.maximum(slip - doubt(Signal(time, speed), turned, ()), 0.0)
        return Signal(time, np.abs(integral(Signal(time, share * speed), ())) + slip)

    def _start_excess(self, first: Array) -> float:
        """Energy at the first sample's time (1,) beyond the start state's and the work done since, J."""
        scene, clock = self.motion.scene, np.zeros(1)
        position = np.array([[(*body.position, body.angle) for body in scene.bodies]])
        velocity = np.array([[(*body.velocity, body.angular_velocity) for body in scene.bodies]])
        start = ObservedMotion(scene, History(position=Signal(clock, position), velocity=Signal(clock, velocity)))
        work = float(first[0] * other_power(start, clock)[0])
        if isinstance(scene.drive, Free):
            work += scene.drive.torque * float(self.motion.crank(Channel.POSITION, first)[0] - scene.crank_angle)
        return float(self.energy(first)[0] - Inspection(start).energy(clock)[0]) - work
