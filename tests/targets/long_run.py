"""A thousand turns at constant speed: are joints and torque in the last turn what they were in the first?"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from analytic.description.crank_motion import RPM, crank_motion
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.invariants.checks import joint_gaps
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.case import Case
from comparisons.runs.run_engine import GIB, Lost, run_engine
from comparisons.runs.workers import Bounds, run_jobs
from engines.contract import Array, Setting
from engines.registry import engine
from engines.scene import Channel

SPEED: Final = 1000.0  # rpm
# Of the peak, or of the link: a smaller error is the rounding of a body's angle, which after 1000 turns is large.
LEAST: Final = float(np.finfo(float).eps) * 2.0 * np.pi * 1000
BOUNDS: Final = Bounds(300.0, 4 * GIB)


@dataclass(frozen=True)
class LongRun:
    """Largest joint gap (over the shortest link) and torque error (over its peak), each in the first and last turn."""

    gap: tuple[float, float]
    torque: tuple[float, float]
    steps: int = 0

    @property
    def growth(self) -> float:
        """The worse of the two ratios, last turn over first; rounding does not count."""
        return max(max(last, LEAST) / max(first, LEAST) for first, last in (self.gap, self.torque))

    def __str__(self) -> str:
        gap, torque = (f"{first:.1e}, then {last:.1e}" for first, last in (self.gap, self.torque))
        return f"gap {gap} of the shortest link; torque error {torque} of peak; {self.steps} steps"


def long_run(name: str, linkage: str, setting: Setting, turns: int) -> LongRun | str:
    """One linkage (name or file) in one engine for so many turns; the reason where there is no motion."""
    mechanism, seconds = Mechanism(load(linkage)), turns * 60.0 / SPEED
    case = Case(mechanism, crank_motion("constant-speed", speed=SPEED * RPM, ramp_time=seconds, hold_time=0.0))
    scene = case.scene([Channel.POSITION, Channel.TORQUE])
    run = run_engine(engine(name), scene, setting)
    if run.history is None:
        return f"{run.outcome}: {run.reason}"
    observed = ObservedMotion(scene, run.history)
    gaps, torque = joint_gaps(observed), observed.signal(Channel.TORQUE)
    truth = case.at(torque.time).torque
    errors = np.abs(torque.values - truth) / float(np.max(np.abs(truth)))

    def ends(time: Array, values: Array) -> tuple[float, float]:
        first, last = time <= seconds / turns, time >= seconds - seconds / turns
        return float(np.max(values[first])), float(np.max(values[last]))

    gap = ends(gaps.time, gaps.values / mechanism.linkage.shortest_length())
    return LongRun(gap, ends(torque.time, errors), run.steps)


def long_runs(
    engines: Sequence[str], linkages: Sequence[str], setting: Setting, turns: int
) -> Iterator[tuple[str, LongRun | str]]:
    """The runs in every engine that is installed, each with the names of its engine and linkage, in any order."""
    jobs = [(name, linkage, setting, turns) for linkage in linkages for name in engines if engine(name).version()]
    for job, result in run_jobs(long_run, jobs, bounds=BOUNDS):
        words = f"{result.outcome}: {result.reason}" if isinstance(result, Lost) else result
        yield ", ".join(jobs[job][:2]), words
