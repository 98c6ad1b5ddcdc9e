"""What each output and load costs: scenes whole and reduced, and the closed form query by query.

Times of scenes are of whole runs: checking, building, stepping, reading out. All jobs take turns, every second round
backwards, so that a slow spell of the machine falls on all of them alike; every repeat is kept.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Final

import numpy as np

from analytic.description.crank_motion import crank_motion
from analytic.description.linkage import Linkage
from analytic.evaluation import evaluate
from analytic.kinematics.mechanism import Mechanism
from comparisons.reference.start_state import scene
from comparisons.runs.failures import AdapterError
from comparisons.runs.run_engine import run_engine
from comparisons.work_precision.records import MeasuredCost
from comparisons.work_precision.reductions import QUERIES, REDUCTIONS, reduced
from engines.contract import Engine, Outcome, Run, Setting
from engines.registry import engine
from engines.scene import Prescribed, Scene

BUDGET: Final = 8.0  # s for everything, if the fewest rounds fit into it
FEWEST, MOST = 3, 15  # rounds
# Crank angles in a repeat of the closed form: some milliseconds, beside which a call's own cost is nothing.
ANGLES: Final = 20_000

Job = Callable[[], Run | None]  # what an engine's run came to, without its history; None for the closed form


def measure(linkage: Linkage, engines: Sequence[str], budget: float | None = None) -> list[MeasuredCost]:
    """Every reduction of a linkage in these engines, then every query, in about ``budget`` seconds (``BUDGET``).

    A reduction that takes out what the linkage has not is left out; what an engine cannot do is a row with its outcome.
    """
    jobs = [*run_jobs(linkage, engines), *query_jobs(linkage)]
    for job in {cost.solver: job for cost, job in jobs}.values():
        job()  # imports, and whatever else is done only once
    repeats = interleaved([job for _, job in jobs], BUDGET if budget is None else budget)
    return [_measured(cost, done) for (cost, _), done in zip(jobs, repeats, strict=True)]


def most_reducible(linkages: Sequence[Linkage]) -> Linkage:
    """The linkage with most in it to be left out, the first of several."""
    parts = (*REDUCTIONS, *QUERIES)
    return max(linkages, key=lambda linkage: sum(reduced(linkage, part) is not None for part in parts))


def run_jobs(linkage: Linkage, engines: Sequence[str]) -> Iterator[tuple[MeasuredCost, Job]]:
    """A run of every reduction in every engine, brought to speed in a short run-up."""
    drive = Prescribed(crank_motion("run-up-quintic", ramp_time=0.15, hold_time=0.03))
    rests = [(part, reduced(linkage, part)) for part in REDUCTIONS]
    models = [(part, scene(Mechanism(rest), drive, part.channels)) for part, rest in rests if rest is not None]
    for name in engines:
        adapter = engine(name)
        for part, model in models:
            cost = MeasuredCost(linkage.name, linkage.variant, name, part.name, part.about)
            yield replace(cost, is_control=adapter.is_control), partial(_run, adapter, model)


def _run(adapter: Engine, model: Scene) -> Run:
    try:
        return replace(run_engine(adapter, model, Setting.TUNED), history=None)
    except AdapterError as error:
        return Run(Outcome.DIVERGED, str(error))


def query_jobs(linkage: Linkage) -> Iterator[tuple[MeasuredCost, Job]]:
    """An evaluation of every query by NumPy; queries for what the linkage has not are left out."""
    angle = np.linspace(0.0, 100.0, ANGLES)
    for query in QUERIES:
        names, rest = query.names(linkage), reduced(linkage, query)
        if names and rest is not None:
            question = partial(evaluate, Mechanism(rest), angle, names, path="numpy")
            work = partial(question, speed=query.speed, acceleration=query.acceleration)
            cost = MeasuredCost(linkage.name, linkage.variant, "numpy", query.name, ", ".join(names), len(angle))
            yield cost, partial(_forgotten, work)


def _forgotten(work: Callable[[], object]) -> None:
    """Do the work and discard its result."""
    work()


def _measured(cost: MeasuredCost, done: Sequence[tuple[float, Run | None]]) -> MeasuredCost:
    """A cost with its repeats and, where an engine ran, what came of the last of them."""
    seconds, runs = tuple(spent for spent, _ in done), [run for _, run in done if run is not None]
    if not runs:
        return replace(cost, seconds=seconds)
    return replace(
        cost,
        outcome=runs[-1].outcome.value,
        reason="" if runs[-1].outcome is Outcome.FINISHED else runs[-1].reason,
        seconds=seconds,
        stepping=tuple(run.seconds for run in runs),
        steps=runs[-1].steps,
    )


def interleaved(jobs: Sequence[Job], budget: float) -> list[list[tuple[float, Run | None]]]:
    """Do all jobs in turn, round after round while the budget, s, lasts: seconds and result of every repeat by job.

    The fewest rounds are made whatever they take.
    """
    repeats: list[list[tuple[float, Run | None]]] = [[] for _ in jobs]
    order = list(zip(jobs, repeats, strict=True))
    begun = time.perf_counter()
    for number in range(1, MOST + 1):
        for job, done in order:
            start = time.perf_counter()
            run = job()
            done.append((time.perf_counter() - start, run))
        order.reverse()
        spent = time.perf_counter() - begun
        if number >= FEWEST and spent * (number + 1) / number > budget:
            break
    return repeats
