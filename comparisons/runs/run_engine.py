"""Running a scene in an engine: a run comes back, and one that finished is whole."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from comparisons.observation.interpolation import POINTS
from comparisons.runs.failures import blamed_on
from engines.contract import Engine, Method, Outcome, Run, Setting, Signal, StudiedEngine
from engines.scene import Channel, Drive, Prescribed, Scene

Array = NDArray[np.float64]

# A gap is longer than so many of the engine's own steps: anywhere, and where it may start anew, at the borders of the
# motion's parts. Measured of every engine and setting over the catalogue's motions, swings with dwells and released
# cranks: up to 1.7 anywhere, and 4 at borders, where pymunk's ``best`` has no forces for three samples.
GAP, BORDER_GAP = 2.5, 5.0
NEIGHBOURS = 5  # steps on either side, whose median is the engine's own step there
LONG = 0.9  # of all steps turn a prescribed driver less than a long one, which a short part of a slow motion may have
ROUNDING = 1e-9  # of the duration


def run_engine(adapter: Engine, model: Scene, way: Setting | Method, step: float | None = None) -> Run:
    """The run of a scene by a setting, or by a method at a longest ``step``, s.

    What a run that finished has recorded is finite and covers the whole motion.
    Raises AdapterError for every exception of the adapter but MemoryError, which whoever set the bound explains
    (``comparisons.runs.failures``).
    """
    with blamed_on(adapter):
        return checked(started(adapter, model, way, step), model)


def started(adapter: Engine, model: Scene, way: Setting | Method, step: float | None) -> Run:
    """What the adapter returns, as it is."""
    if isinstance(way, Setting):
        return adapter.run(model, way)
    assert step is not None
    assert isinstance(adapter, StudiedEngine)
    return adapter.run_method(model, way, step)


def checked(run: Run, model: Scene) -> Run:
    """A run that claims to have finished, held to samples that can be read and that cover the whole motion."""
    run = readable(run, model)
    holes = {name: gap(signal.time, model.drive) for name, signal in _signals(run, model)}
    for name, hole in holes.items():
        if hole:
            return replace(run, outcome=Outcome.DIVERGED, reason=f"{name} has no samples {hole}")
    return run


def readable(run: Run, model: Scene) -> Run:
    """A run that claims to have finished, held to samples that can be read between and are finite throughout."""
    for name, signal in _signals(run, model):
        if len(signal.time) < POINTS:
            reason = f"{name} has {len(signal.time)} samples, too few to read between"
            return replace(run, outcome=Outcome.DIVERGED, reason=reason)
        finite = np.isfinite(signal.values).reshape(len(signal.time), -1).all(axis=1)
        if not finite.all():
            at = float(signal.time[int(np.argmin(finite))])
            return replace(run, outcome=Outcome.DIVERGED, reason=f"{name} is not finite from {at:.4g} s on")
    return run


def gap(time: Array, drive: Drive) -> str:
    """Where samples at these times (n,), s, leave out more than a few of their own steps, in words; empty if nowhere.

    Before the first and behind the last sample counts too. The own step is the median of those before or of those
    after, the larger one: it may change from one part of a motion to the next. Between samples a gap also turns a
    prescribed driver further than long steps do.
    """
    borders = _borders(drive)
    instants = np.concatenate([borders[:1], time, borders[-1:]])
    steps = np.diff(instants)
    medians = np.median(sliding_window_view(np.pad(steps, NEIGHBOURS, mode="reflect"), NEIGHBOURS), axis=1)
    own = np.maximum(medians[: len(steps)], medians[-len(steps) :])
    before, behind = instants[:-1] - ROUNDING * borders[-1], instants[1:] + ROUNDING * borders[-1]
    at_border = np.searchsorted(borders, before) < np.searchsorted(borders, behind, "right")
    beyond = steps - np.where(at_border, BORDER_GAP, GAP) * own
    if isinstance(drive, Prescribed):
        turned = np.abs(np.diff(drive.motion.angle(instants)))[1:-1]
        beyond[1:-1][turned <= GAP * np.quantile(turned, LONG)] = 0.0
    worst = int(np.argmax(beyond))
    if not beyond[worst] > 0.0:
        return ""
    return f"from {instants[worst]:.4g} to {instants[worst + 1]:.4g} s, where its own step is {own[worst]:.2g} s"


def _borders(drive: Drive) -> Array:
    """Start and end of a motion, and where a part of it ends or its torque has a kink between, s."""
    if isinstance(drive, Prescribed):
        return np.array([0.0, *(segment.end for segment in drive.motion.segments)])
    kinks = drive.over_time.times if drive.over_time else ()
    return np.array([0.0, *(kink for kink in kinks if 0.0 < kink < drive.duration), drive.duration])


def _signals(run: Run, model: Scene) -> Iterator[tuple[str, Signal]]:
    """Every signal that a scene asks for and a finished run has, by name."""
    if run.outcome is not Outcome.FINISHED or run.history is None:
        return
    for channel in sorted(model.channels - {Channel.JOINT_FORCE}):
        if (signal := getattr(run.history, channel.value)) is not None:
            yield channel.value, signal
    if Channel.JOINT_FORCE in model.channels:
        for joint in (*model.pins, *model.guided):
            if (signal := run.history.joint_force.get(joint.name)) is not None:
                yield f"the force of joint {joint.name}", signal
