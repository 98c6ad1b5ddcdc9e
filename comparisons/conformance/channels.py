"""Checks of what an engine says: every channel in ``tuned`` beside the closed form, with the cause of what differs."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from numpy.typing import NDArray

from analytic.description.law import FULL_TURN
from comparisons.conformance.clues import Part, likeliest
from comparisons.conformance.findings import Check, NotApplicableError
from comparisons.conformance.mutants import kept_run
from comparisons.conformance.samples import PLAIN, SAMPLES, case
from comparisons.judging.limits import limit
from comparisons.observation.observed_motion import DENSE
from comparisons.reference.case import Case
from comparisons.reference.channels import truth
from comparisons.runs.gaps import gap
from engines.contract import Engine, History, Outcome, Run, Setting, Signal
from engines.mechanics.start_check import ability_obstacle
from engines.scene import Channel, Drive, Prescribed, Scene

Array = NDArray[np.float64]

# Whose limit a channel of every body and joint has: that of the quantity read from it.
LIKE = {
    Channel.POSITION: "S",
    Channel.VELOCITY: "v",
    Channel.ACCELERATION: "a",
    Channel.TORQUE: "Mkr",
    Channel.JOINT_FORCE: "joint_force",
}
PLACE, ANGLE = slice(0, 2), slice(2, 3)
ROUNDED = 1.0 + 1e-6


def obstacle(engine: Engine, sample: str) -> str | None:
    """Why a sample is not for an engine, by what it says of itself."""
    if Setting.TUNED not in engine.abilities.settings:
        return f"{engine.name} offers no setting '{Setting.TUNED}'"
    return ability_obstacle(case(sample).scene(frozenset()), engine.abilities)


def finished(engine: Engine, sample: str) -> Run:
    """The engine's tuned run of a sample it says it can hold; raises NotApplicableError where it cannot after all."""
    reason = obstacle(engine, sample)
    if reason is not None:
        raise NotApplicableError(f"{sample}: {reason}")
    return completed(kept_run(engine, sample), sample)


def completed(run: Run, sample: str) -> Run:
    """A finished run of a sample; raises NotApplicableError for one that the engine does not take after all."""
    if run.outcome is Outcome.UNAVAILABLE or (run.outcome is Outcome.UNSUPPORTED and sample != PLAIN):
        raise NotApplicableError(f"{sample}: {run.outcome.value}, {run.reason}")
    assert run.outcome is Outcome.FINISHED, (
        f"expected the run of sample '{sample}' to finish, got {run.outcome.value}: {run.reason}; an adapter "
        "takes pins, gravity and a prescribed crank, and what its abilities name besides"
    )
    assert run.history is not None, f"expected a history of the finished run of sample '{sample}', got None: return it"
    return run


def runs(engine: Engine) -> Iterator[tuple[str, Scene, Run]]:
    """The tuned runs of all samples that are for the engine; the plain one must be."""
    for sample in SAMPLES:
        try:
            yield sample, case(sample).scene(frozenset(Channel)), finished(engine, sample)
        except NotApplicableError:
            if sample == PLAIN:
                raise


def parts(history: History, scene: Scene, channel: Channel) -> Iterator[Part]:
    """Every signal of a channel, by body, joint or drive."""
    if channel is Channel.JOINT_FORCE:
        for joint, signal in history.joint_force.items():
            yield Part(f"force in joint '{joint}'", channel, joint, signal, PLACE)
        return
    signal = getattr(history, channel.value)
    if signal is None:
        return
    if channel is Channel.TORQUE:
        yield Part("drive torque", channel, "", signal, PLACE)
        return
    kind = channel.value if channel is not Channel.POSITION else ""
    for number, body in enumerate(scene.bodies):
        own = Signal(signal.time, signal.values[:, number], signal.origin)
        yield Part(f"{kind or 'place'} of body '{body.name}'", channel, body.name, own, PLACE)
        yield Part(f"{f'angular {kind}' if kind else 'angle'} of body '{body.name}'", channel, body.name, own, ANGLE)


