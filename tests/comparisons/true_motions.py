"""What an engine without any error returns for a case, all samples at once, and the same with one thing wrong."""

import dataclasses

import numpy as np

from analytic.dynamics import reduced
from analytic.dynamics.joint_forces import joint_forces
from comparisons.stress.cell_result import Cell, blank_result
from comparisons.stress.verdict import judged
from engines.contract import History, Outcome, Run, Signal
from engines.scene import Channel, Free

EVERYTHING = frozenset(Channel)
CELL = Cell("axis", "row", 1.0, "engine", "tuned")


def true_history(case, count=1201, mechanism=None, lag=0.0):
    """The history of a case at ``count`` instants; by another mechanism, or with the crank behind by ``lag`` rad."""
    mechanism = mechanism or case.mechanism
    time = np.linspace(0.0, case.motion.duration, count)
    angle, speed = case.motion.angle(time) - lag, case.motion.speed(time)
    acceleration = case.motion.acceleration(time)
    sweep = mechanism.sweep(angle)
    states = np.stack(
        [_states(sweep, body.name, speed, acceleration) for body in case.scene(EVERYTHING).bodies], axis=2
    )
    torque = reduced.drive_torque(sweep, speed, acceleration)
    if isinstance(case.drive, Free):
        torque = np.full(count, case.drive.torque)
    forces = joint_forces(sweep, speed, acceleration)
    return History(
        *(Signal(time, part) for part in states),
        torque=Signal(time, torque),
        joint_force={name: Signal(time, np.array(force.T)) for name, force in forces.items()},
    )


def _states(sweep, name, speed, acceleration):
    """Position, velocity and acceleration of one body, (3, n, 3)."""
    full = 0.0 * speed
    place = np.stack([part + full for part in (*sweep.centre(name), np.unwrap(sweep.angles(name) + full))])
    first = np.stack([part + full for part in (*sweep.centre(name, 1), sweep.rates(name)[2])])
    second = np.stack([part + full for part in (*sweep.centre(name, 2), sweep.accelerations(name)[2])])
    return np.stack([place, first * speed, second * speed**2 + first * acceleration]).transpose(0, 2, 1)


def judgement(case, history, setting="tuned"):
    """What the stress maps make of a history that an engine calls finished."""
    return judged(
        blank_result(CELL, "m"),
        case,
        case.scene(EVERYTHING),
        Run(Outcome.FINISHED, history=history),
        setting,
    )


def with_signal(history, name, change):
    """A history with one signal's values changed: ``change(values, time)``."""
    signal = getattr(history, name)
    return dataclasses.replace(history, **{name: Signal(signal.time, change(signal.values.copy(), signal.time))})


def cut(history, kept):
    """A history with only those samples that ``kept(time)`` marks."""

    def short(signal):
        inside = kept(signal.time)
        return Signal(signal.time[inside], signal.values[inside])

    forces = {name: short(signal) for name, signal in history.joint_force.items()}
    signals = {name: short(getattr(history, name)) for name in ("position", "velocity", "acceleration", "torque")}
    return History(**signals, joint_force=forces)
