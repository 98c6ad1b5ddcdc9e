"""Invariants of any true motion, checked on the engine's own motion without the closed form, as records of their own.

So a wrong motion is caught even where no reference exists. For a linkage of one degree of freedom these checks are
complete: what passes them all is the motion of the scene, short of what their limits let through.

- *Positions.* A crank angle and the assembly mode of every Assur group fix all positions. ``crank_phase`` holds the
  crank to the angle its drive prescribes, ``closure`` the bodies to the joints at that angle, not by how far a joint is
  open but by how far a body is off because of it, which near a dead position is much more. ``assembly_mode`` holds
  each group to the mode it starts in: its equations' determinant changes sign where the other one is entered.
- *Velocities and accelerations* are fixed by the positions and the crank's: ``closure`` on the next two levels.
- *Torque and joint forces* are fixed by those and the loads, standstill included: ``torque_two_routes`` and
  ``force_balance``, within limits that let weights pass beside forces of inertia. ``weight_on_frame`` has the weight by
  itself: over a whole turn at constant speed the momentum comes back, so the frame carries the linkage's weight and
  what else loads it, however fast the crank.
- *A released crank* obeys φ' = ω, ω' = ε and the equation of motion for ε: ``crank_phase``, ``closure`` and
  ``torque_two_routes`` hold it to each. What each of them lets through adds up over turns, but moves the energy: δE in
  it makes δE/2T of the speed, and ``crank_phase`` is what that has come to, beside what ω does not integrate to. (On
  its way past an unstable equilibrium an error of phase grows as in any true motion, and no balance tells how far.)
- Samples half a turn apart show no motion, and ``crank_phase`` says so. What they leave out of their own steps is seen
  before anything is judged (``comparisons.trials.runs.run_engine``).

``energy_balance`` and ``joint_gap`` say nothing beyond these for a prescribed motion. The joints' equations and the
loads are those of ``engines.mechanics``, shared with ``direct``: no formula is shared with the closed form. A check
whose channels were not recorded is left to ``checks`` to refuse; its function raises AssertionError.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from analytic.description.crank_motion import degrees
from analytic.description.law import FULL_TURN
from analytic.description.linkage import GROUND
from analytic.kinematics.mechanism import Mechanism
from analytic.kinematics.structure import ClosedGroup
from analytic.numerics.arrays import Array
from comparisons.motion.case import Case
from comparisons.trials.invariants.inspection import TINY, AssurGroup, Inspection, speed_errors, undissipated_error
from comparisons.trials.judging.limits import judge
from comparisons.trials.judging.quantities import UNBOUNDED, has_two_values
from comparisons.trials.judging.records import Error, Verdict
from comparisons.trials.observed_motion import (
    DENSE,
    ObservedMotion,
    error_bound,
    error_estimate,
    integral,
    is_off_jumps,
    resample_piecewise,
)
from engines.contract import History, Signal
from engines.mechanics.joints import applied_loads
from engines.mechanics.states import start_coordinate, start_motion
from engines.scene import LEVELS, Channel, Free, Prescribed

ROUNDING = 1e-9  # of the time of a turn
MEAN_POINTS = 10  # of the polynomials through a force: at 6 its mean over a hundred samples is off by 1e-6
HALF_TURN = np.pi  # rad between two samples: beyond it they show no motion


def energy(motion: ObservedMotion, time: Array) -> Array:
    """Kinetic plus potential energy, T + V, J, at these times, s; shape of the times."""
    return motion.kinetic_energy(time) + motion.potential_energy(time)


def energy_scale(motion: ObservedMotion) -> float:
    """The scale of energy errors, J: the sum of peak kinetic energy, potential range and other loads' work.

    The work is the largest of loads without a potential, from the first sample on.
    """
    time = motion.signal(Channel.POSITION).time
    work = integral(Signal(time, motion.load_power(time)), ())
    stored = np.ptp(motion.potential_energy(time))
    return float(np.max(motion.kinetic_energy(motion.signal(Channel.VELOCITY).time)) + stored + np.max(np.abs(work)))


@dataclass(frozen=True)
class Balance:
    """What a balance that should be 0 gains at the samples of a clock, with an estimate and a bound of its error.

    All are (n,); ``time`` is in s, the others are in the balance's unit.
    """

    time: Array
    gained: Array
    error_estimate: Array
    error_bound: Array

    @property
    def excess(self) -> Array:
        """The gain (n,) beyond the error bound, with its sign, which certainly has no source."""
        return np.asarray(np.sign(self.gained) * np.maximum(np.abs(self.gained) - self.error_bound, 0.0))


def energy_balance(inspection: Inspection) -> Balance:
    """T + V − (T + V)₀ − ∫ (Mkr ω + loads) dt on the torque's clock, J.

    The error is that of the quadrature and, where the motion changes within a sample or two, all that changes there.
    """
    motion, drive = inspection.motion, inspection.motion.scene.drive
    torque = motion.signal(Channel.TORQUE)
    time = torque.time
    power, done = motion.load_power(time), np.zeros(len(time))
    if isinstance(drive, Prescribed):
        power = power + torque.values * motion.crank(Channel.VELOCITY, time)
    else:  # a constant torque does its work by the angle alone
        angle = motion.crank(Channel.POSITION, time)
        done = drive.torque * (angle - angle[0])
        if drive.over_time is not None:
            power = power + drive.over_time(time) * motion.crank(Channel.VELOCITY, time)
    work = integral(Signal(time, power), motion.jumps)
    stored = energy(motion, time) - done
    swing = np.abs(np.diff(stored)) + np.abs(np.diff(work))
    unresolved = np.concatenate([[0.0], np.cumsum(np.where(inspection.unresolved_intervals(time), swing, 0.0))])
    errors = (error(Signal(time, power), work, motion.jumps) + unresolved for error in (error_estimate, error_bound))
    return Balance(time, stored - stored[0] - work, *errors)


def angle_error_from_energy(inspection: Inspection) -> Signal:
    """An upper estimate of a released crank's angle error, rad, on the torque's clock.

    It is ∫ δE/(2T) ω dt for energy without a source, plus the angle's difference from the integral of the speed.
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
    """Energy of the first sample beyond that of the start state and the work since, J.

    ``first`` (1,) is its time, s.
    """
    scene, clock = motion.scene, np.zeros(1)
    position, velocity = (np.asarray(part[:, :-1], dtype=float) for part in start_motion(scene)[:2])
    start = ObservedMotion(scene, History(position=Signal(clock, position), velocity=Signal(clock, velocity)))
    work = float(first[0] * start.load_power(clock)[0])
    if isinstance(scene.drive, Free):
        travel = float(motion.crank(Channel.POSITION, first)[0]) - start_coordinate(scene)
        work += float(scene.drive.torque_at(0.0)) * travel
    return float(energy(motion, first)[0] - energy(start, clock)[0]) - work


