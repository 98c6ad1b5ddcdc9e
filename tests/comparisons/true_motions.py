"""The history of an engine without any error, all samples at once, and the same with one fault."""

import dataclasses

import numpy as np

from analytic.dynamics import reduced
from analytic.dynamics.joint_forces import reactions
from comparisons.motion.case import Case
from comparisons.trials.observed_motion import ObservedMotion
from comparisons.trials.stress.cells import Cell, judged
from engines.contract import History, Outcome, Run, Signal
from engines.mujoco_adapter import MujocoEngine
from engines.scene import Channel, Free

EVERYTHING = frozenset(Channel)


def true_history(case, count=1201, mechanism=None, lag=0.0, shift=0.0):
    """The history of a case at ``count`` instants.

    By another ``mechanism``, with the crank behind by ``lag`` rad, or with velocities ``shift`` steps later than the
    rest, as a leapfrog method has them.
    """
    mechanism = mechanism or case.mechanism
    time = np.linspace(0.0, case.motion.duration, count)
    later = np.clip(time[:-1] + shift * time[1], 0.0, case.motion.duration) if shift else time
    speed, acceleration = case.motion.speed(time), case.motion.acceleration(time)
    sweep = mechanism.sweep(case.motion.angle(time) - lag)
    moving = mechanism.sweep(case.motion.angle(later) - lag) if shift else sweep
    names = [body.name for body in case.scene(EVERYTHING).bodies]
    torque = reduced.drive_torque(sweep, speed, acceleration)
    if isinstance(case.drive, Free):
        torque = np.full(count, case.drive.torque)
    forces = reactions(sweep, speed, acceleration).forces
    return History(
        position=Signal(time, np.stack([_position(sweep, name, time) for name in names], axis=1)),
        velocity=Signal(later, np.stack([_rates(moving, name, case.motion.speed(later)) for name in names], axis=1)),
        acceleration=Signal(time, np.stack([_rates(sweep, name, acceleration, speed**2) for name in names], axis=1)),
        torque=Signal(time, torque),
        joint_force={name: Signal(time, np.array(force.T)) for name, force in forces.items()},
    )


def perfect_motion(mechanism, motion, samples=1401, shift=0.0):
    """The true motion of a linkage under a motion of its crank, as an engine without any error returns it."""
    case = Case(mechanism, motion)
    return ObservedMotion(case.scene(EVERYTHING), true_history(case, samples, shift=shift))


def _position(sweep, name, time):
    """Position and angle of one body, (n, 3)."""
    full = 0.0 * time
    return np.stack([part + full for part in (*sweep.centre(name), np.unwrap(sweep.angles(name) + full))], axis=1)


def _rates(sweep, name, rate, squared=None):
    """Velocity of one body at the crank's speed ``rate``, or acceleration at its acceleration and speed squared."""
    first = [part * rate for part in (*sweep.centre(name, 1), sweep.rates(name)[2])]
    if squared is not None:
        second = (*sweep.centre(name, 2), sweep.accelerations(name)[2])
        first = [part + other * squared for part, other in zip(first, second, strict=True)]
    return np.stack(first, axis=1)


def cell(value=1.0, *, mechanism="m", axis="axis", row="row", engine="engine", usage="tuned", **known):
    """A cell of a stability map, as it is before its run but for what is ``known``."""
    return Cell(mechanism, "", "", "", engine, "", usage, axis=axis, row=row, value=value, **known)


def judgement(case, history, setting="tuned"):
    """What the stress maps make of a history that an engine calls finished."""
    run = Run(Outcome.FINISHED, history=history)
    return judged(cell(usage=setting), case, case.scene(EVERYTHING), run, MujocoEngine())


def alarms(found):
    """Names of the checks that failed in a cell."""
    return tuple(check.quantity for check in found.invariants if check.outcome != "passed")


def with_signal(history, name, change):
    """A history with one signal's values changed: ``change(values, time)``."""
    signal = getattr(history, name)
    return dataclasses.replace(history, **{name: Signal(signal.time, change(signal.values.copy(), signal.time))})


def cut(history, kept):
    """A history with only those samples that ``kept(time)`` marks."""

    def short(signal):
        inside = kept(signal.time)
        return Signal(signal.time[inside], signal.values[inside])

    return History.of({key: short(signal) for key, signal in history.signals.items()})
