"""Histories made of histories, signal by signal."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from engines.contract import History, Signal

CHANNELS = ("position", "velocity", "acceleration", "torque")  # of one signal each


def combined(histories: Sequence[History], combine: Callable[[Sequence[Signal]], Signal]) -> History:
    """One history, each signal made of those of its channel; a channel is None where all histories lack it."""

    def of_channel(name: str) -> Signal | None:
        present = [signal for history in histories if (signal := getattr(history, name)) is not None]
        return combine(present) if present else None

    forces = {name: combine([history.joint_force[name] for history in histories]) for name in histories[0].joint_force}
    position, velocity, acceleration, torque = map(of_channel, CHANNELS)
    return History(position, velocity, acceleration, torque, forces)


def joined(histories: Sequence[History]) -> History:
    """Histories of consecutive parts of a run as one; a channel is None in all or in none."""

    def end_to_end(signals: Sequence[Signal]) -> Signal:
        time, values = (np.concatenate([getattr(signal, name) for signal in signals]) for name in ("time", "values"))
        return replace(signals[0], time=time, values=values)

    return combined(histories, end_to_end)


def labelled(history: History) -> Iterator[tuple[str, Signal]]:
    """Every signal of a history with its name in words."""
    for name in CHANNELS:
        signal = getattr(history, name)
        if signal is not None:
            yield "drive torque" if name == "torque" else name, signal
    for name, signal in history.joint_force.items():
        yield f"force in joint '{name}'", signal
