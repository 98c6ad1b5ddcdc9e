"""Engines that are right but for one thing, each made of the direct solution."""

import ctypes
import itertools
import math
import os
import sys
from dataclasses import replace
from functools import lru_cache

import numpy as np

from engines.contract import Abilities, History, Outcome, Run, Setting
from engines.direct_adapter.adapter import DirectEngine
from engines.scene import AppliedForce, Channel, Free, Prescribed, SlotJoint


class Direct(DirectEngine):
    """The direct solution; each run of a scene is made once."""

    def run(self, scene, setting):
        return _run(scene, setting)


@lru_cache(maxsize=256)
def _run(scene, setting):
    return DirectEngine().run(scene, setting)


class AlterableEngine(Direct):
    """The direct solution of whatever world it is given: the right engine, with a hook for mutants."""

    def altered(self, scene):
        return scene

    def run(self, scene, setting):
        return super().run(self.altered(scene), setting)


class BlindEngine(AlterableEngine):
    """Torque and forces are those of the given scene, whatever world it has."""

    abilities = replace(
        DirectEngine.abilities,
        readouts={c: r for c, r in DirectEngine.abilities.readouts.items() if c is not Channel.JOINT_FORCE},
    )

    def run(self, scene, setting):
        run, given = super().run(scene, setting), DirectEngine.run(self, scene, setting)
        return replace(run, history=replace(given.history, joint_force={})) if given.history else run


class BrokenEngine(Direct):
    """No run of it finishes."""

    def run(self, scene, setting):
        return Run(Outcome.DIVERGED, "the start is not solved")


class DyingEngine(Direct):
    """A mass that is no number brings the process down."""

    def run(self, scene, setting):
        if np.isnan(scene.bodies[0].mass):
            os.abort()
        return super().run(scene, setting)


class PrintingEngine(Direct):
    """It prints."""

    def run(self, scene, setting):
        sys.stdout.write("stepping\n")
        return super().run(scene, setting)


class NarrowEngine(Direct):
    """Right, and of few abilities: prescribed drives, pins, gravity and constant forces, magnitudes of joint forces."""

    abilities = Abilities(
        readouts=DirectEngine.abilities.readouts,
        drives=frozenset({Prescribed}),
        joints=frozenset(),
        loads=frozenset({AppliedForce}),
        varying_loads=False,
        settings=frozenset({Setting.TUNED}),
    )

    def run(self, scene, setting):
        if setting is not Setting.TUNED:
            return Run(Outcome.UNSUPPORTED, "one setting")
        loads = (*scene.torques, *scene.springs, *scene.dampers, *(f for f in scene.forces if not f.force.is_constant))
        if scene.guided or scene.cylinder or loads or scene.friction or isinstance(scene.drive, Free):
            return Run(Outcome.UNSUPPORTED, "too much")
        run = super().run(scene, setting)
        if run.history is None:
            return run
        forces = {n: replace(s, values=np.hypot(*s.values.T)) for n, s in run.history.joint_force.items()}
        return replace(run, history=replace(run.history, joint_force=forces))


class Changed(Direct):
    """The direct solution, its run replaced by ``change(run, scene, setting)``; abilities may be others."""

    def __init__(self, change=lambda run, *_: run, **abilities):
        self.change, self.abilities = change, replace(DirectEngine.abilities, **abilities)

    def run(self, scene, setting):
        return self.change(super().run(scene, setting), scene, setting)


def misread(change):
    """The direct solution, its history replaced by ``change(history, scene)``."""
    return Changed(lambda run, scene, _: replace(run, history=change(run.history, scene)) if run.history else run)


def in_setting(setting, change):
    """The direct solution, its run replaced by ``change(run)`` in one setting."""
    return Changed(lambda run, _, used: change(run) if used is setting else run)


def _careless(run, *_):
    """Bad data are taken for good ones."""
    return replace(run, outcome=Outcome.FINISHED, history=History()) if run.outcome is Outcome.DIVERGED else run


def _raising(run, scene, _):
    if np.isnan(scene.bodies[0].mass):
        raise ValueError("mass")
    return run


def _chattering(run, *_):
    """Its C code prints."""
    ctypes.CDLL(None).puts(b"stepping")
    return run


def _shaking():
    """A change by which two runs differ in the last digits."""
    counts = itertools.count(1)

    def change(run, *_):
        factor = 1.0 + 1e-14 * next(counts)
        if run.history is None or run.history.torque is None:
            return run
        torque = run.history.torque
        return replace(run, history=replace(run.history, torque=replace(torque, values=factor * torque.values)))

    return change


