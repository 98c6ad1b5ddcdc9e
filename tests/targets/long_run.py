"""A thousand turns: are joints and torque in the last turn what they were in the first?"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any, Final

import numpy as np

from analytic.description.crank_motion import RPM, crank_motion
from analytic.description.loading import load
from analytic.kinematics.mechanism import Mechanism
from comparisons.invariants.invariants import joint_gaps
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.case import Case
from comparisons.runs.failures import GIB, Lost
from comparisons.runs.run_engine import run_engine
from comparisons.runs.study import Study, Task
from comparisons.runs.workers import Bounds
from engines.contract import Outcome, Setting, Signal
from engines.registry import engine
from engines.scene import Channel

TURNS: Final = 1000
SPEED: Final = 1000.0  # rpm
# Of the peak, or of the link: a smaller error is the rounding of a body's angle, which after all turns is large.
LEAST: Final = float(np.finfo(float).eps) * 2.0 * np.pi * TURNS
BOUNDS: Final = Bounds(300.0, 4 * GIB)


@dataclass(frozen=True)
class LongRun:
    """Largest joint gap (over the shortest link) and torque error (over its peak) in the first and the last turn."""

    mechanism: str
    engine: str
    setting: str
    turns: int
    outcome: str
    reason: str = ""
    gap_first: float | None = None
    gap_last: float | None = None
    torque_first: float | None = None
    torque_last: float | None = None
    seconds: float = 0.0
    steps: int = 0


def long_runs(
    engines: Sequence[str],
    mechanisms: Sequence[str] = (),
    setting: Setting = Setting.TUNED,
    turns: int = TURNS,
) -> Iterator[LongRun]:
    """Mechanisms (catalogue names or files) turned at constant speed in every engine that is installed."""
    installed = [name for name in engines if engine(name).version() is not None]
    tasks = [
        Task(f"long run/{mechanism}/{name}/{setting}/{turns}", (mechanism, name, setting, turns))
        for mechanism in mechanisms
        for name in installed
    ]
    return Study(long_run, _lost, lambda run: (asdict(run), {}), _read).in_order(tasks, BOUNDS)


def _lost(lost: Lost, name: str, engine_name: str, setting: Setting, turns: int) -> LongRun:
    return LongRun(load(name).name, engine_name, setting.value, turns, lost.outcome.value, lost.reason)


def _read(row: Mapping[str, Any], _: object) -> LongRun:
    return LongRun(**{field.name: row[field.name] for field in fields(LongRun)})


def long_run(name: str, engine_name: str, setting: Setting, turns: int) -> LongRun:
    """One mechanism in one engine for so many turns."""
    mechanism = Mechanism(load(name))
    seconds = turns * 60.0 / SPEED
    motion = crank_motion("constant-speed", speed=SPEED * RPM, ramp_time=seconds, hold_time=0.0)
    case = Case(mechanism, motion)
    scene = case.scene([Channel.POSITION, Channel.TORQUE])
    run = run_engine(engine(engine_name), scene, setting)
    blank = LongRun(mechanism.linkage.name, engine_name, setting.value, turns, run.outcome.value, run.reason)
    if run.outcome is not Outcome.FINISHED or run.history is None:
        return blank
    observed = ObservedMotion(scene, run.history)
    gaps = joint_gaps(observed)
    torque = observed.signal(Channel.TORQUE)
    link = mechanism.linkage.shortest_length()
    gap_first, gap_last = _ends(Signal(gaps.time, gaps.values / link), seconds, turns)
    off, off_last = _ends(_torque_error(case, torque), seconds, turns)
    return LongRun(
        mechanism.linkage.name,
        engine_name,
        setting.value,
        turns,
        run.outcome.value,
        gap_first=gap_first,
        gap_last=gap_last,
        torque_first=off,
        torque_last=off_last,
        seconds=run.seconds,
        steps=run.steps,
    )


def _torque_error(case: Case, torque: Signal) -> Signal:
    truth = case.at(torque.time).torque
    return Signal(torque.time, np.abs(torque.values - truth) / float(np.max(np.abs(truth))))


def _ends(signal: Signal, seconds: float, turns: int) -> tuple[float, float]:
    """Largest value within the first and within the last turn."""
    turn = seconds / turns
    first, last = signal.time <= turn, signal.time >= seconds - turn
    return float(np.max(signal.values[first])), float(np.max(signal.values[last]))
