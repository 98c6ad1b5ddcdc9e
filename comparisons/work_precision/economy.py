"""What leaving things out saves: scenes whole and reduced, run in turn, and the closed form by what is asked of it.

Times are of whole runs as a campaign makes them: checking, building, stepping, reading out. The runs take turns, every
second round backwards, so that whatever else the machine does falls on all of them alike; every repeat is kept.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final, TypeVar

import numpy as np

from analytic.compiled.evaluation import available, is_ready
from analytic.description.crank_motion import crank_motion
from analytic.description.linkage import Linkage
from analytic.evaluation import evaluate
from analytic.kinematics.mechanism import Mechanism
from comparisons.reference.start_state import scene
from comparisons.runs.run_engine import attempt
from comparisons.work_precision.economy_records import AngleCost, Economy, RunCost
from comparisons.work_precision.reductions import ASKS, OUTPUT, REDUCTIONS, Ask, Reduction, rest_of
from engines.contract import Engine, History, Outcome, Run, Setting
from engines.registry import engine
from engines.scene import Prescribed, Scene

Found = TypeVar("Found")

BUDGET: Final = 8.0  # s for everything, if the fewest rounds fit into it
CLOSED_FORM_SHARE: Final = 0.1  # of the budget
FEWEST, MOST = 3, 15  # rounds
# Crank angles in a repeat of the closed form, by path: some milliseconds, beside which a call's own cost is nothing.
ANGLES: Final = {"numpy": 20_000, "compiled": 200_000}


def measure(
    linkages: Sequence[Linkage],
    engines: Sequence[str],
    setting: Setting = Setting.TUNED,
    budget: float = BUDGET,
    paths: Sequence[str] | None = None,
) -> Economy:
    """Run every reduction of these linkages in these engines, and the closed form, in about ``budget`` seconds.

    A reduction that takes out what a linkage has not is left out; what an engine cannot do is a row with its outcome.
    ``paths`` are those of ``evaluate``; by default NumPy's, and the compiled one if nothing has to be compiled for it.
    """
    runs = run_costs(linkages, engines, setting, (1.0 - CLOSED_FORM_SHARE) * budget)
    ready = ("numpy", "compiled") if available() and is_ready() else ("numpy",)
    angles = angle_costs(linkages, ready if paths is None else paths, CLOSED_FORM_SHARE * budget)
    return Economy(tuple(runs), tuple(angles))


@dataclass(frozen=True)
class _Trial:
    """One reduction of one linkage in one engine."""

    linkage: Linkage
    adapter: Engine
    reduction: Reduction
    model: Scene

    def made(self, setting: Setting) -> tuple[Run, int]:
        """A run and how many numbers it recorded; these themselves are let go."""
        run = attempt(self.adapter, self.model, setting)
        return replace(run, history=None), recorded(run.history)


def fullest(linkages: Sequence[Linkage]) -> Linkage:
    """The linkage with most in it to be left out, the first of several."""
    return max(linkages, key=lambda linkage: sum(rest_of(linkage, part) is not None for part in (*REDUCTIONS, *ASKS)))


def run_costs(linkages: Sequence[Linkage], engines: Sequence[str], setting: Setting, budget: float) -> list[RunCost]:
    """The engines' part; once per engine a run goes before, for imports and whatever else is done only once."""
    adapters = [engine(name) for name in engines]
    reduced = [(linkage, scenes(linkage)) for linkage in linkages]
    trials = [_Trial(a, adapter, *part) for a, parts in reduced for adapter in adapters for part in parts]
    for adapter in adapters:
        attempt(adapter, reduced[0][1][-1][1], setting)
    repeats = interleaved([partial(trial.made, setting) for trial in trials], budget)
    return [_run_cost(trial, setting, done) for trial, done in zip(trials, repeats, strict=True)]


def scenes(linkage: Linkage) -> list[tuple[Reduction, Scene]]:
    """The whole scene of a linkage, brought to speed in a short run-up, and those with less in them."""
    drive = Prescribed(crank_motion("run-up-quintic", ramp_time=0.15, hold_time=0.03))
    rests = [(reduction, rest_of(linkage, reduction)) for reduction in REDUCTIONS]
    return [(one, scene(Mechanism(rest), drive, one.channels)) for one, rest in rests if rest is not None]


