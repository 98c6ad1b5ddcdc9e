"""Every signal of a history beside the closed form: the error of each body, of the torque and of each joint's force."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Final

import numpy as np

from analytic.numerics.arrays import Array, Booleans
from comparisons.motion.case import Case, channel_truth
from comparisons.trials.judging.quantities import has_two_values
from comparisons.trials.observed_motion import resample
from engines.contract import History, Signal, signal_words
from engines.mechanics.joints import scene_size
from engines.scene import LEVELS, Channel, Scene

PLACE, ANGLE, NUMBER = slice(0, 2), slice(2, 3), slice(0, 1)  # columns of a body; of a force; of a scalar
# A joint's peak force below this share of the largest is nothing to measure its own error by.
FAINT_FORCE: Final = 1e-9


@dataclass(frozen=True)
class Reading:
    """A signal of a history: place or angle of a body (``name``), force of a joint, torque of the drive.

    ``time`` (n,), s, are its samples, ``columns`` those that it has of its body's or its joint's; ``name`` is "" for
    the torque.
    """

    scene: Scene
    history: History
    channel: Channel
    name: str
    columns: slice
    time: Array

    @property
    def values(self) -> Array:
        """Samples of the signal in its own columns, (n, k)."""
        return self.values_at(self.time)

    def values_at(self, time: Array) -> Array:
        """Values of the signal at times, s, (n, k), interpolated; outside of its own clock the first or the last.

        Raises ValueError for fewer than six samples at other times than its own.
        """
        return self.channel_values(self.channel, self.name, time)[:, self.columns]

    def channel_values(self, channel: Channel, name: str, time: Array) -> Array:
        """All columns of a channel of the body or joint ``name`` at times, s, (n, columns), interpolated.

        Outside of the channel's clock they are the first or the last. The channel must be recorded. Raises ValueError
        for fewer than six samples at other times than its own.
        """
        if channel is Channel.JOINT_FORCE:
            signal = self.history.joint_force[name]
        else:
            signal = getattr(self.history, channel.value)
        values = resample(signal, np.clip(time, signal.time[0], signal.time[-1]))
        return np.asarray(values[:, self.body_number(name)] if channel in LEVELS else values.reshape(len(time), -1))

    def body_number(self, body: str) -> int:
        """The index of a body, named, in the scene's arrays; raises ValueError for another, the ground's too."""
        return [each.name for each in self.scene.bodies].index(body)

    @property
    def is_meaningless(self) -> bool:
        """Whether it is the angle of a point, or its rate: of a mass at a pin, which no joint keeps from turning."""
        guided = {slider.body for slider in self.scene.sliders}
        is_angle = self.channel in LEVELS and self.columns == ANGLE
        return is_angle and self.name not in guided and self.scene.bodies[self.body_number(self.name)].inertia is None

    @property
    def words(self) -> str:
        """The name of the signal in words, such as "angular velocity of body 'crank'"."""
        if self.channel not in LEVELS:
            return signal_words(self.channel, self.name)
        kind = "" if self.channel is Channel.POSITION else self.channel.value
        turning = f"angular {kind}" if kind else "angle"
        return f"{turning if self.columns == ANGLE else kind or 'place'} of body '{self.name}'"


def readings(scene: Scene, history: History) -> Iterator[Reading]:
    """Yield a Reading for each signal of a history: of each body's place and angle, of the torque, of each joint.

    Place and angle come once for each of position, velocity and acceleration that is recorded.
    """
    for (channel, joint), signal in history.signals.items():
        if channel in LEVELS:
            for body, columns in product(scene.bodies, (PLACE, ANGLE)):
                yield Reading(scene, history, channel, body.name, columns, signal.time)
        else:
            columns = PLACE if signal.values.ndim > 1 else NUMBER
            yield Reading(scene, history, channel, joint, columns, signal.time)


def true_history(case: Case, scene: Scene, history: History) -> History:
    """The true values of all signals of a history, from the closed form, at the same times.

    Where the history has only magnitudes of forces, so has the result. Angles are continuous, as those of engines are.
    Raises LinkproofError where the closed form has none, as in a dead position.
    """
    bodies = [body.name for body in scene.bodies]

    def right(channel: Channel, joint: str, signal: Signal) -> Signal:
        """The closed form of a channel, or of a joint's force, at a signal's times; ``joint`` is "" for a channel."""
        parts = [channel_truth(case, channel, n, signal.time) for n in (bodies if channel in LEVELS else [joint])]
        values = np.stack(parts, axis=1)
        if channel is Channel.POSITION:
            values[..., 2] = np.unwrap(values[..., 2], axis=0)
        if channel in LEVELS:
            return Signal(signal.time, values)
        alone = values[:, 0]
        return Signal(signal.time, np.hypot(*alone.T) if signal.values.ndim < alone.ndim else alone)

    return History.of({key: right(*key, signal) for key, signal in history.signals.items()})


@dataclass(frozen=True)
class SignalError:
    """What an engine has of one signal beside the truth; the error is over ``scale``, in the signal's unit.

    ``scale`` is the linkage's size or a radian for a position; for a velocity or an acceleration its peak over all
    bodies, of their places or of their angles; for a torque or a force its own peak. ``counted`` (n,) says which
    samples have an error.
    """

    read: Reading
    true: Reading
    scale: float
    counted: Booleans

    @property
    def scale_words(self) -> str:
        """The words for the scale that an error is a share of, to follow its number, such as "of the peak"."""
        if self.read.channel is not Channel.POSITION:
            return "of the peak"
        return "rad" if self.read.columns == ANGLE else "of the linkage's size"

    @property
    def components(self) -> Array:
        """The errors' components (n, k) as shares of the scale.

        They are 0 where the truth has two values, infinite where it has none.
        """
        difference = np.abs(self.read.values - self.true.values) / self.scale
        return np.where(self.counted[:, None], np.nan_to_num(difference, nan=np.inf), 0.0)

    @cached_property
    def sizes(self) -> Array:
        """Magnitudes of the errors as shares of the scale, (n,); computed once."""
        return np.asarray(np.hypot.reduce(self.components, axis=1))

    @property
    def largest(self) -> float:
        """The largest magnitude of the errors, as a share of the scale."""
        return float(np.max(self.sizes))

    @property
    def worst_time(self) -> float:
        """The time, s, of the largest error."""
        return float(self.read.time[np.argmax(self.sizes)])


def signal_errors(
    case: Case, scene: Scene, history: History, channels: Iterable[Channel] = tuple(Channel)
) -> list[SignalError]:
    """The error of every body's place and angle, of the torque and of every joint's force, in these channels.

    Channels that were not recorded are left out. At jumps of the acceleration, of friction and of loads accelerations,
    torque and forces have two values, and no error. A released crank's torque is given, and forces have no bound where
    the linkage passes a change point: these are left out, and so is the angle of a point. Raises LinkproofError where
    the closed form has no value, as in a dead position.
    """
    left_out = {Channel.TORQUE} if not case.is_prescribed else set()
    left_out |= {Channel.JOINT_FORCE} if case.unbounded_at is not None else set()
    wanted = {*channels} - left_out
    only = History.of({key: signal for key, signal in history.signals.items() if key[0] in wanted})
    pairs = zip(readings(scene, only), readings(scene, true_history(case, scene, only)), strict=True)
    signals = [(read, true, _counted(case, read)) for read, true in pairs if not read.is_meaningless]
    peaks: dict[tuple[Channel, str, int], float] = {}
    for _, true, counted in signals:
        sizes = np.hypot.reduce(true.values[counted], axis=1)
        peaks[_peak_group(true)] = max(peaks.get(_peak_group(true), 0.0), float(np.max(sizes, initial=0.0)))
    strongest = max((peak for (channel, *_), peak in peaks.items() if channel is Channel.JOINT_FORCE), default=0.0)

    def scale(true: Reading) -> float:
        """The size, SI, that errors of a signal are a share of: a peak, the scene's size, or 1 rad; 1 instead of 0.

        A faint joint force has a share of the strongest one's peak.
        """
        if true.channel is Channel.POSITION:
            return 1.0 if true.columns == ANGLE else scene_size(scene)
        least = FAINT_FORCE * strongest if true.channel is Channel.JOINT_FORCE else 0.0
        return max(peaks[_peak_group(true)], least) or 1.0

    return [SignalError(read, true, scale(true), counted) for read, true, counted in signals]


def _peak_group(reading: Reading) -> tuple[Channel, str, int]:
    """The key of signals that share a peak: of a channel all bodies' places, all angles, or one joint's force.

    It is the channel, the joint's name, else "", and the number of the signal's first column.
    """
    is_force = reading.channel is Channel.JOINT_FORCE
    return (reading.channel, reading.name if is_force else "", reading.columns.start)


def _counted(case: Case, reading: Reading) -> Booleans:
    """Which samples (n,) have an error: all of positions and velocities; of others those with one true value.

    Those with two, by ``has_two_values``, lie at jumps of the acceleration, of friction or of loads.
    """
    if reading.channel in (Channel.POSITION, Channel.VELOCITY):
        return np.ones(len(reading.time), dtype=bool)
    return ~has_two_values(case, reading.time)
