"""A fault of a simulation, what it does, its sentence and its cure; and the model of the simulation that it changes."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from enum import IntEnum
from functools import cached_property, partial
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.description.linkage import Linkage
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import signal
from comparisons.motion.case import Motion, Truth

Array = NDArray[np.float64]
Predict = Callable[[str, Array], Array]  # a signal's name, times (n,), s
Change = Callable[[Predict, str, Array], Array]

MOTION_PARTS: Final = (
    "ground",
    "sliders",
    "slots",
    "pins",
    "output",
    "crank",
)  # of a linkage, besides its links' points

Numbers = tuple[float, ...]


@dataclass(frozen=True)
class SignalTimes:
    """A signal by its ``name`` at ``time`` (n,), s."""

    name: str
    time: Array


@dataclass(frozen=True)
class Simulation:
    """A linkage under a motion, as the closed form has it; ``modes`` are its assembly modes if others.

    ``after`` are changes of single curves, in their order: each has what stands before it, a signal's name and times.
    """

    linkage: Linkage
    motion: Motion
    modes: tuple[int, ...] | None = None
    after: tuple[Change, ...] = ()
    _seen: dict[tuple[str, bytes], Array] = field(default_factory=dict, init=False, compare=False, repr=False)

    @cached_property
    def mechanism(self) -> Mechanism:
        """The closed form of the linkage, in its modes."""
        mechanism = Mechanism(self.linkage)
        if self.modes is not None:
            mechanism.structure = mechanism.structure.with_signs(self.modes)
        return mechanism

    def with_motion(self, motion: Motion) -> Simulation:
        """The simulation under another motion; what is known of its linkage stays known."""
        other = replace(self, motion=motion)
        other.__dict__["mechanism"] = self.mechanism
        return other

    def with_linkage(self, linkage: Linkage) -> Simulation:
        """The simulation of another linkage; if only masses and loads differ, its known motion stays."""
        other = replace(self, linkage=linkage)
        if _motion_parts(linkage) == _motion_parts(self.linkage):
            other.__dict__["mechanism"] = self.mechanism.with_loads_of(linkage)
        return other

    def with_modes(self, modes: tuple[int, ...]) -> Simulation:
        """The simulation in other assembly modes, a sign for each dyad."""
        return replace(self, modes=modes)

    def with_change(self, change: Change) -> Simulation:
        """The simulation with one more change of its curves; what they were before is computed once."""
        other = replace(self, after=(*self.after, change))
        other.__dict__.update(mechanism=self.mechanism, _seen=self._seen)
        return other

    def predict(self, curves: Iterable[SignalTimes]) -> list[Array]:
        """Values (n,), SI, of each signal at its times; signals on one clock share the work."""
        truths: dict[bytes, Truth] = {}

        def closed_form(name: str, time: Array) -> Array:
            clock = time.tobytes()
            if (name, clock) not in self._seen:
                truth = truths.setdefault(clock, Truth(self.mechanism, self.motion, time))
                self._seen[name, clock] = signal(truth, name)
            return self._seen[name, clock]

        predict: Predict = closed_form
        for change in self.after:
            predict = partial(change, predict)
        return [predict(curve.name, curve.time) for curve in curves]


def _motion_parts(linkage: Linkage) -> list[Any]:
    """The parts of a linkage that decide its motion."""
    points = {name: link.points for name, link in linkage.links.items()}
    return [points, *(getattr(linkage, part) for part in MOTION_PARTS)]


@dataclass(frozen=True)
class ChangedMotion:
    """``pace`` φ(t + ``shift``) + ``offset``; derivatives above ``order`` are left out: 0 of them leave rest."""

    motion: Motion
    pace: float = 1.0
    offset: float = 0.0
    shift: float = 0.0
    order: int = 2

    @property
    def regime(self) -> str:
        """Name of the regime."""
        return self.motion.regime

    @property
    def duration(self) -> float:
        """Time at which it ends, s."""
        return self.motion.duration

    @property
    def peak_speed(self) -> float:
        """Largest |ω|, rad/s."""
        return self.motion.peak_speed * abs(self.pace)

    @property
    def jumps(self) -> tuple[float, ...]:
        """Times at which the acceleration jumps, s."""
        return tuple(jump - self.shift for jump in self.motion.jumps)

    def _clock(self, time: ArrayLike) -> Array:
        return np.asarray(np.asarray(time, dtype=float) + self.shift)

    def angle(self, time: ArrayLike) -> Array:
        """φ(t), rad."""
        return np.asarray(self.pace * self.motion.angle(self._clock(time)) + self.offset)

    def speed(self, time: ArrayLike) -> Array:
        """ω(t), rad/s."""
        return np.asarray((self.order > 0) * self.pace * self.motion.speed(self._clock(time)))

    def acceleration(self, time: ArrayLike) -> Array:
        """ε(t), rad/s²."""
        return np.asarray((self.order > 1) * self.pace * self.motion.acceleration(self._clock(time)))


def holds_acceleration(name: str) -> bool:
    """Whether a signal jumps with the crank's acceleration."""
    of_loads = name in ("Mkr", "Peq") or name.startswith(("joint_force", "shaking"))
    return of_loads or name in ("epsilon", "a") or name.endswith((":ax", ":ay", ":alpha"))