def _generous(_run, scene, setting):
    """Positions come whether they are requested or not."""
    return Direct().run(replace(scene, channels=scene.channels | {Channel.POSITION}), setting)


def _fickle(run, scene, _):
    """The steps depend on what is recorded."""
    return replace(run, steps=run.steps + len(scene.channels))


def _sulking(run, scene, _):
    """A refused scene is refused without a reason."""
    return Run(Outcome.UNSUPPORTED) if scene.sliders or scene.slots else run


def _of_two_runs(run):
    """Several runs make what is labelled as read."""
    return replace(run, passes=(1.0, 0.5))


def of(channel, change):
    """One channel of the bodies, or the torque, changed: ``change(values, scene)`` in place, if it was requested."""

    def changed(history, scene):
        signal = getattr(history, channel)
        if signal is None:
            return history
        values = signal.values.copy()
        change(values, scene)
        return replace(history, **{channel: replace(signal, values=values)})

    return misread(changed)


def force_of(joint_number, change):
    """The force of one joint changed: ``change(values, history, scene)`` gives others."""

    def changed(history, scene):
        if not history.joint_force or history.position is None:
            return history
        name = list(history.joint_force)[joint_number]
        signal = history.joint_force[name]
        forces = {**history.joint_force, name: replace(signal, values=change(signal.values, history, scene))}
        return replace(history, joint_force=forces)

    return misread(changed)


def sampled(channel, change):
    """Times and values of a channel changed: ``change(signal)`` gives another signal."""

    def changed(history, scene):
        signal = getattr(history, channel)
        return replace(history, **{channel: change(signal)}) if signal is not None else history

    return misread(changed)


def at(samples):
    """A signal's samples of these numbers."""
    return lambda signal: replace(signal, time=signal.time[samples(signal)], values=signal.values[samples(signal)])


def late(samples):
    """Every value so many samples before its time, by straight lines between them."""

    def changed(signal):
        flat, number = signal.values.reshape(len(signal.time), -1), np.arange(len(signal.time))
        values = np.column_stack([np.interp(number - samples, number, column) for column in flat.T])
        return replace(signal, values=values.reshape(signal.values.shape))

    return changed


def _degrees(values, scene):
    values[..., 2] *= 180.0 / np.pi


def _places_in_mm(values, scene):
    values[..., :2] *= 1e3


def _wrapped(values, scene):
    values[..., 2] = (values[..., 2] + np.pi) % (2.0 * np.pi) - np.pi


def _exchanged(values, scene):
    values[..., :2] = values[..., 1::-1]


def _of_the_pivot(values, scene):
    """The last body by the pin that it has with another."""
    pin = next(p for p in scene.pins if p.first == scene.bodies[-1].name)
    x, y = pin.first_anchor
    c, s = np.cos(values[:, -1, 2]), np.sin(values[:, -1, 2])
    values[:, -1, 0] += c * x - s * y
    values[:, -1, 1] += s * x + c * y


def _one_angle_mirrored(values, scene):
    values[:, -1, 2] *= -1.0


def _with_gravity(values, scene):
    values[..., :2] -= scene.gravity


def _times(factor):
    def changed(values, scene):
        values *= factor

    return changed


def _without_the_crank(values, scene):
    """The crank turns about its pivot: its torque is (J + m r²) φ'' less the moment of its weight."""
    if isinstance(scene.drive, Free) or scene.cylinder or (scene.sliders and scene.sliders[0].body == scene.crank):
        return
    crank = next(body for body in scene.bodies if body.name == scene.crank)
    pin = next(p for p in scene.pins if {p.first, p.second} == {scene.crank, "ground"})
    x, y = pin.first_anchor if pin.first == scene.crank else pin.second_anchor
    time = np.linspace(0.0, scene.drive.motion.duration, len(values))
    angle, second = scene.drive.motion.angle(time), scene.drive.motion.acceleration(time)
    turned = angle - angle[0] + crank.angle
    arm = -np.column_stack([np.cos(turned) * x - np.sin(turned) * y, np.sin(turned) * x + np.cos(turned) * y])
    inertia = crank.inertia + crank.mass * math.hypot(x, y) ** 2
    gx, gy = scene.gravity
    values -= inertia * second - crank.mass * (arm[:, 0] * gy - arm[:, 1] * gx)


def _first_at_rest(values, scene):
    """The bodies rest at the first instant, as if their start velocities had been forgotten."""
    if isinstance(scene.drive, Prescribed):
        values[0] = 0.0


def _first_late(values, scene):
    """The first torque is that of half a step later."""
    values[0] = 0.5 * (values[0] + values[1])


