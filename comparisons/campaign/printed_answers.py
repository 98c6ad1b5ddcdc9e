"""What engines answer to printed figures: signals of a crank that turns steadily up to their angles, or is released.

A figure of another kind, a stroke or a range, is the closed form's alone.
"""

from __future__ import annotations

import math
import pickle
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.crank_motion import crank_motion
from analytic.description.linkage import Linkage
from analytic.description.schema import Published
from analytic.designs.figure_names import place
from analytic.kinematics.mechanism import Mechanism
from analytic.signals import COMPONENTS, ORDERS, unit
from comparisons.observation.interpolation import resample
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.case import Case, unpickled
from comparisons.reference.published import applies, in_printed_unit, speed_of, verdict
from comparisons.reference.signal_figures import case_of
from comparisons.runs.failures import Lost
from comparisons.runs.plugins import engine
from comparisons.runs.run_engine import run_engine
from comparisons.runs.study import Announce, Study, Task, Written
from comparisons.runs.workers import DEFAULT_BOUNDS, Bounds, LocalPool, Pool, usual_processes
from engines.contract import Outcome, Setting
from engines.scene import Channel

Array = NDArray[np.float64]
Asked = tuple[str, float]  # names of signals, and the time, s

MARGIN: Final = math.radians(10.0)  # that a crank turns before a printed angle
SHARE: Final = 0.5  # of the way from a toggle, where that is less
LEVELS: Final = (Channel.POSITION, Channel.VELOCITY, Channel.ACCELERATION)
DRIVE: Final[Mapping[str, Channel]] = dict(zip(("phi", "omega", "epsilon"), LEVELS, strict=True))


@dataclass(frozen=True)
class PrintedAnswer:
    """An engine's answer to a printed figure, in the printed unit; None with the ``reason`` where it gives none.

    ``uncertainty`` is the figure's own: half its last digit, or its source's accuracy where that is known to be less.
    """

    mechanism: str
    variant: str
    quantity: str
    source: str
    published: float
    uncertainty: float
    engine: str
    answer: float | None
    verdict: str
    reason: str


@dataclass(frozen=True)
class RunAnswers:
    """The requested values, SI, of one run; None where the engine records too little, or was stopped."""

    values: tuple[float | None, ...]
    reason: str = ""


@dataclass(frozen=True)
class Trial:
    """Printed figures that one run answers, each with its signals and time, s."""

    case: Case
    entries: tuple[Published, ...]
    asked: tuple[Asked, ...]


def engine_answers(
    linkages: Iterable[Linkage],
    engines: Sequence[str],
    announce: Announce = lambda *_: None,
    *,
    bounds: Bounds = DEFAULT_BOUNDS,
    pool: Pool | None = None,
) -> Iterator[PrintedAnswer]:
    """Every engine's answer, tuned, to every printed signal of the linkages at an angle or a time."""
    trials = [trial for linkage in linkages for trial in _trials(linkage)]
    tasks = [_task(number, trial, name) for number, trial in enumerate(trials) for name in engines]
    where = pool or LocalPool(usual_processes(len(tasks)))
    study = Study(read_out, _lost, _encoded, _decoded, None, announce, where)
    with closing(study.in_order(tasks, bounds)) as runs:
        for trial in trials:
            for name in engines:
                yield from _answers(trial, name, next(runs))


def _trials(linkage: Linkage) -> Iterator[Trial]:
    """One run for each regime, and for each speed and crank angle that figures are printed for."""
    groups: dict[str | tuple[float, float], list[tuple[Published, str, float]]] = {}
    for entry in linkage.published:
        names, _, where = entry.quantity.rpartition("@")
        if names and applies(linkage, entry) and entry.relative_to is None:
            number, regime = place(linkage, where)
            groups.setdefault(regime or (speed_of(entry), number), []).append((entry, names, number))
    mechanism = Mechanism(linkage)
    for key, group in groups.items():
        case = case_of(mechanism, key) if isinstance(key, str) else _up_to(mechanism, *key)
        times = [number if isinstance(key, str) else case.motion.duration for _, _, number in group]
        asked = tuple((names, time) for (_, names, _), time in zip(group, times, strict=True))
        yield Trial(case, tuple(entry for entry, _, _ in group), asked)


