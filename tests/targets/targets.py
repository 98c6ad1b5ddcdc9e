"""Accuracy and speed targets of linkproof itself, measured anew; ``python -m tests.targets.targets`` prints them."""

from __future__ import annotations

import math
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console, Group
from rich.table import Table
from rich.text import Text

from analytic.description.crank_motion import crank_motion
from analytic.description.linkage import Linkage, ReleasedRegime
from analytic.description.loading import catalogue, load
from analytic.dynamics.reduced import damping_coefficient
from analytic.evaluation import evaluate
from analytic.kinematics.mechanism import Mechanism
from analytic.motion.released import free_motion
from analytic.motion.steady_rotation import steady_state
from comparisons.campaign.campaign import CampaignRequest, compare
from comparisons.judging.records import Record, RunRecord
from comparisons.reference.case import motion_of_file_regime
from comparisons.reference.start_state import scene
from engines.contract import Setting
from engines.registry import engine, engine_names
from engines.scene import Channel, Prescribed
from tests.targets import speed, studies

TABLE = Path(__file__).with_name("targets.toml")
REPEATS = 5
WITHIN, TOLERANCE = 1e-6, 1e-5  # rad, of a released crank over the whole run; of its integration


@dataclass(frozen=True)
class Target:
    """A promised figure: ``kind`` says how it is measured, with ``arguments``."""

    name: str
    unit: str
    minimum: float
    goal: float
    kind: str
    arguments: Any


@dataclass(frozen=True)
class Figure:
    """A target with what was reached, its smallest repeat and all of them.

    ``subject`` is an engine, a mechanism or two contestants; ``detail`` says what a ratio is made up of. ``reached`` is
    nan where a baseline to be measured against is not installed.
    """

    target: Target
    subject: str
    reached: float
    repeats: tuple[float, ...] = ()
    detail: str = ""

    @property
    def verdict(self) -> str:
        """``goal``, ``minimum``, ``missed``, or ``absent`` where there was nothing to be measured against."""
        if math.isnan(self.reached):
            return "absent"
        if self.reached <= self.target.goal:
            return "goal"
        return "minimum" if self.reached <= self.target.minimum else "missed"


Measure = Callable[[Target, Sequence[Linkage], Sequence[str]], Iterator[Figure]]


def targets() -> tuple[Target, ...]:
    """The table of targets."""
    rows = tomllib.loads(TABLE.read_text(encoding="utf-8"))["target"]
    common = {"name", "unit", "minimum", "goal"}
    found = []
    for row in rows:
        (kind,) = set(row) - common
        found.append(Target(row["name"], row.get("unit", "of peak"), row["minimum"], row["goal"], kind, row[kind]))
    return tuple(found)


def measure(linkages: Sequence[Linkage], engines: Sequence[str]) -> Iterator[Figure]:
    """Measure every target in turn; errors of each engine over all linkages given."""
    results = list(_campaign(linkages, engines))
    released = list(_released_campaign(linkages, engines))
    for target in targets():
        if target.kind in ("errors", "own_errors"):
            yield from _errors(target, results if target.kind == "errors" else released, engines)
        else:
            yield from KINDS[target.kind](target, linkages, engines)


def _campaign(linkages: Sequence[Linkage], engines: Sequence[str]) -> Iterator[RunRecord]:
    motions = (crank_motion("run-up"), crank_motion("run-up-quintic"))
    settings = (Setting.TUNED, Setting.BEST)
    return compare(CampaignRequest(tuple(linkages), motions, "as promised", tuple(engines), settings))


def _released_campaign(linkages: Sequence[Linkage], engines: Sequence[str]) -> Iterator[RunRecord]:
    """The linkages' own regimes, in the settings that targets name, for the crank's motion alone."""
    for target in targets():
        if target.kind == "own_errors":
            given, setting = target.arguments, Setting(target.arguments["setting"])
            chosen = tuple(linkage for linkage in linkages if linkage.name == given["mechanism"])
            quantities, regimes = (given["quantity"],), (given["regime"],)
            yield from compare(
                CampaignRequest(chosen, (), "", tuple(engines), (setting,), quantities, regimes, (setting,),
                                with_invariants=False)
            )  # fmt: skip


