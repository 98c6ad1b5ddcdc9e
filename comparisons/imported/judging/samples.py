"""Imported signals beside the closed form at the file's own instants: nothing in the file is interpolated."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from analytic.description.linkage import Linkage
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import signal
from comparisons.imported.columns import MAGNITUDE, ImportedSignal
from comparisons.imported.judging.changed_motion import ChangedMotion
from comparisons.imported.judging.crank_column import SPREAD, ColumnMotion
from comparisons.reference.case import Truth
from comparisons.reference.motion import Motion

Array = NDArray[np.float64]

WINDOW: Final = 1e-2  # of the shortest piece of the motion: half the window at its acceleration jumps
NEIGHBOURS: Final = 8  # a share of the samples that are near one another
STEPS: Final = 1.01  # of the file on either side of a jump: its instant is rounded


@dataclass(frozen=True)
class Samples:
    """A signal as judged: ``values`` (n,), SI, at times (n,), s, each within its ``rounding``, from ``imported``."""

    name: str
    time: Array
    values: Array
    rounding: Array
    time_rounding: Array
    imported: ImportedSignal

    def thinned(self, most: int) -> Samples:
        """At most so many of the samples, equally spread."""
        every = -(-len(self.time) // most)
        parts = {p: getattr(self, p)[::every] for p in ("time", "values", "rounding", "time_rounding")}
        return replace(self, **parts)


@dataclass(frozen=True)
class JudgedModel:
    """A linkage under a motion of its crank, as the closed form has it; ``modes`` are its assembly modes if others."""

    linkage: Linkage
    motion: Motion
    modes: tuple[int, ...] | None = None

    @cached_property
    def mechanism(self) -> Mechanism:
        """The closed form."""
        mechanism = Mechanism(self.linkage)
        if self.modes is not None:
            mechanism.structure = mechanism.structure.with_signs(self.modes)
        return mechanism

    def moving(self, motion: Motion) -> JudgedModel:
        """The same linkage under another motion; what is known of the linkage stays known."""
        other = replace(self, motion=motion)
        other.__dict__["mechanism"] = self.mechanism
        return other

    def loaded(self, linkage: Linkage) -> JudgedModel:
        """A linkage with other masses and loads, which moves as this one does."""
        other = replace(self, linkage=linkage)
        other.__dict__["mechanism"] = self.mechanism.with_loads_of(linkage)
        return other

    def predicted(self, samples: Iterable[Samples]) -> list[Array]:
        """The closed form of each signal at its instants; signals on one clock share the work."""
        truths: dict[bytes, Truth] = {}
        values = []
        for one in samples:
            key = one.time.tobytes()
            truth = truths.setdefault(key, Truth(self.mechanism, self.motion, one.time))
            values.append(value(truth, one.name))
        return values


def value(truth: Truth, name: str) -> Array:
    """The closed form of a signal, or of the size of a joint's force, (n,)."""
    if name.endswith(f":{MAGNITUDE}"):
        joint = name.removesuffix(MAGNITUDE)
        return np.asarray(np.hypot(signal(truth, f"{joint}x"), signal(truth, f"{joint}y")))
    return signal(truth, name)


def is_force(name: str) -> bool:
    """Whether a signal is a torque, a force or a power: what masses and loads decide."""
    return name in ("Mkr", "Peq") or name.startswith(("joint_force", "shaking"))


def depends_on_masses(name: str) -> bool:
    """Whether masses and loads decide a signal, so that all others stay what they are if those change."""
    return is_force(name) or name in ("Teq", "Jeq")


def holds_acceleration(name: str) -> bool:
    """Whether a signal jumps with the crank's acceleration."""
    return is_force(name) or name in ("epsilon", "a") or name.endswith((":ax", ":ay", ":alpha"))


def is_angle(name: str) -> bool:
    """Whether a signal is an angle, of which whole turns say nothing."""
    return name == "phi" or name.endswith(":angle") or name.startswith("transmission_angle")


def floor(model: JudgedModel, samples: Sequence[Samples], truth: Sequence[Array]) -> list[Array]:
    """What the file's rounding leaves open of each signal (n,): of its values, its instants and its crank angles."""
    floors = []
    likewise = model.motion.likewise if isinstance(model.motion, ColumnMotion) else ()
    others = [model.moving(motion).predicted(samples) for motion in likewise]
    early, late = (model.predicted([_moved(one, sign) for one in samples]) for sign in (-1.0, 1.0))
    for number, one in enumerate(samples):
        by_time = np.maximum(np.abs(early[number] - truth[number]), np.abs(late[number] - truth[number]))
        apart = [np.where(at_jumps(one.time, model.motion), 0.0, np.abs(o[number] - truth[number])) for o in others]
        by_angle = _near_largest(apart, model.motion) if apart else 0.0
        floors.append(one.rounding + np.where(one.time_rounding > 0.0, by_time, 0.0) + SPREAD * by_angle)
    return floors


def _near_largest(differences: Sequence[Array], motion: Motion) -> Array:
    """The largest of a few trials' differences near each sample; anywhere, where the motion may be any at all."""
    largest = np.max(differences, axis=0)
    if not (isinstance(motion, ColumnMotion) and motion.is_known):
        return np.full(len(largest), np.max(largest))
    size = max(1, len(largest) // NEIGHBOURS)
    return np.asarray(maximum_filter1d(largest, size, mode="nearest"))


def _moved(one: Samples, sign: float) -> Samples:
    return replace(one, time=one.time + sign * one.time_rounding)


def jumps_of(model: JudgedModel, one: Samples) -> Array:
    """By how much the closed form of a signal jumps at each sample (n,): in the window of such a jump, else 0."""
    sizes = np.zeros(len(one.time))
    if not holds_acceleration(one.name):
        return sizes
    for jump in model.motion.jumps:
        at_rest = model.moving(ChangedMotion(model.motion, order=0))  # as the crank is before the start
        earlier = model if jump > 0.0 else at_rest
        (after,) = model.predicted([replace(one, time=np.array([jump]))])
        (before,) = earlier.predicted([replace(one, time=np.array([np.nextafter(jump, 0.0)]))])
        size = max(float(np.abs(after - before)[0]), np.finfo(float).tiny)
        sizes = np.where(_near(one.time, model.motion, jump), np.maximum(sizes, size), sizes)
    return sizes


def at_jumps(time: Array, motion: Motion) -> NDArray[np.bool_]:
    """Samples in the window at any jump of the crank's acceleration."""
    near = np.zeros(len(time), dtype=bool)
    for jump in motion.jumps:
        near |= _near(time, motion, jump)
    return near


def _near(time: Array, motion: Motion, jump: float) -> NDArray[np.bool_]:
    ends = np.array([0.0, *motion.jumps, motion.duration])
    pieces = np.diff(np.unique(ends))
    step = float(np.median(np.diff(time))) if len(time) > 1 else 0.0
    window = max(WINDOW * float(np.min(pieces[pieces > 0.0], initial=motion.duration)), STEPS * step)
    return np.asarray(np.abs(time - jump) <= window)