def speed_drift(inspection: Inspection) -> Signal:
    """Crank speed less that from the start state and the claimed acceleration, and less its error, over its peak.

    It is never negative, on the clock of the velocities, which 0 s precedes if they begin later.
    """
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


def joint_gaps(motion: ObservedMotion) -> Signal:
    """Largest opening of any joint, m, at the positions' times: pins apart, sliders and slot pins off their line."""
    time = motion.signal(Channel.POSITION).time
    return Signal(time, np.max(list(motion.joint_gaps(time).values()), axis=0))


def closure(inspection: Inspection) -> dict[str, Signal]:
    """``Inspection.corrections`` by level and, for a released crank, ``drift``: speed against acceleration.

    Keys are "position", "velocity", "acceleration" and "drift", which is ``speed_drift``.
    """
    drift = {"drift": speed_drift(inspection)} if isinstance(inspection.motion.scene.drive, Free) else {}
    return inspection.corrections() | drift


def crank_phase(inspection: Inspection) -> Signal:
    """The driver's distance, rad or m, from its true motion, at each sample; never negative.

    It is no less than the largest angle between two samples, where that is over half a turn.
    """
    drive, time = inspection.motion.scene.drive, inspection.motion.signal(Channel.POSITION).time
    if isinstance(drive, Prescribed):
        signal = Signal(time, np.abs(inspection.motion.crank(Channel.POSITION, time) - drive.motion.angle(time)))
    else:
        signal = angle_error_from_energy(inspection)
    return Signal(signal.time, np.maximum(signal.values, _largest_gap(inspection)))


