"""Checks of what an engine returns: every channel in ``tuned`` beside the closed form, and why it differs."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from comparisons.conformance.samples import case as sample_case
from comparisons.conformance.trial import Check, EngineTrial, NotTestedError
from comparisons.faults.misreadings import Reading, likeliest_misreading, readings, true_history
from comparisons.judging.limits import limit
from comparisons.observed_motion import DENSE
from comparisons.reference.case import Case
from engines.contract import History, Setting
from engines.scene import Channel, Prescribed, Scene

Array = NDArray[np.float64]

# Whose limit a channel of every body and joint has: that of the quantity read from it.
LIMIT_QUANTITIES = {
    Channel.POSITION: "S",
    Channel.VELOCITY: "v",
    Channel.ACCELERATION: "a",
    Channel.TORQUE: "Mkr",
    Channel.JOINT_FORCE: "joint_force",
}
ROUNDING_FACTOR = 1.0 + 1e-6


def check_channel(channel: Channel, trial: EngineTrial) -> None:
    """One channel of every sample beside the closed form, within the limit of ``tuned``."""
    if channel not in trial.engine.abilities.readouts:
        raise NotTestedError(f"{trial.engine.name} offers no {channel.value}")
    is_compared = False
    for sample, scene, history in trial.histories():
        if channel is Channel.TORQUE and not isinstance(scene.drive, Prescribed):
            continue
        errors = list(_channel_errors(channel, sample_case(sample), scene, history))
        assert errors, f"expected a {channel.value} in sample '{sample}', got none: record it, its abilities offer it"
        is_compared = True
        bound = limit(LIMIT_QUANTITIES[channel], Setting.TUNED, sample_case(sample).motion.regime).value
        error, reading, right = max(errors, key=lambda each: each[0])
        if not error <= bound:
            cause = likeliest_misreading(right, reading.values) or "a mass, a load, a geometry, or too long a step"
            raise AssertionError(
                f"{reading.words}, sample '{sample}': expected the closed form within {bound:.0e} of the peak, got "
                f"{error:.2g} off; {cause}"
            )
    if not is_compared:
        raise NotTestedError(f"no sample of the conformance test has a {channel.value} for {trial.engine.name}")


def _channel_errors(
    channel: Channel, case: Case, scene: Scene, history: History
) -> Iterator[tuple[float, Reading, Reading]]:
    """Errors of a channel's signals, each with the engine's reading and the true one.

    An error is over the peak of all bodies; of a joint force it is over the peak of that force.
    """
    pairs = zip(readings(scene, history), readings(scene, true_history(case, scene, history)), strict=True)
    signals = [(read, true, _peak(true.values)) for read, true in pairs if read.channel is channel]
    for read, true, size in signals:
        peak = max(peak for other, _, peak in signals if other.columns == read.columns)
        scale = size if channel is Channel.JOINT_FORCE else peak
        yield _peak(read.values - true.values) / (scale or 1.0), read, true


def _peak(values: Array) -> float:
    return float(np.max(np.hypot.reduce(values, axis=1)))


def check_samples(trial: EngineTrial) -> None:
    """Sample times increase to the end of the motion, densely enough to be read between."""
    for sample, scene, history in trial.histories():
        motion = sample_case(sample).motion
        for reading in readings(scene, history):
            words, gaps = f"{reading.words}, sample '{sample}'", np.diff(reading.time)
            assert np.all(gaps > 0.0), (
                f"{words}: expected increasing times, got {reading.time[int(np.argmin(gaps))]:g} s twice: leave out "
                "what a fresh start repeats"
            )
            turn, longest = FULL_TURN / motion.peak_speed, float(gaps.max())
            assert longest * DENSE <= turn * ROUNDING_FACTOR, (
                f"{words}: expected {DENSE} samples per turn or more, got {turn / longest:.0f}: give the recipe more "
                "steps per turn"
            )
            assert reading.time[-1] <= motion.duration * ROUNDING_FACTOR, (
                f"{words}: expected samples up to {motion.duration:g} s, got {reading.time[-1]:g} s"
            )


CHANNEL_CHECKS = (
    Check("samples", "sample times increase and cover the motion densely", check_samples),
    *(
        Check(name, f"the closed form's: {about}", partial(check_channel, channel))
        for name, channel, about in (
            ("positions", Channel.POSITION, "mass centres and angles in the ground frame"),
            ("velocities", Channel.VELOCITY, "at the stated instants"),
            ("accelerations", Channel.ACCELERATION, "at the stated instants, without subtracting gravity"),
            ("drive torque", Channel.TORQUE, "the torque of the drive on the crank"),
            ("joint forces", Channel.JOINT_FORCE, "on each joint's first body, in the ground frame"),
        )
    ),
)
