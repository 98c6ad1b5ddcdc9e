"""Engines' values for printed figures: signals of a crank that turns steadily up to their angles, or is released.

A figure of another kind, a stroke or a range, is the closed form's alone.
"""

from __future__ import annotations

import math
import pickle
from collections.abc import Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import Linkage
from analytic.description.schema import Published
from analytic.designs.figures import Figure
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import COMPONENTS, ORDERS, table
from comparisons.datasheet.figures import figures_by_name
from comparisons.datasheet.published import (
    PrintedMotion,
    PublishedRecord,
    case_of_motion,
    motion_of_figure,
    published_figures,
    record_fields,
    rename_signal,
)
from comparisons.observed_motion import ObservedMotion, resample
from comparisons.reference.case import Case, unpickle_case
from comparisons.runs.plugins import engine
from comparisons.runs.run_engine import Lost, run_engine
from comparisons.runs.study import Announce, Study, Task
from comparisons.runs.workers import DEFAULT_BOUNDS, Bounds, LocalPool, Pool, usual_processes
from engines.contract import Outcome, Setting
from engines.scene import Channel

Array = NDArray[np.float64]
Answers = dict[str, Any]  # the ``values``, SI, of one run, None for a missing one, and the ``reason``
Terms = tuple[tuple[Figure, ...], ...]  # by entry its figure, and one to subtract

LEVELS: Final = (Channel.POSITION, Channel.VELOCITY, Channel.ACCELERATION)
DRIVE: Final = ("phi", "omega", "epsilon")


@dataclass(frozen=True)
class EngineAnswer(PublishedRecord):
    """A printed figure beside an engine's, which is None with a ``reason`` if the engine has no value.

    ``uncertainty`` is the figure's own: half its last digit, or its source's accuracy where that is known to be less.
    """

    engine: str
    uncertainty: float
    reason: str


@dataclass(frozen=True)
class PrintedRun:
    """Printed figures whose values follow from one run of a case."""

    case: Case
    entries: tuple[Published, ...]
    terms: Terms


def engine_answers(
    linkages: Iterable[Linkage],
    engines: Sequence[str],
    announce: Announce = lambda *_: None,
    *,
    bounds: Bounds = DEFAULT_BOUNDS,
    pool: Pool | None = None,
) -> Iterator[EngineAnswer]:
    """Every engine's answer, tuned, to every printed signal of the linkages at an angle or a time."""
    printed = [printed_run for linkage in linkages for printed_run in _printed_runs(linkage)]
    tasks = [_task(number, printed_run, name) for number, printed_run in enumerate(printed) for name in engines]
    where = pool or LocalPool(usual_processes(len(tasks)))
    study = Study(run_and_read, _lost_answers, lambda row: (row, {}), lambda row, _: dict(row), None, announce, where)
    with closing(study.in_order(tasks, bounds)) as runs:
        for printed_run in printed:
            for name, run in zip(engines, runs, strict=False):
                yield from _engine_answers(printed_run, name, run)


def _printed_runs(linkage: Linkage) -> Iterator[PrintedRun]:
    """One run for each regime, and for each speed and crank angle that figures are printed for."""
    mechanism = Mechanism(linkage)
    groups: dict[PrintedMotion, list[tuple[Published, tuple[Figure, ...]]]] = {}
    for entry in published_figures(linkage):
        if "@" in entry.quantity and entry.relative_to is None and (not entry.less or entry.less in table(mechanism)):
            names = [entry.quantity, *([rename_signal(entry.quantity, entry.less)] if entry.less else [])]
            figures = tuple(
                item for name in names for item in figures_by_name(mechanism, name).values() if isinstance(item, Figure)
            )
            groups.setdefault(motion_of_figure(mechanism, entry), []).append((entry, figures))
    for printed, group in groups.items():
        entries, terms = zip(*group, strict=True)
        yield PrintedRun(case_of_motion(mechanism, printed), entries, terms)