def _largest_gap(inspection: Inspection) -> float:
    """Largest way of the driver between two samples, rad or m, of any signal; 0 if no more than half a turn.

    Of a linear drive half a turn counts as π times the scene's size.
    """
    motion = inspection.motion
    signals = [motion.signal(channel) for channel in (*LEVELS, Channel.TORQUE) if motion.has(channel)]
    clocks = [signal.time for signal in (*signals, *motion.history.joint_force.values())]
    turned = max(float(np.max(np.abs(np.diff(motion.crank(Channel.POSITION, time))))) for time in clocks)
    return turned if turned > HALF_TURN * inspection.radian else 0.0


def steady_turn(motion: ObservedMotion) -> tuple[float, float] | None:
    """Start and end, s, of a turn in the middle of the last piece at constant speed that has one.

    None without one, as for a released crank or a linear drive. In the middle there are samples on both sides, and what
    a jump before the piece has stirred up has died down.
    """
    drive, found = motion.scene.drive, None
    if motion.is_linear or isinstance(drive, Free):
        return None
    for segment in drive.motion.segments:
        speed, *rates = (*segment.coefficients[1:], 0.0)
        turn = FULL_TURN / abs(speed) if speed and not any(rates) else np.inf
        if turn <= (segment.end - segment.start) * (1.0 + ROUNDING):
            middle = 0.5 * (segment.start + segment.end)
            found = (middle - 0.5 * turn, middle + 0.5 * turn)
    return found


def total_weight(motion: ObservedMotion) -> float:
    """Weight of all bodies, N."""
    return float(np.sum(motion.masses[:, 0]) * np.hypot(*motion.scene.gravity))


def weight_on_frame(inspection: Inspection) -> Balance:
    """Size of the mean force, N, of the frame's joints, weights and loads on the linkage in a turn at constant speed.

    One value, at the middle of the turn, 0 in a true motion; its error is the change that every other sample makes,
    infinite for too few samples. Raises AssertionError without a ``steady_turn``.
    """
    motion, turn = inspection.motion, steady_turn(inspection.motion)
    assert turn is not None
    clocks = (motion.signal(Channel.POSITION).time, *(force.time for force in motion.history.joint_force.values()))
    samples = min(np.count_nonzero((clock >= turn[0]) & (clock <= turn[1])) for clock in clocks)
    count = max(int(samples), DENSE)
    time = turn[0] + (turn[1] - turn[0]) * (np.arange(count) + 0.5) / count  # not at the ends, where a jump may be
    mean, error = _mean_force(motion, time), np.inf
    if samples >= DENSE and not inspection.unresolved_intervals(time).any():
        error = float(np.hypot(*(mean - _mean_force(_with_every_other_sample(motion), time))))
    return Balance(np.array([np.mean(turn)]), np.array([np.hypot(*mean)]), np.array([error]), np.array([error]))


def _mean_force(motion: ObservedMotion, time: Array) -> Array:
    """The mean over these times, s, of all forces on the bodies from outside, the frame's joints included, (2,), N."""
    scene = motion.scene
    loads = applied_loads(scene, motion.pose(time), motion.bodies(Channel.VELOCITY, time))[:, :-1, :2]
    total = np.mean(np.sum(loads, axis=1), axis=0)
    for joint in scene.joints:
        first, second = dict(joint.ends)
        if GROUND in (first, second):
            read = motion.history.joint_force[joint.name]
            clear = is_off_jumps(read.time, motion.jumps)
            force = resample_piecewise(Signal(read.time[clear], read.values[clear]), time, motion.jumps, MEAN_POINTS)
            total = total + np.mean(force, axis=0) * (-1.0 if first == GROUND else 1.0)
    return np.asarray(total)


