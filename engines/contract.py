"""The contract between the suite and an engine: a scene of rigid bodies goes in, histories or a reason come out.

An adapter receives data only. It never imports the closed forms, never prints, never raises for what a simulation can
do wrong (that is an :class:`Outcome`), and gives every signal its :class:`Origin`: every judgement is made by the
suite. ``engines.stepping.stepped_engine`` meets the contract for an engine that takes time steps, from
two functions of its author's.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import DriverKind
from engines.scene import Channel, Scene

Array = NDArray[np.float64]


class Setting(StrEnum):
    """A way of using an engine."""

    NAIVE = "naive"  # the engine's defaults, every read-out at face value
    TUNED = "tuned"  # the default: one run, as an expert would write it
    BEST = "best"  # the engine's floor: several runs extrapolated, or one at its tightest


class Origin(StrEnum):
    """Where a number comes from, the strongest first."""

    READ = "read"  # the engine's own output, or a fixed map of it: unit, sign, impulse or velocity difference over step
    EXTRAPOLATED = "extrapolated"  # several runs of the engine combined
    PARTLY = "partly computed"  # either of the two, less a share that its adapter computes
    COMPUTED = "computed"  # from masses, inertias, loads or the linkage's equations: not the engine's word


def weakest(origins: Iterable[Origin]) -> Origin:
    """The weakest of several origins: that of a value computed from all of them; READ for none."""
    return max(origins, key=list(Origin).index, default=Origin.READ)


class Outcome(StrEnum):
    """How a run ended, according to its adapter; ``Failure`` of the trials' runs has the other ways to fail."""

    FINISHED = "finished"
    DIVERGED = "diverged"
    UNSUPPORTED = "unsupported"
    UNAVAILABLE = "unavailable"


@dataclass(frozen=True)
class Method:
    """One way of stepping that an engine offers for study: exactly the given steps, nothing repeated or adapted.

    A user runs a :class:`Setting`; the methods justify its choice. ``name`` is unique within the
    engine, ``about`` describes it in one sentence. ``runs`` counts the runs at fractions of the step that are
    extrapolated (1: none). ``effort`` is what the constraint solver is given in every step, in ``effort_unit``
    ("iterations", "relative tolerance"); None leaves the engine's own, and any other may be put in its place with
    ``dataclasses.replace`` where ``effort_unit`` is not empty.
    """

    name: str
    about: str
    runs: int = 1
    effort: float | None = None
    effort_unit: str = ""


@dataclass(frozen=True)
class Signal:
    """Samples over time: ``time`` (n,), s, increasing; ``values`` (n, ...)."""

    time: Array
    values: Array
    origin: Origin = Origin.READ


@dataclass(frozen=True)
class History:
    """The motion an engine computed, each channel on its own clock; None if not requested or not offered.

    ``position`` values (n, bodies, 3): mass centre x, y, m, and angle, rad, unwrapped; ``velocity`` and
    ``acceleration`` likewise; bodies in the scene's order. ``torque`` values (n,): the drive's torque on the crank,
    N m, or the force of a linear drive along it, N; a free crank's is given and not recorded. ``joint_force``: one
    signal per joint name, acting on the joint's first body (the pin's ``first``, the slider's or slot's ``body``), N:
    (n, 2) in the ground frame, or (n,) if the engine provides only magnitudes. Accelerations, torque and joint
    forces may lack a sample at the start, where the engine has none of its own, and one at a jump of the prescribed
    acceleration, where they have two values.
    """

    position: Signal | None = None
    velocity: Signal | None = None
    acceleration: Signal | None = None
    torque: Signal | None = None
    joint_force: Mapping[str, Signal] = field(default_factory=dict)

    @property
    def signals(self) -> dict[tuple[Channel, str], Signal]:
        """Every signal there is, by the pair of its channel and its joint, "" for all but joint forces."""
        whole = {channel: getattr(self, channel) for channel in Channel if channel is not Channel.JOINT_FORCE}
        signals = {(channel, ""): signal for channel, signal in whole.items() if signal is not None}
        return signals | {(Channel.JOINT_FORCE, joint): signal for joint, signal in self.joint_force.items()}

    @classmethod
    def of(cls, signals: Mapping[tuple[Channel, str], Signal]) -> History:
        """The history of signals by pairs of channel and joint, "" but for joint forces, as ``signals`` has them."""
        forces = {joint: signal for (channel, joint), signal in signals.items() if channel is Channel.JOINT_FORCE}
        whole = {
            channel.value: signal for (channel, _), signal in signals.items() if channel is not Channel.JOINT_FORCE
        }
        return cls(**whole, joint_force=forces)


