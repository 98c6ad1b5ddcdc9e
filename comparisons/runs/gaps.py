"""Where the samples of a run leave out more of the motion than a few of the engine's own steps."""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from engines.scene import Drive, Prescribed

Array = NDArray[np.float64]

# A gap is longer than so many of the engine's own steps: anywhere, and where it may start anew, at the borders of the
# motion's parts. Measured of every engine and setting over the catalogue's motions, swings with dwells and released
# cranks: up to 1.7 anywhere, and 4 at borders, where pymunk's ``best`` has no forces for three samples.
GAP, BORDER_GAP = 2.5, 5.0
NEIGHBOURS = 5  # steps on either side, whose median is the engine's own step there
LONG = 0.9  # of all steps turn a prescribed driver less than a long one, which a short part of a slow motion may have
ROUNDING = 1e-9  # of the duration


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