def says_what_is_true(channel: Channel, engine: Engine) -> None:
    """One channel of every sample beside the closed form, within the limit of ``tuned``."""
    if channel not in engine.abilities.readouts:
        raise NotApplicableError(f"{engine.name} offers no {channel.value}")
    seen = 0
    for sample, scene, run in runs(engine):
        assert run.history is not None
        if channel is Channel.TORQUE and not isinstance(scene.drive, Prescribed):
            continue
        compared = _compared(case(sample), scene, channel, run.history)
        assert compared, f"expected a {channel.value} in sample '{sample}', got none: record it, its abilities offer it"
        seen += 1
        bound = limit(LIKE[channel], Setting.TUNED, case(sample).motion.regime).value
        error, part = max(compared, key=lambda each: each[0])
        if not error <= bound:
            steps = run.steps / max(1, len(part.signal.time) - 1) / max(1, len(run.passes))
            cause = likeliest(case(sample), scene, part, steps)
            cure = cause or "no known slip explains it: a mass, a load, a geometry, or too long a step"
            raise AssertionError(
                f"{part.words}, sample '{sample}': expected the closed form within {bound:.0e} of the peak, got "
                f"{error:.2g} off; {cure}"
            )
    if not seen:
        raise NotApplicableError(f"no sample of the conformance test has a {channel.value} for {engine.name}")


def _compared(of: Case, scene: Scene, channel: Channel, history: History) -> list[tuple[float, Part]]:
    """Every part of a channel with its error over the peak, of a body's over that of its kind among all bodies."""
    found, peaks = [], dict.fromkeys((PLACE.start, ANGLE.start), 0.0)
    for part in parts(history, scene, channel):
        right, got = truth(of, channel, part.name, part.signal.time), part.signal.values
        if right.ndim > 1:
            right = right[:, part.columns]
            got = got[:, part.columns] if got.ndim > 1 else got
        if got.ndim < right.ndim:
            right = np.hypot(*right.T)
        assert got.shape == right.shape, f"{part.words}: expected values of shape {right.shape}, got {got.shape}"
        peak = _size(right)
        found.append((_size(got - right), peak, part))
        peaks[part.columns.start] = max(peaks[part.columns.start], peak)
    of_own = channel is Channel.JOINT_FORCE
    return [(error / ((own if of_own else peaks[part.columns.start]) or 1.0), part) for error, own, part in found]


def _size(values: Array) -> float:
    return float(np.max(np.abs(values) if values.ndim == 1 else np.hypot.reduce(values, axis=1)))


def samples_cover_the_motion(engine: Engine) -> None:
    """Sample times increase from the start to the end of the motion, densely enough to be read between."""
    for sample, scene, run in runs(engine):
        assert run.history is not None
        of = case(sample)
        for channel in Channel:
            for part in parts(run.history, scene, channel):
                _check_times(f"{part.words}, sample '{sample}'", part.signal.time, of, scene.drive)


def _check_times(words: str, time: Array, of: Case, drive: Drive) -> None:
    gaps, end = np.diff(time), of.motion.duration
    assert len(gaps), f"{words}: expected samples, got {len(time)}: record every one"
    assert np.all(gaps > 0.0), (
        f"{words}: expected increasing times, got {time[int(np.argmin(gaps)) + 1]:g} s after "
        f"{time[int(np.argmin(gaps))]:g} s: leave out what a fresh start repeats"
    )
    hole, longest = gap(time, drive), float(gaps.max())
    assert not hole, (
        f"{words}: expected samples from 0 to {end:g} s, got none {hole}: run to the end of the drive, count time from "
        "its start and leave no sample out"
    )
    turn = FULL_TURN / of.motion.peak_speed
    assert longest * DENSE <= turn * ROUNDED, (
        f"{words}: expected {DENSE} samples per turn or more, got {turn / longest:.0f}: give the recipe more steps per "
        "turn"
    )
    assert time[-1] <= end * ROUNDED, f"{words}: expected samples up to {end:g} s, got {time[-1]:g} s"


CHECKS = (
    Check("samples", "sample times increase and cover the motion densely", samples_cover_the_motion),
    *(
        Check(name, f"the closed form's: {about}", partial(says_what_is_true, channel))
        for name, channel, about in (
            ("positions", Channel.POSITION, "mass centres and angles in the ground frame"),
            ("velocities", Channel.VELOCITY, "at the stated instants"),
            ("accelerations", Channel.ACCELERATION, "at the stated instants, without subtracting gravity"),
            ("drive torque", Channel.TORQUE, "the torque of the drive on the crank"),
            ("joint forces", Channel.JOINT_FORCE, "on each joint's first body, in the ground frame"),
        )
    ),
)
