"""Engines that are right but for one thing, each made of the direct solution."""

import ctypes
import os
import sys
from dataclasses import replace
from functools import lru_cache

import numpy as np

from comparisons.conformance.misreadings import MISREADINGS, Misreading
from comparisons.conformance.mutants import Misread
from engines.contract import Abilities, History, Outcome, Run, Setting, Signal
from engines.direct_adapter.adapter import DirectEngine
from engines.scene import AppliedForce, Channel, Free, Prescribed, SlotJoint


class Direct(DirectEngine):
    """The direct solution, which is asked for one run of a scene over and over."""

    def run(self, scene, setting):
        return _run(scene, setting)


@lru_cache(maxsize=256)
def _run(scene, setting):
    return DirectEngine().run(scene, setting)


class AlterableEngine(DirectEngine):
    """The direct solution of whatever world it is given: the right engine, with a hook for mutants."""

    def altered(self, scene):
        return scene

    def run(self, scene, setting):
        return super().run(self.altered(scene), setting)


class BlindEngine(AlterableEngine):
    """Torque and forces are made of the scene it was asked for, whatever world it has."""

    abilities = replace(
        DirectEngine.abilities,
        readouts={c: r for c, r in DirectEngine.abilities.readouts.items() if c is not Channel.JOINT_FORCE},
    )

    def run(self, scene, setting):
        run, told = super().run(scene, setting), DirectEngine.run(self, scene, setting)
        return replace(run, history=replace(told.history, joint_force={})) if told.history else run


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


class RaisingEngine(Direct):
    """A mass that is no number raises."""

    def run(self, scene, setting):
        if np.isnan(scene.bodies[0].mass):
            raise ValueError("mass")
        return super().run(scene, setting)


class CarelessEngine(Direct):
    """Bad data are taken for good ones."""

    def run(self, scene, setting):
        run = super().run(scene, setting)
        return replace(run, outcome=Outcome.FINISHED, history=History()) if run.outcome is Outcome.DIVERGED else run


class PrintingEngine(Direct):
    """It prints."""

    def run(self, scene, setting):
        sys.stdout.write("stepping\n")
        return super().run(scene, setting)


class ChatteringEngine(Direct):
    """Its C code prints."""

    def run(self, scene, setting):
        ctypes.CDLL(None).puts(b"stepping")
        return super().run(scene, setting)


class ShakingEngine(Direct):
    """Two runs differ in the last digits."""

    count = 0

    def run(self, scene, setting):
        ShakingEngine.count += 1
        run, factor = super().run(scene, setting), 1.0 + 1e-14 * ShakingEngine.count
        if run.history is None or run.history.torque is None:
            return run
        torque = run.history.torque
        return replace(run, history=replace(run.history, torque=replace(torque, values=factor * torque.values)))


class GenerousEngine(Direct):
    """Positions come whether they are asked for or not."""

    def run(self, scene, setting):
        return super().run(replace(scene, channels=scene.channels | {Channel.POSITION}), setting)


class FickleEngine(Direct):
    """The steps depend on what is recorded."""

    def run(self, scene, setting):
        run = super().run(scene, setting)
        return replace(run, steps=run.steps + len(scene.channels))


class BoastingEngine(Direct):
    """Takes all loads, by its abilities, and leaves none of them in."""

    abilities = replace(DirectEngine.abilities, joints=frozenset())


class SulkingEngine(BoastingEngine):
    """What it refuses, it refuses without a word."""

    def run(self, scene, setting):
        return Run(Outcome.UNSUPPORTED) if scene.sliders or scene.slots else super().run(scene, setting)


class GrandEngine(Direct):
    """Claims a setting that fails."""

    def run(self, scene, setting):
        return Run(Outcome.DIVERGED, "no") if setting is Setting.BEST else super().run(scene, setting)


class ProudEngine(Direct):
    """Several runs make what it calls read."""

    def run(self, scene, setting):
        run = super().run(scene, setting)
        return replace(run, passes=(1.0, 0.5)) if setting is Setting.BEST else run


class SeveralEngine(Direct):
    """Tuned is several runs."""

    def run(self, scene, setting):
        run = super().run(scene, setting)
        return replace(run, passes=(1.0, 0.5)) if setting is Setting.TUNED else run


class NamelessEngine(Direct):
    """No channel is said to be anything in the engine."""

    abilities = replace(DirectEngine.abilities, drives=frozenset({Prescribed, Free, SlotJoint}))


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
        if scene.guided or scene.cylinder or loads or isinstance(scene.drive, Free):
            return Run(Outcome.UNSUPPORTED, "too much")
        run = super().run(scene, setting)
        if run.history is None:
            return run
        forces = {n: replace(s, values=np.hypot(*s.values.T)) for n, s in run.history.joint_force.items()}
        return replace(run, history=replace(run.history, joint_force=forces))


def _bodies(channel, change):
    """One channel of the bodies changed: ``change(values, scene)`` in place."""

    def changed(history: History, scene) -> History:
        signal = getattr(history, channel.value)
        values = signal.values.copy()
        change(values, scene)
        return replace(history, **{channel.value: replace(signal, values=values)})

    return Misreading(channel, changed)