def _task(number: int, printed_run: PrintedRun, engine_name: str) -> Task:
    """The job for a worker: one engine makes one printed run; the run's ``number`` makes the task's key unique."""
    linkage = printed_run.case.mechanism.linkage
    label = f"{linkage.name} ({linkage.variant}): {engine_name}"
    return Task(
        f"printed/{number}/{engine_name}", (pickle.dumps(printed_run.case), engine_name, printed_run.terms), label
    )


def run_and_read(pickled: bytes, engine_name: str, terms: Terms) -> Answers:
    """Run a pickled case in an engine, tuned, and read the printed figures off its history."""
    case = unpickle_case(pickled)
    model = case.scene(frozenset(Channel))
    run = run_engine(engine(engine_name), model, Setting.TUNED)
    if run.outcome is not Outcome.FINISHED or run.history is None:
        return _no_answers(terms, f"{run.outcome}: {run.reason}")
    motion = ObservedMotion(model, run.history)
    return {"values": [_read_difference(case, motion, each) for each in terms], "reason": "records none of it"}


def _no_answers(terms: Terms, reason: str) -> Answers:
    return {"values": [None] * len(terms), "reason": reason}


def _read_difference(case: Case, motion: ObservedMotion, figures: Sequence[Figure]) -> float | None:
    """The first of the figures less the others; None where the history lacks one."""
    read = []
    for figure in figures:
        time = np.array(
            [case.motion.duration if math.isnan(figure.time) else figure.time]
        )  # at an angle the motion ends
        read.append(_read_signal(case.mechanism.linkage, motion, figure.signal, time))
    numbers = [float(values[0]) for values in read if values is not None]
    return numbers[0] - sum(numbers[1:]) if len(numbers) == len(read) else None


def _read_signal(linkage: Linkage, motion: ObservedMotion, name: str, time: Array) -> Array | None:
    """A signal (n,) at these times as the history has it; None where the engine does not record it."""
    if name in DRIVE:
        level = LEVELS[DRIVE.index(name)]
        return motion.crank(level, time) if motion.has(level) else None
    if name == "Mkr":
        return motion.on_clock(Channel.TORQUE, time) if motion.has(Channel.TORQUE) else None
    kind, _, path = name.partition(":")
    part, _, component = path.rpartition(":")
    if kind == "joint_force" and component in COMPONENTS[kind]:
        force = motion.history.joint_force.get(part)
        is_vector = force is not None and force.values.ndim > 1  # some engines have only the magnitude of a force
        return None if force is None or not is_vector else np.asarray(resample(force, time)[:, "xy".index(component)])
    if kind == "link":
        level = LEVELS[tuple(COMPONENTS[kind]).index(component)]
        return motion.bodies(level, time)[:, motion.numbers[part], 2] if motion.has(level) else None
    return _read_point(linkage, motion, part, component, time) if kind == "point" else None


def _read_point(linkage: Linkage, motion: ObservedMotion, name: str, component: str, time: Array) -> Array | None:
    """One component of a point's motion (n,); None where the engine does not record enough."""
    order, axis = divmod(ORDERS.index(component), 2)
    if not all(map(motion.has, LEVELS[: order + 1])):
        return None
    body, link = next((body, link) for body, link in linkage.links.items() if name in link.points)
    anchor = (link.points[name][0] - link.centre[0], link.points[name][1] - link.centre[1])
    return np.asarray(motion.point(body, anchor, time, order)[:, axis])


def _engine_answers(printed_run: PrintedRun, engine_name: str, run: Answers) -> Iterator[EngineAnswer]:
    for entry, value in zip(printed_run.entries, run["values"], strict=True):
        yield EngineAnswer(
            **record_fields(printed_run.case.mechanism.linkage, entry, value),
            engine=engine_name,
            uncertainty=max(entry.half_digit, entry.accuracy),
            reason=run["reason"] if value is None else "",
        )


def _lost_answers(failure: Lost, _pickled: bytes, _name: str, terms: Terms) -> Answers:
    return _no_answers(terms, f"{failure.outcome}: {failure.reason}")
