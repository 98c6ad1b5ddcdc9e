"""A run cut into stretches, each started anew, in a whole number of basic steps."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import Segment
from engines.exudyn_adapter.recipes import Recipe
from engines.scene import Free, Prescribed, Scene

Array = NDArray[np.float64]

FULL_TURN = 2.0 * math.pi
ROUNDING = 1e-9  # of a speed
GRADES = (0.5, 0.75)  # of the peak speed: where the step changes; no step is more than twice another's
SAMPLED = 64  # places of a segment at which its speed is looked at


@dataclass(frozen=True)
class Stretch:
    """A part of a run between fresh starts, in ``samples`` basic steps.

    If the motion is prescribed it lies in one ``segment`` of it. ``after_jump``: the acceleration jumps at its start.
    """

    start: float
    end: float
    samples: int
    segment: Segment | None = None
    after_jump: bool = False

    @property
    def step(self) -> float:
        """Basic step, s."""
        return (self.end - self.start) / self.samples


def prescribed_stretches(scene: Scene, recipe: Recipe) -> list[Stretch]:
    """The motion's segments in steps as the recipe has them; none for a free crank."""
    drive = scene.drive
    if not isinstance(drive, Prescribed):
        return []
    segments = drive.motion.segments
    if recipe.rule.as_shipped:
        return [Stretch(segments[0].start, segments[-1].end, _steps(drive.motion.duration / recipe.step, recipe))]
    peak, jumps = drive.motion.peak_speed, drive.motion.jumps
    return [
        stretch
        for segment in segments
        for stretch in _segment_stretches(segment, segment is not segments[0] and segment.start in jumps, peak, recipe)
    ]


def _segment_stretches(segment: Segment, after_jump: bool, peak: float, recipe: Recipe) -> Iterator[Stretch]:
    """A segment in parts of about one speed, in steps of as many per turn of a part's fastest, cut every few turns.

    Loads by inertia grow with the square of the speed, so a slow part's error is small beside the peak of a fast one.
    Steps given in seconds stay what they are at any speed.
    """
    time = np.linspace(segment.start, segment.end, SAMPLED + 1)
    speed = np.abs(segment.value(time, 1))
    cuts = [0, *(_grade_changes(speed, peak) if recipe.steps_per_turn else []), SAMPLED]
    longest = min(recipe.step, (segment.end - segment.start) / recipe.least_steps)
    for first, last in pairwise(cuts):
        length = float(time[last] - time[first])
        turns = length * float(speed[first : last + 1].max()) / FULL_TURN
        pieces = max(1, math.ceil(turns / recipe.turns - 1e-6))
        samples = max(1, math.ceil(max(length / longest, turns * recipe.steps_per_turn) / pieces - 1e-6))
        for start, end in pairwise(np.linspace(time[first], time[last], pieces + 1).tolist()):
            yield Stretch(start, end, samples, segment, after_jump)
            after_jump = False


def _grade_changes(speed: Array, peak: float) -> list[int]:
    """Where speeds (n,) sampled over a segment pass a grade, within it."""
    grade = np.digitize(speed, np.multiply(GRADES, peak * (1.0 + ROUNDING)))  # an even speed has one grade
    changes = np.flatnonzero(np.diff(grade)) + 1
    return [int(change) for change in changes if change < len(speed) - 1]


def free_stretch(drive: Free, recipe: Recipe, step: float) -> Stretch:
    """All of a free crank's motion in steps of at most ``step``, s."""
    return Stretch(0.0, drive.duration, _steps(drive.duration / step, recipe))


def wanted_step(pace: float, recipe: Recipe) -> float:
    """The basic step for a crank that shows a pace, rad/s."""
    return FULL_TURN / (recipe.steps_per_turn * pace) if pace > 0.0 else math.inf


def _steps(wanted: float, recipe: Recipe) -> int:
    return max(recipe.least_steps, math.ceil(wanted - 1e-6))