def _errors(target: Target, results: Sequence[RunRecord], engines: Sequence[str]) -> Iterator[Figure]:
    """The worst error of each engine among the records the target speaks of; in the quantity's unit if it says so."""
    given = dict(target.arguments)
    only, absolute = given.pop("engine", None), given.pop("absolute", False)
    for name in engines if only is None else only:
        found = [
            _error(record, absolute=absolute)
            for result in results
            for record in result.every
            if record.engine == name and all(_speaks_of(record, key, value) for key, value in given.items())
        ]
        if found:
            yield Figure(target, name, max(found))


def _speaks_of(record: Record, key: str, value: str) -> bool:
    """Whether a record is one of those a target names; ``joint_force`` stands for the forces of all joints."""
    return str(getattr(record, key)).partition(":")[0] == value


def _error(record: Record, *, absolute: bool) -> float:
    if record.error_max is None or record.peak is None:
        return np.inf
    return record.error_max * (record.peak if absolute else 1.0)


def _reference(target: Target, linkages: Sequence[Linkage]) -> Iterator[Figure]:
    """The closed form's own bound on the error of a released crank's angle, rad."""
    for mechanism, own in _named(target, linkages):
        yield Figure(target, mechanism.linkage.name, motion_of_file_regime(mechanism, own).error_bound)


def _steady_state(target: Target, linkages: Sequence[Linkage]) -> Iterator[Figure]:
    """How far the settled mean speed of a driven crank is from M1/b, which an energy balance over a turn demands."""
    for mechanism, own in _named(target, linkages):
        damping = float(np.mean(damping_coefficient(mechanism.turn)))
        speed = steady_state(mechanism, own.torque).mean_speed
        yield Figure(target, mechanism.linkage.name, abs(speed * damping / own.torque - 1.0))


def _named(target: Target, linkages: Sequence[Linkage]) -> Iterator[tuple[Mechanism, ReleasedRegime]]:
    """The mechanism and the regime of its own that a target names."""
    for linkage in linkages:
        for own in linkage.regimes:
            if (linkage.name, own.name) == (target.arguments["mechanism"], target.arguments["regime"]):
                yield Mechanism(linkage), own


def _overheads(target: Target, linkages: Sequence[Linkage], engines: Sequence[str]) -> Iterator[Figure]:
    """Wall time of a run less its set-up, over the stepping of the same scene with nothing recorded, pair by pair.

    Both per step: a run that judges its own error by what it records may take more passes than one without records.
    """
    motion, setting = crank_motion(target.arguments["regime"]), Setting(target.arguments["setting"])
    for name in engines:
        adapter = engine(name)
        ratios = []
        for linkage in linkages:
            full = scene(Mechanism(linkage), Prescribed(motion), frozenset(Channel) - {Channel.JOINT_FORCE})
            bare = replace(full, channels=frozenset())
            for _ in range(REPEATS):
                begun = time.perf_counter()
                run = adapter.run(full, setting)
                spent = time.perf_counter() - begun - run.setup_seconds
                alone = adapter.run(bare, setting)
                ratios.append((spent / run.steps) / (alone.seconds / alone.steps))
        yield Figure(target, name, float(np.median(ratios)), tuple(ratios))


def _closed_form(target: Target, linkages: Sequence[Linkage]) -> Iterator[Figure]:
    count = target.arguments["angles"]
    angle = np.linspace(0.0, 100.0, count)
    for linkage in linkages:
        mechanism = Mechanism(linkage)
        work = partial(evaluate, mechanism, angle, ("S", "v", "a", "Jeq", "Mkr"), speed=100.0)
        spent = _timed(work)
        each = tuple(seconds / count * 1e6 for seconds in spent)
        yield Figure(target, linkage.name, min(each), each)


def _process(target: Target) -> Iterator[Figure]:
    command = [sys.executable, "-m", "reports.command_line.main", *target.arguments]
    spent = _timed(lambda: subprocess.run(command, capture_output=True, check=True))
    yield Figure(target, "median", float(np.median(spent)), spent)