def _place_in_mm(values, scene):
    values[..., :2] *= 1e3


def _degrees(values, scene):
    values[..., 2] *= 180.0 / np.pi


def _of_the_pivot(values, scene):
    """The last body by the pin that it has with another."""
    pin = next(p for p in scene.pins if p.first == scene.bodies[-1].name)
    x, y = pin.first_anchor
    c, s = np.cos(values[:, -1, 2]), np.sin(values[:, -1, 2])
    values[:, -1, 0] += c * x - s * y
    values[:, -1, 1] += s * x + c * y


def _wrapped(values, scene):
    values[..., 2] = (values[..., 2] + np.pi) % (2.0 * np.pi) - np.pi


def _exchanged(values, scene):
    values[..., :2] = values[..., 1::-1]


def _without_the_crank(history, scene):
    """What the crank's own weight takes is left out, at the least: of a crank as if it were balanced and light."""
    from comparisons.conformance.clues import _crank_share  # noqa: PLC0415
    from comparisons.conformance.samples import SAMPLES, case  # noqa: PLC0415

    of = next(c for c in map(case, SAMPLES) if c.scene(scene.channels) == scene)
    share = _crank_share(of, scene, history.torque.time)
    return replace(history, torque=replace(history.torque, values=history.torque.values - share))


def _cut(signal: Signal, end):
    return replace(signal, time=signal.time[:end], values=signal.values[:end])


def _twice(signal: Signal):
    order = np.insert(np.arange(len(signal.time)), 700, 700)
    return replace(signal, time=signal.time[order], values=signal.values[order])


def misread(name_or_misreading):
    """The direct solution, misread."""
    found = MISREADINGS.get(name_or_misreading, name_or_misreading)
    return Misread(Direct(), found)


def _torque(change):
    return Misreading(Channel.TORQUE, lambda history, scene: replace(history, torque=change(history.torque)))


# What is wrong, the checks that must fail of it, words that must be in each message.
WRONG = {
    "places in mm": (misread(_bodies(Channel.POSITION, _place_in_mm)), "positions", "in mm"),
    "angles in degrees": (misread(_bodies(Channel.POSITION, _degrees)), "positions", "in degrees"),
    "angles wrapped": (misread(_bodies(Channel.POSITION, _wrapped)), "positions", "not unwrapped"),
    "x and y exchanged": (misread(_bodies(Channel.VELOCITY, _exchanged)), "velocities", "x and y are exchanged"),
    "the pivot's place": (misread(_bodies(Channel.POSITION, _of_the_pivot)), "positions", "the point in joint"),
    "an angle mirrored": (misread("angle of a body mirrored"), "positions", "wrong sign"),
    "positions late": (misread("positions of a sample before"), "positions", "1 of a sample .* before"),
    "velocities late": (misread("velocities of half a sample before"), "velocities", "0.5 of a sample .* before"),
    "velocities reversed": (misread("velocities reversed"), "velocities", "wrong sign"),
    "an accelerometer": (misread("accelerations without gravity"), "accelerations", "accelerometer"),
    "torque reversed": (misread("drive torque reversed"), "drive torque", "wrong sign"),
    "torque late": (misread("drive torque of half a sample before"), "drive torque", "0.5 of a sample .* before"),
    "torque scaled": (misread("drive torque 0.1 % too large"), "drive torque", "1.001 times"),
    "torque without the crank": (
        misread(Misreading(Channel.TORQUE, _without_the_crank)), "drive torque", "crank's own inertia and weight",
    ),
    "force on the other body": (misread("a joint's force on its other body"), "joint forces", "on the other body"),
    "force in a body's frame": (misread("a joint's force in its body's frame"), "joint forces", "in the frame of body"),
    "forces exchanged": (misread("two joints' forces exchanged"), "joint forces", "it is the force of joint"),
    "half a motion": (misread(_torque(lambda signal: _cut(signal, 700))), "samples", "run to the end"),
    "an instant twice": (misread(_torque(_twice)), "samples", "increasing times"),
    "one torque in forty": (misread(_torque(lambda s: replace(s, time=s.time[::40], values=s.values[::40]))),
                            "samples", "samples per turn"),
    "bad data taken": (CarelessEngine(), "bad data", "got a finished run"),
    "bad data raised": (RaisingEngine(), "bad data", "ValueError: mass .*wrong_engines.py, line"),
    "printing": (PrintingEngine(), "silence", "stepping"),
    "chattering": (ChatteringEngine(), "silence", "stepping"),
    "shaking": (ShakingEngine(), "repetition", "others"),
    "recording too much": (GenerousEngine(), "recording", "no position"),
    "steps by the channels": (FickleEngine(), "recording", "steps of a run with every channel"),
    "beyond its abilities": (BoastingEngine(), "refusals", "expected 'unsupported'"),
    "refusing without a word": (SulkingEngine(), "refusals", "expected a reason"),
    "a setting that fails": (GrandEngine(), "settings", "setting 'best'"),
    "several runs called read": (ProudEngine(), "origins", "expected 'extrapolated'"),
    "tuned of several runs": (SeveralEngine(), "origins", "expected one run"),
    "no abilities of ours": (NamelessEngine(), "identity", "drives of the contract"),
}  # fmt: skip