def is_angle(name: str) -> bool:
    """Whether a signal is an angle, so that whole turns do not count."""
    return name == "phi" or name.endswith(":angle") or name.startswith("transmission_angle")


def has_free_zero(name: str) -> bool:
    """Whether a signal is an angle or a length that counts from a zero of choice."""
    return is_angle(name) or name == "S" or (name.startswith("point:") and name.endswith((":x", ":y")))


def is_rotary(name: str) -> bool:
    """Whether a signal changes its sign where the drawing is looked at from behind."""
    return name in ("phi", "omega", "epsilon", "Mkr", "shaking_moment") or name.startswith("link:")


class FaultKind(IntEnum):
    """Where a fault lies, in the order in which an engineer looks: of causes that fit alike the first is named."""

    COLUMN = 0  # sign, unit or meaning of a column of the file
    SETTING = 1  # one setting of the tool: gravity, direction, start, units, what is left out
    NUMBER = 2  # one number of the description
    SEVERAL = 3  # several numbers at once
    FREE = 4  # a factor of a column that no unit explains


@dataclass(frozen=True)
class Correction:
    """A correction that a mapping may accept: ``sign * factor * value + offset`` at the time + ``time_shift``; SI."""

    sign: int = 1
    factor: float = 1.0
    time_shift: float = 0.0
    offset: float = 0.0

    def compose(self, first: Correction) -> Correction:
        """The correction that applies ``first``, then this one."""
        return Correction(
            self.sign * first.sign,
            self.factor * first.factor,
            self.time_shift + first.time_shift,
            self.sign * self.factor * first.offset + self.offset,
        )


Cure = Callable[[Array], dict[str, Correction]]


@dataclass(frozen=True)
class Fault:
    """One thing that may be wrong: ``apply(simulation, numbers)`` is the simulation with it.

    Raises LinkproofError where the linkage cannot be so. ``start`` (k,) are the numbers with which nothing is wrong,
    ``sizes`` what counts as a change of each; fits begin at the ``guesses``, and ``usual`` numbers are tried as they
    are. ``unit`` is that in which a single number is written, as SI value: round ones are likelier. ``words(numbers)``
    is its sentence, ``cure(numbers)`` gives corrections by the names of signals, "*" for all.
    One that ``reshapes`` the linkage makes it move otherwise.
    """

    name: str
    kind: FaultKind
    apply: Callable[[Simulation, Array], Simulation]
    words: Callable[[Array], str]
    start: Numbers = ()
    sizes: Numbers = ()
    guesses: tuple[Numbers, ...] = ()
    usual: tuple[Numbers, ...] = ()
    unit: float = 0.0
    cure: Cure = lambda _: {}
    reshapes: bool = False

    def plant(self, simulation: Simulation, *numbers: float) -> Simulation:
        """The simulation with this fault, at these numbers."""
        return self.apply(simulation, np.array(numbers, dtype=float))
