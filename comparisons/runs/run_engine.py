"""Trying a scene in an engine: whatever it does, a run comes back, and one that finished is whole."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from comparisons.observation.interpolation import POINTS
from engines.contract import Engine, History, Outcome, Run, Setting, Signal
from engines.scene import Channel, Scene


def attempt(adapter: Engine, model: Scene, setting: Setting) -> Run:
    """A run whose every exception is a failed run: one engine's fault may not end what the others do.

    A scene the engine cannot hold is not tried, and a run that finished has recorded all it was asked for, finite.
    MemoryError alone is raised: what it means is for whoever set the bound (``comparisons.runs.workers``) to say.
    """
    try:
        obstacle = adapter.obstacle(model)
        run = adapter.run(model, setting) if obstacle is None else Run(Outcome.UNSUPPORTED, obstacle)
    except MemoryError:
        raise
    except Exception as error:
        words = " ".join(str(error).split())
        return Run(Outcome.DIVERGED, f"{adapter.name} raised {type(error).__name__}: {words}")
    return _checked(run, model)


def _checked(run: Run, model: Scene) -> Run:
    """A run that claims to have finished, held to having returned every channel asked for, finite throughout."""
    if run.outcome is not Outcome.FINISHED:
        return run
    history = run.history
    for channel, signal in _signals(history, model):
        if signal is None or len(signal.time) < POINTS:
            return replace(run, outcome=Outcome.DIVERGED, reason=f"finished without recording {channel}")
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
        for name in [j.name for j in model.pins] + [j.name for j in model.sliders] + [j.name for j in model.slots]:
            yield f"the force of joint {name}", history.joint_force.get(name) if history else None