def signal_words(channel: Channel, joint: str) -> str:
    """A signal of a history in words: "velocity", "drive torque", "force in joint 'A'"."""
    if channel is Channel.JOINT_FORCE:
        return f"force in joint '{joint}'"
    return "drive torque" if channel is Channel.TORQUE else channel.value


@dataclass(frozen=True)
class Run:
    """The result of a run: an outcome with its reason, and the history if it finished.

    ``seconds`` is wall time of the stepping alone, ``setup_seconds`` of building the model; ``steps`` counts
    every time step taken, over all passes of an extrapolation. ``passes`` are the longest steps, s, of the runs that
    the history is made of. ``details`` states the settings actually used.
    """

    outcome: Outcome
    reason: str = ""
    history: History | None = None
    seconds: float = 0.0
    setup_seconds: float = 0.0
    steps: int = 0
    passes: tuple[float, ...] = ()
    details: Mapping[str, str | int | float] = field(default_factory=dict)


@dataclass(frozen=True)
class ReadOut:
    """The origin of a channel in the engine: ``source`` is its name there.

    ``frame`` is that of the engine's own numbers, ``instant`` when they hold against the positions of the same step
    ("of the state", "half a step after the positions"). ``drive`` states whether the drive's share is in a force or
    torque; empty where a channel has no such share.
    """

    source: str
    frame: str = "ground"
    instant: str = "of the state"
    drive: str = ""


@dataclass(frozen=True)
class Abilities:
    """Abilities of an engine: the types of ``engines.scene`` it takes, the channels it offers, and its settings.

    Every engine must support pins, gravity and constant forces; ``loads`` are the types of loads,
    ``varying_loads`` whether they may change with φ, ``load_states`` whether they may depend on the whole state: on the
    output's travel and direction, the angle of a body, the place of another, ``friction`` whether joints may have
    friction by their own force; ``timed_torque`` whether a
    free crank's torque may change with time, ``massless`` whether a body may have no mass or no inertia,
    ``drivers`` what may drive. The adapter refuses other unsupported scenes
    (``Outcome.UNSUPPORTED``).
    """

    readouts: Mapping[Channel, ReadOut]
    drives: frozenset[type]
    joints: frozenset[type]
    loads: frozenset[type]
    varying_loads: bool = True
    load_states: bool = False
    friction: bool = False
    massless: bool = True
    timed_torque: bool = False
    drivers: frozenset[DriverKind] = frozenset({DriverKind.CRANK})
    settings: frozenset[Setting] = frozenset(Setting)

    def as_dict(self) -> dict[str, dict[str, str]]:
        """The read-outs by channel, each as a dictionary of its fields, JSON-ready."""
        return {channel.value: asdict(readout) for channel, readout in self.readouts.items()}


class Engine(Protocol):
    """One engine behind the contract; adapters are announced in the entry-point group ``linkproof.engines``."""

    name: str
    abilities: Abilities
    is_control: bool  # whether it is the reference's control and no engine: never ranked

    def version(self) -> str | None:
        """Version of the installed engine, or None where it is not installed."""
        ...

    def run(self, scene: Scene, setting: Setting) -> Run:
        """Build the scene, step it through its drive and return the motion; never raises for a bad simulation.

        A scene that the engine does not support is not stepped: the outcome is UNSUPPORTED, its reason one sentence;
        that of an engine which is not installed is UNAVAILABLE. Of the scene's channels those are recorded that the
        engine offers.
        """
        ...


@runtime_checkable
class StudiedEngine(Engine, Protocol):
    """An engine whose ways of stepping can be studied one by one."""

    def methods(self, scene: Scene) -> tuple[Method, ...]:
        """The ways of stepping that can be studied on a scene's kind of drive: integrators × runs × solver effort.

        The first is what a newcomer would write, the engine's defaults at a step of the caller's. Nothing is imported.
        """
        ...

    def run_method(self, scene: Scene, method: Method, step: float) -> Run:
        """Like ``run``, by one method at a longest step of ``step`` seconds; samples come at that step.

        A method without steps (an exact solution at every instant) only samples there. Refuses nothing that ``run``
        takes; the outcome is DIVERGED only where there is no history to return or the engine itself gave up, so that
        the result of too long a step can be judged from outside. Raises UnknownNameError for a method that is not its
        own, LinkproofError for a step or an effort out of bounds.
        """
        ...
