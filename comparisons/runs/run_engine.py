"""Running a scene in an engine: a run comes back, and one that finished is whole."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from comparisons.observation.interpolation import POINTS
from comparisons.runs.failures import blamed_on
from engines.contract import Engine, History, Method, Outcome, Run, Setting, Signal, StudiedEngine
from engines.scene import Channel, Scene


def run_engine(adapter: Engine, model: Scene, way: Setting | Method, step: float | None = None) -> Run:
    """The run of a scene by a setting, or by a method at a longest ``step``, s.

    What a run that finished has recorded is finite.
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
    """A run that claims to have finished, held to samples that can be read between and are finite throughout."""
    if run.outcome is not Outcome.FINISHED:
        return run
    history = run.history
    for channel, signal in _signals(history, model):
        if signal is None:
            continue
        if len(signal.time) < POINTS:
            reason = f"{channel} has {len(signal.time)} samples, too few to read between"
            return replace(run, outcome=Outcome.DIVERGED, reason=reason)
        finite = np.isfinite(signal.values).reshape(len(signal.time), -1).all(axis=1)
        if not finite.all():
            at = float(signal.time[int(np.argmin(finite))])
            return replace(run, outcome=Outcome.DIVERGED, reason=f"{channel} is not finite from {at:.4g} s on")
    return run


def _signals(history: History | None, model: Scene) -> Iterator[tuple[str, Signal | None]]:
    """Every signal a scene asks for, by name; None where the history lacks it."""
    for channel in sorted(model.channels - {Channel.JOINT_FORCE}):
        yield channel.value, getattr(history, channel.value, None)
    if Channel.JOINT_FORCE in model.channels:
        for joint in (*model.pins, *model.guided):
            yield f"the force of joint {joint.name}", history.joint_force.get(joint.name) if history else None