def _with_every_other_sample(motion: ObservedMotion) -> ObservedMotion:
    """A copy of the motion with every second sample of positions, velocities and joint forces, and nothing else."""

    def half(signal: Signal) -> Signal:
        """Every second sample of a signal, the first included."""
        return replace(signal, time=signal.time[::2], values=signal.values[::2])

    kept = {*LEVELS[:2], Channel.JOINT_FORCE}
    halves = {key: half(signal) for key, signal in motion.history.signals.items() if key[0] in kept}
    return replace(motion, history=History.of(halves))


Found = tuple[Signal | Balance, float, int]  # what should be zero, over what scale, and the samples that it might have


@dataclass(frozen=True)
class Invariant:
    """What an invariant ``needs`` of a history, the ``unit`` of its scale, and how it is ``found``.

    ``found(case, inspection)`` gives a ``Found``: what should be zero, its scale in ``unit``, and the number of samples
    that the engine has. ``is_balance``: of masses and loads, so that without them it says nothing, and friction is no
    part of it. ``linear_unit`` is that of a pushed driver, "" for the same.
    """

    needs: tuple[Channel, ...]
    found: Callable[[Case, Inspection], Found]
    unit: str = ""
    linear_unit: str = ""  # of a driver that is pushed, if another
    is_balance: bool = False

    @property
    def of_forces(self) -> bool:
        """Whether it needs the force of every joint."""
        return Channel.JOINT_FORCE in self.needs


def _samples(inspection: Inspection, channel: Channel = Channel.POSITION) -> int:
    """The number of samples that the engine has of a channel."""
    return len(inspection.motion.signal(channel).time)


def _joint_gap(case: Case, inspection: Inspection) -> Found:
    """The largest opening of any joint, m, its scale, the linkage's shortest length, m, and its number of samples."""
    return joint_gaps(inspection.motion), case.mechanism.linkage.shortest_length(), _samples(inspection)


def _closure(case: Case, inspection: Inspection) -> Found:
    """The corrections of all levels in one signal, their scale, 1, and the number of samples.

    Samples beside change points are left out, and those of accelerations at jumps.
    """
    levels = closure(inspection)
    count = sum(len(signal.time) for signal in levels.values())
    levels[Channel.ACCELERATION.value] = _without_jumps(case, levels[Channel.ACCELERATION.value])
    signals = [_without_change_points(inspection, signal) for signal in levels.values()]
    time, values = (np.concatenate([getattr(signal, part) for signal in signals]) for part in ("time", "values"))
    return Signal(time, values), 1.0, count


def _torque_two_routes(case: Case, inspection: Inspection) -> Found:
    """The torque required by the motion less the engine's, N m, its scale, N m, and its number of samples; N if linear.

    Over change points it is bridged by a smooth curve; samples at jumps of the acceleration are left out.
    """
    motion, bridged = inspection.motion, inspection.bridge_changes(inspection.torque_required(), case.motion.jumps)
    required = _without_jumps(case, bridged)
    routes = Signal(required.time, required.values - motion.on_clock(Channel.TORQUE, required.time))
    return routes, _torque_scale(case, motion), _samples(inspection, Channel.ACCELERATION)


def _force_balance(case: Case, inspection: Inspection) -> Found:
    """The imbalance of joint forces over their peak, its scale 1 and its number of samples, those at jumps left out."""
    return _without_jumps(case, inspection.force_balance()), 1.0, _samples(inspection, Channel.ACCELERATION)