def _up_to(mechanism: Mechanism, speed: float, angle: float) -> Case:
    """A crank that turns steadily and ends at an angle, rad: its last sample is read, and nothing between samples."""
    way, reach = MARGIN, mechanism.crank_range()
    if not reach.is_full_turn:
        way = min(way, SHARE * abs(angle - reach.limits[0 if speed > 0.0 else 1]))
    motion = crank_motion(
        "constant-speed", speed=abs(speed), clockwise=speed < 0.0, start_angle=angle - math.copysign(way, speed),
        ramp_time=0.0, hold_time=way / abs(speed),
    )  # fmt: skip
    return Case(mechanism, motion)


def _task(number: int, trial: Trial, name: str) -> Task:
    linkage = trial.case.mechanism.linkage
    label = f"{linkage.name} ({linkage.variant}): {name}"
    return Task(f"printed/{number}/{name}", (pickle.dumps(trial.case), name, trial.asked), label)


def read_out(pickled: bytes, name: str, asked: tuple[Asked, ...]) -> RunAnswers:
    """One run of a pickled case, and the requested signals of its history."""
    case = unpickled(pickled)
    model = case.scene(frozenset(Channel))
    run = run_engine(engine(name), model, Setting.TUNED)
    if run.outcome is not Outcome.FINISHED or run.history is None:
        return RunAnswers((None,) * len(asked), f"{run.outcome}: {run.reason}")
    motion, linkage = ObservedMotion(model, run.history), case.mechanism.linkage
    return RunAnswers(tuple(_difference(linkage, motion, *each) for each in asked), "records none of it")


def _difference(linkage: Linkage, motion: ObservedMotion, names: str, time: float) -> float | None:
    """The first of the signals less the others; None where the history lacks one."""
    read = [_signal(linkage, motion, name, np.array([time])) for name in names.split(" - ")]
    found = [float(values[0]) for values in read if values is not None]
    return found[0] - sum(found[1:]) if len(found) == len(read) else None


def _signal(linkage: Linkage, motion: ObservedMotion, name: str, time: Array) -> Array | None:
    """A signal (n,) as the history has it."""
    if name in DRIVE:
        return motion.crank(DRIVE[name], time) if motion.has(DRIVE[name]) else None
    if name == "Mkr":
        return motion.on_clock(Channel.TORQUE, time) if motion.has(Channel.TORQUE) else None
    kind, _, rest = name.partition(":")
    part, _, component = rest.rpartition(":")
    if kind == "joint_force":
        force = motion.history.joint_force.get(part)
        is_vector = force is not None and force.values.ndim > 1  # some engines tell a force's size alone
        return None if force is None or not is_vector else np.asarray(resample(force, time)[:, "xy".index(component)])
    if kind == "link":
        level = LEVELS[tuple(COMPONENTS["link"]).index(component)]
        return motion.bodies(level, time)[:, motion.numbers[part], 2] if motion.has(level) else None
    return _point(linkage, motion, part, component, time) if kind == "point" else None


def _point(linkage: Linkage, motion: ObservedMotion, name: str, component: str, time: Array) -> Array | None:
    order, axis = divmod(ORDERS.index(component), 2)
    if not all(map(motion.has, LEVELS[: order + 1])):
        return None
    body, link = next((body, link) for body, link in linkage.links.items() if name in link.points)
    anchor = (link.points[name][0] - link.centre[0], link.points[name][1] - link.centre[1])
    return np.asarray(motion.point(body, anchor, time, order)[:, axis])


def _answers(trial: Trial, name: str, told: RunAnswers) -> Iterator[PrintedAnswer]:
    linkage = trial.case.mechanism.linkage
    for entry, (names, _), value in zip(trial.entries, trial.asked, told.values, strict=True):
        answer = None
        if value is not None:
            _, answer = in_printed_unit(entry, unit(names.split(" - ")[0], linkage), value)
        yield PrintedAnswer(
            mechanism=linkage.name,
            variant=linkage.variant,
            quantity=entry.quantity,
            source=entry.place,
            published=entry.value,
            uncertainty=max(entry.half_digit, entry.accuracy),
            engine=name,
            answer=answer,
            verdict="" if answer is None else verdict(entry, answer),
            reason="" if answer is not None else told.reason,
        )


def _lost(failure: Lost, _pickled: bytes, _name: str, asked: tuple[Asked, ...]) -> RunAnswers:
    return RunAnswers((None,) * len(asked), f"{failure.outcome}: {failure.reason}")


def _encoded(answers: RunAnswers) -> Written:
    return asdict(answers), {}


def _decoded(row: Mapping[str, Any], _: Mapping[str, Array]) -> RunAnswers:
    return RunAnswers(tuple(row["values"]), row["reason"])