def _run_cost(trial: _Trial, setting: Setting, done: Sequence[tuple[float, tuple[Run, int]]]) -> RunCost:
    _, (run, values) = done[-1]
    return RunCost(
        mechanism=trial.linkage.name,
        variant=trial.linkage.variant,
        engine=trial.adapter.name,
        engine_version=trial.adapter.version() or "",
        setting=setting.value,
        reduction=trial.reduction.name,
        about=trial.reduction.about,
        outcome=run.outcome.value,
        reason="" if run.outcome is Outcome.FINISHED else run.reason,
        seconds=tuple(seconds for seconds, _ in done),
        stepping=tuple(one.seconds for _, (one, _) in done),
        steps=run.steps,
        bodies=len(trial.model.bodies),
        conditions=conditions(trial.model),
        loads=loads(trial.model),
        values=values,
    )


def conditions(model: Scene) -> int:
    """Equations of joints and drive: two for a pin, one for a slot and for a slider's line, one for a held angle."""
    turning = {body.name for body in model.bodies if body.inertia is not None}
    held = sum(bool(turning & {joint.body, joint.host}) for joint in model.sliders)
    return 2 * len(model.pins) + len(model.guided) + held + isinstance(model.drive, Prescribed)


def loads(model: Scene) -> int:
    """Weights, forces, torques, springs and dampers."""
    weights = len(model.bodies) if any(model.gravity) else 0
    return weights + len(model.forces) + len(model.torques) + len(model.springs) + len(model.dampers)


def recorded(history: History | None) -> int:
    """Numbers in a history, times not counted."""
    if history is None:
        return 0
    signals = (history.position, history.velocity, history.acceleration, history.torque, *history.joint_force.values())
    return sum(signal.values.size for signal in signals if signal is not None)


@dataclass(frozen=True)
class _Question:
    """One thing asked of the closed form of one linkage, by one path."""

    linkage: Linkage
    path: str
    ask: Ask
    quantities: tuple[str, ...]
    mechanism: Mechanism

    def answer(self) -> None:
        """Evaluate it at as many crank angles as its path is asked for, and let the values go."""
        angle = np.linspace(0.0, 100.0, ANGLES[self.path])
        motion = {"speed": self.ask.speed, "acceleration": self.ask.acceleration}
        evaluate(self.mechanism, angle, self.quantities, **motion, path=self.path)


def angle_costs(linkages: Sequence[Linkage], paths: Sequence[str], budget: float) -> list[AngleCost]:
    """The closed form's part; once per path a question goes before."""
    asked = [(one, path, ask, _names(one, ask)) for one in linkages for path in paths for ask in ASKS]
    rests = [(part, rest_of(part[0], part[2])) for part in asked if part[3]]
    questions = [_Question(*part, Mechanism(rest)) for part, rest in rests if rest is not None]
    for question in {question.path: question for question in questions}.values():
        question.answer()
    repeats = interleaved([question.answer for question in questions], budget)
    return [_angle_cost(question, done) for question, done in zip(questions, repeats, strict=True)]


def _angle_cost(question: _Question, done: Sequence[tuple[float, None]]) -> AngleCost:
    return AngleCost(
        mechanism=question.linkage.name,
        variant=question.linkage.variant,
        path=question.path,
        reduction=question.ask.name,
        quantities=question.quantities,
        angles=ANGLES[question.path],
        seconds=tuple(spent for spent, _ in done),
    )


def _names(linkage: Linkage, ask: Ask) -> tuple[str, ...]:
    """The quantities asked for that the linkage has."""
    return tuple(name for name in ask.quantities if linkage.output is not None or name not in OUTPUT)


def interleaved(jobs: Sequence[Callable[[], Found]], budget: float) -> list[list[tuple[float, Found]]]:
    """Do all jobs in turn, round after round while the budget, s, lasts: seconds and result of every repeat by job.

    The fewest rounds are made whatever they take.
    """
    found: list[list[tuple[float, Found]]] = [[] for _ in jobs]
    order = list(zip(jobs, found, strict=True))
    begun = time.perf_counter()
    for number in range(1, MOST + 1):
        for job, done in order:
            start = time.perf_counter()
            result = job()
            done.append((time.perf_counter() - start, result))
        order.reverse()
        spent = time.perf_counter() - begun
        if number >= FEWEST and spent * (number + 1) / number > budget:
            break
    return found