def _six_bar(target: Target) -> Iterator[Figure]:
    """Time of a sweep of a six-bar's joints over pylinkage's."""
    yield _figure(target, speed.six_bar(target.arguments["mechanism"], target.arguments["angles"]))


def _designs(target: Target) -> Iterator[Figure]:
    """Time per design and crank angle, ns."""
    given = target.arguments
    yield _figure(target, speed.designs(given["mechanism"], given["varied"], given["designs"], given["angles"]))


def _forward_alone(target: Target, linkages: Sequence[Linkage]) -> Iterator[Figure]:
    """Time of a released crank's motion, ms; infinite where its angle is not within ``WITHIN``."""
    for mechanism, own in _named(target, linkages):
        start = {"torque": own.torque, "start_angle": own.start_angle, "start_speed": own.start_speed}
        release = partial(free_motion, mechanism, **start, duration=own.duration)
        quick = partial(release, tolerance=TOLERANCE)
        instants = np.linspace(0.0, own.duration, 2001)
        error = float(np.max(np.abs(quick().angle(instants) - release().angle(instants))))
        spent = tuple(1e3 * seconds for seconds in _timed(quick))
        yield Figure(target, own.name, min(spent) if error <= WITHIN else np.inf, spent)


def _studied(study: Callable[[dict[str, Any], Sequence[str]], Iterator[speed.Measured]]) -> Measure:
    """Figures of a study of its own."""
    return lambda target, _, engines: (_figure(target, each) for each in study(target.arguments, engines))


def _figure(target: Target, found: speed.Measured) -> Figure:
    return Figure(target, found.subject, found.reached, found.repeats, found.detail)


def _timed(work: Callable[[], object]) -> tuple[float, ...]:
    """Seconds of every repeat after one that warms up."""
    spent = []
    for _ in range(REPEATS + 1):
        begun = time.perf_counter()
        work()
        spent.append(time.perf_counter() - begun)
    return tuple(spent[1:])


# How a target is measured, by its kind; errors are read from campaigns that several targets share.
KINDS: Mapping[str, Measure] = {
    "errors": lambda *_: iter(()),
    "own_errors": lambda *_: iter(()),
    "reference": lambda target, linkages, _: _reference(target, linkages),
    "steady_state": lambda target, linkages, _: _steady_state(target, linkages),
    "overhead": _overheads,
    "closed_form": lambda target, linkages, _: _closed_form(target, linkages),
    "process": lambda target, *_: _process(target),
    "six_bar": lambda target, *_: _six_bar(target),
    "designs": lambda target, *_: _designs(target),
    "forward_alone": lambda target, linkages, _: _forward_alone(target, linkages),
    "long_turns": _studied(studies.long_turns),
    "random": _studied(studies.random),
    "missed": _studied(studies.missed),
    "endurance": _studied(studies.endurance),
}


def table(figures: Sequence[Figure]) -> Group:
    """Every target beside what was reached, then what ratios are made up of."""
    rows = Table("figure", "of", "minimum", "goal", "reached", "", box=None, pad_edge=False)
    words = {"goal": "goal met", "minimum": "minimum met", "missed": "missed", "absent": "not measured"}
    for figure in figures:
        target = figure.target
        unit = "" if target.unit == "of peak" else f" {target.unit}"
        numbers = (f"{target.minimum:g}", f"{target.goal:g}", f"{figure.reached:.2g}{unit}")
        rows.add_row(target.name, figure.subject, *numbers, words[figure.verdict])
    details = [Text(f"{figure.target.name}, {figure.subject}: {figure.detail}") for figure in figures if figure.detail]
    return Group(rows, Text(""), *details)


def main() -> int:
    """Measure every target and print the table; 1 if a minimum was missed."""
    engines = [name for name in engine_names() if engine(name).version() is not None]
    linkages = [linkage for linkage in map(load, catalogue()) if linkage.output is not None]
    figures = list(measure(linkages, engines))
    Console().print(table(figures))
    return int(any(figure.verdict == "missed" for figure in figures))


if __name__ == "__main__":
    sys.exit(main())