def _doubled_where_parts_meet(values, scene):
    """One torque of the sample where the ramp ends is twice as large."""
    segments = scene.drive.motion.segments if isinstance(scene.drive, Prescribed) else ()
    if len(segments) == 2:
        values[round((len(values) - 1) * segments[1].start / segments[1].end)] *= 2.0


def _in_the_body(values, history, scene):
    """The second joint's force, in the frame of its first body."""
    joint = list(history.joint_force)[1]
    first = next(pin.first for pin in scene.pins if pin.name == joint)
    angle = history.position.values[:, [body.name for body in scene.bodies].index(first), 2]
    c, s = np.cos(angle), np.sin(angle)
    return np.column_stack([c * values[:, 0] + s * values[:, 1], c * values[:, 1] - s * values[:, 0]])


# By fault: an engine that has it, the check that must fail, and words that its message must contain.
WRONG = {
    "places in mm": (of("position", _places_in_mm), "positions", "in mm"),
    "angles in degrees": (of("position", _degrees), "positions", "in degrees"),
    "angles wrapped": (of("position", _wrapped), "positions", "not unwrapped"),
    "x and y exchanged": (of("velocity", _exchanged), "velocities", "x and y are exchanged"),
    "the pivot's place": (of("position", _of_the_pivot), "positions", "the point in joint"),
    "an angle mirrored": (of("position", _one_angle_mirrored), "positions", "counts clockwise"),
    "positions late": (sampled("position", late(1.0)), "positions", "1 of a sample before"),
    "velocities late": (sampled("velocity", late(0.5)), "velocities", "0.5 of a sample before"),
    "velocities reversed": (of("velocity", _times(-1.0)), "velocities", "wrong sign"),
    "an accelerometer": (of("acceleration", _with_gravity), "accelerations", "accelerometer"),
    "torque reversed": (of("torque", _times(-1.0)), "drive torque", "wrong sign"),
    "torque late": (sampled("torque", late(0.5)), "drive torque", "0.5 of a sample before"),
    "a start at rest": (of("velocity", _first_at_rest), "velocities",
                        r"off at t = 0 s, 1 of \d+ samples over it; the rest is within; look at the start velocities"),
    "the first torque late": (of("torque", _first_late), "drive torque",
                              r"off at t = 0 s, 1 of \d+ samples over it; the rest is within; look at the start"),
    "a torque where parts meet": (of("torque", _doubled_where_parts_meet), "drive torque",
                                  "the rest is within; two parts of the motion meet there"),
    "torque scaled": (of("torque", _times(1.001)), "drive torque", "1.001 times"),
    "torque without the crank": (of("torque", _without_the_crank), "drive torque", "crank's own inertia and weight"),
    "force on the other body": (force_of(1, lambda values, *_: -values), "joint forces", "wrong sign"),
    "force in a body's frame": (force_of(1, _in_the_body), "joint forces", "in the frame of body"),
    "forces exchanged": (
        force_of(1, lambda values, history, scene: next(iter(history.joint_force.values())).values),
        "joint forces", "it is the force of joint",
    ),
    "half a motion": (sampled("torque", at(lambda s: slice(700))), "installed", "torque has no samples"),
    "an instant twice": (sampled("torque", at(lambda s: np.insert(np.arange(len(s.time)), 700, 700))),
                         "samples", "increasing times"),
    "one torque in forty": (sampled("torque", at(lambda s: slice(None, None, 40))), "samples", "samples per turn"),
    "bad data taken": (Changed(_careless), "bad data", "got a finished run"),
    "bad data raised": (Changed(_raising), "bad data", "ValueError: mass .*wrong_engines.py, line"),
    "printing": (PrintingEngine(), "silence", "stepping"),
    "chattering": (Changed(_chattering), "silence", "stepping"),
    "shaking": (Changed(_shaking()), "repetition", "others"),
    "recording too much": (Changed(_generous), "recording", "no position"),
    "steps by the channels": (Changed(_fickle), "recording", "steps of a run with every channel"),
    "beyond its abilities": (Changed(joints=frozenset()), "refusals", "expected 'unsupported'"),
    "refusing without a word": (Changed(_sulking, joints=frozenset()), "refusals", "expected a reason"),
    "a setting that fails": (in_setting(Setting.BEST, lambda _: Run(Outcome.DIVERGED, "no")),
                             "settings", "setting 'best'"),
    "several runs called read": (in_setting(Setting.BEST, _of_two_runs), "origins", "expected 'extrapolated'"),
    "tuned of several runs": (in_setting(Setting.TUNED, _of_two_runs), "origins", "expected one run"),
    "no abilities of ours": (Changed(drives=frozenset({Prescribed, Free, SlotJoint})),
                             "identity", "drives of the contract"),
}  # fmt: skip