# The joints' equations are looked at level by level.
INVARIANTS: Mapping[str, Invariant] = {
    "joint_gap": Invariant(LEVELS[:1], _joint_gap, "m"),
    "closure": Invariant(LEVELS, _closure),
    "assembly_mode": Invariant(LEVELS[:1], lambda _, seen: (seen.assembly_mode(), 1.0, _samples(seen))),
    "crank_phase": Invariant(
        LEVELS[:2], lambda _, seen: (crank_phase(seen), seen.radian, _samples(seen)), "rad", linear_unit="m"
    ),
    "energy_balance": Invariant(
        (*LEVELS[:2], Channel.TORQUE),
        lambda _, seen: (energy_balance(seen), energy_scale(seen.motion), _samples(seen, Channel.TORQUE)),
        "J",
        is_balance=True,
    ),
    "torque_two_routes": Invariant(
        (*LEVELS, Channel.TORQUE), _torque_two_routes, "N m", linear_unit="N", is_balance=True
    ),
    "force_balance": Invariant((*LEVELS, Channel.JOINT_FORCE), _force_balance, is_balance=True),
    "weight_on_frame": Invariant(
        (*LEVELS[:2], Channel.JOINT_FORCE),
        lambda _, seen: (weight_on_frame(seen), total_weight(seen.motion), 1),
        "N",
    ),
}
LARGEST = 1e150  # however far off a motion is, its square is a number


def checks(case: Case, motion: ObservedMotion, blank: Error) -> tuple[Error, ...]:
    """The judged records of all invariants that apply; one that lacks a channel, or says nothing here, has the reason.

    ``blank`` has the fields that all share. Those of forces apply where the scene has that channel, ``weight_on_frame``
    where there are weights and a turn at constant speed.
    """
    return tuple(_each_check(case, motion, blank))


def _each_check(case: Case, motion: ObservedMotion, blank: Error) -> Iterator[Error]:
    """Yield the records of ``checks``, a record for each invariant that applies."""
    inspection = Inspection(motion, assur_groups(case.mechanism))
    weighs = steady_turn(motion) is not None and total_weight(motion) > 0.0
    for name, invariant in INVARIANTS.items():
        if invariant.of_forces and Channel.JOINT_FORCE not in motion.scene.channels:
            continue
        if name == "weight_on_frame" and not weighs:
            continue
        lacking = _missing_channels(motion, invariant)
        unit = (invariant.linear_unit if motion.is_linear else "") or invariant.unit
        record = blank._replace(quantity=name, unit=unit)
        if lacking:
            yield record._replace(outcome=Verdict.NOT_PROVIDED.value, detail=f"{blank.engine} offers no {lacking}")
        elif invariant.of_forces and case.unbounded_at is not None:
            yield _undefined(record, UNBOUNDED.format(angle=degrees(case.unbounded_at)))
        elif name == "weight_on_frame" and case.mechanism.linkage.has_one_way_loads:
            yield _undefined(record, "a load that acts one way alone jumps between samples: no mean is exact")
        elif (invariant.is_balance or invariant.of_forces) and motion.scene.friction:
            yield _undefined(record, "friction by the joints' own forces is no part of the balance")
        elif invariant.is_balance and case.mechanism.linkage.is_idle:
            yield _undefined(record, "no link has a mass and nothing loads one: there is nothing to balance")
        else:
            record = record._replace(origin=blank.origin or motion.origin(invariant.needs).value)
            found, scale, total = invariant.found(case, inspection)
            if isinstance(found, Balance):
                yield _judge_balance(case, record._replace(peak=scale), found)
            else:
                yield _judge_signal(record, found, scale, total)


def assur_groups(mechanism: Mechanism) -> list[AssurGroup]:
    """The Assur groups of a linkage, in an order in which they can be solved, without massless sliders of slots.

    The groups follow from the joints alone; their change points follow from lengths, and only groups that are solved
    in closed form have any.
    """
    groups, links = list[AssurGroup](), mechanism.linkage.links
    for group in mechanism.structure.groups:
        known = group.changes if isinstance(group, ClosedGroup) else None
        angles = {round(angle % FULL_TURN, 8) % round(FULL_TURN, 8) for angle in (known.angles if known else ())}
        groups.append(AssurGroup(tuple(name for name in group.links if name in links), tuple(sorted(angles))))
    return groups


