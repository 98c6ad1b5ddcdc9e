"""Samples of a course, channel by channel, as a history."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from engines.contract import Array, History, Signal
from engines.scene import Channel
from engines.stepping.histories import joined
from engines.stepping.intervals import Interval

State = Mapping[Channel, Any]  # what a history has at one instant, by channel


def recorded(
    parts: Sequence[Interval],
    joints: Iterable[str],
    states: Callable[[Interval, Array], Iterable[State]],
) -> History:
    """What ``states`` gives at equal times over each part, from its start to its end, as one history that was read.

    By channel that is what a history has at one instant, the forces of ``joints`` in their order. Of the two samples
    between parts the later part's counts.
    """
    return joined([_of_part(part, joints, states, None if part is parts[-1] else -1) for part in parts])


def _of_part(
    part: Interval,
    joints: Iterable[str],
    states: Callable[[Interval, Array], Iterable[State]],
    end: int | None,
) -> History:
    time = np.linspace(part.start, part.end, part.samples + 1)
    samples = list(states(part, time))
    signals = {
        channel: Signal(time[:end], np.array([sample[channel] for sample in samples])[:end]) for channel in samples[0]
    }
    forces = signals.pop(Channel.JOINT_FORCE, None)
    by_joint = {} if forces is None else {j: replace(forces, values=forces.values[:, n]) for n, j in enumerate(joints)}
    return History(**{channel.value: signal for channel, signal in signals.items()}, joint_force=by_joint)