def _missing_channels(motion: ObservedMotion, invariant: Invariant) -> str:
    """What an invariant needs and the engine has not recorded, in words; "" if all is there.

    That is channels, or directions of joint forces.
    """
    lacking = [channel.value for channel in invariant.needs if not motion.has(channel)]
    if invariant.of_forces and not lacking:
        forces, joints = motion.history.joint_force, motion.scene.joints
        if not all(joint.name in forces and forces[joint.name].values.ndim > 1 for joint in joints):
            return "direction of joint forces"
    return ", ".join(lacking)


def _torque_scale(case: Case, motion: ObservedMotion) -> float:
    """The scale of torque errors, N m or N: the peak drive torque, or a released crank's peak of Jeq ε if larger."""
    peak = float(np.max(np.abs(motion.signal(Channel.TORQUE).values)))
    if case.is_prescribed:
        return peak
    time = motion.signal(Channel.VELOCITY).time
    speed = motion.crank(Channel.VELOCITY, time)
    fast = np.abs(speed) >= case.least_speed
    inertia = 2.0 * motion.kinetic_energy(time)[fast] / speed[fast] ** 2
    return max(peak, float(np.max(np.abs(inertia * motion.crank(Channel.ACCELERATION, time)[fast]))))


def _without_jumps(case: Case, signal: Signal) -> Signal:
    """A signal without its samples at jumps of the acceleration or of loads, where the true value is not unique."""
    smooth = ~has_two_values(case, signal.time)
    return Signal(signal.time[smooth], signal.values[smooth])


def _without_change_points(inspection: Inspection, signal: Signal) -> Signal:
    """A signal without its samples beside change points, where corrections are their own rounding magnified."""
    smooth = ~inspection.beside_changes(signal.time).any(axis=1)
    return Signal(signal.time[smooth], signal.values[smooth])


def _judge_signal(blank: Error, signal: Signal, scale: float, total: int) -> Error:
    """The judged record of a signal (n,) that should be zero, relative to a scale; ``total`` counts all samples.

    The scale is in the signal's unit; 0 counts as 1. Samples without a value, nan, are left out. Without a single value
    nothing is judged, and nothing has passed: it is UNDEFINED. Fields that are not found here are those of ``blank``.
    """
    defined = ~np.isnan(signal.values)
    time, relative = signal.time[defined], np.minimum(np.abs(signal.values[defined]) / (scale or 1.0), LARGEST)
    record = blank._replace(peak=scale, samples=len(relative), left_out=total - len(relative))
    if not len(relative):
        return _undefined(record, "no sample has a value to judge, as in a linkage that starts at a dead position")
    worst = int(np.argmax(relative))
    return judge(
        record._replace(
            error_max=float(relative[worst]),
            error_rms=float(np.sqrt(np.mean(relative**2))),
            worst_time=float(time[worst]),
        )
    )


def _judge_balance(case: Case, blank: Error, balance: Balance) -> Error:
    """The record of a balance over its scale, the ``blank`` record's peak: what is gained, or its error estimate.

    A gain over the limit by more than its error bound fails; one over the limit by less is undefined, and so is one
    without an error estimate.
    """

    def check(values: Array) -> Error:
        """The judged record of these values on the balance's clock."""
        return _judge_signal(
            blank, _without_jumps(case, Signal(balance.time, values)), blank.peak or 1.0, len(balance.time)
        )

    certain = check(balance.excess)
    if certain.outcome != Verdict.PASSED or not np.all(np.isfinite(balance.error_estimate)):
        reason = "too few samples for an error estimate of the balance"
        return certain if certain.outcome != Verdict.PASSED else _undefined(certain._replace(error_max=None), reason)
    possible = check(np.maximum(np.abs(balance.gained), balance.error_estimate))
    error, bound = possible.error_max, possible.limit
    if error is None or bound is None or error <= bound:
        return possible
    scale = "weight" if blank.quantity == "weight_on_frame" else "energy scale"
    reason = f"its own error estimate, {error:.2g} of the {scale}, is over the limit {bound:.2g}: use more samples"
    return _undefined(possible, reason)


def _undefined(record: Error, reason: str) -> Error:
    """A copy of a record with the outcome undefined, for a reason in words, its ``detail``."""
    return record._replace(outcome=Verdict.UNDEFINED.value, detail=reason)
