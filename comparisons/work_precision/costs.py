"""The cost of each output and load: whole scenes beside reduced ones, in every engine.

Times are of whole runs: checking, building, stepping, reading out. All runs take turns, every second round backwards,
so that a slow spell of the machine affects all of them alike; every repeat is recorded.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

from analytic.description.changes import LOADS, without
from analytic.description.crank_motion import crank_motion
from analytic.description.linkage import Linkage
from analytic.kinematics.mechanism import Mechanism
from comparisons.judging.quantities import QUANTITIES
from comparisons.reference.motion import scene
from comparisons.runs.run_engine import AdapterError, run_engine
from comparisons.work_precision.measure import timed
from comparisons.work_precision.records import MeasuredCost
from engines.contract import Engine, Outcome, Run, Setting
from engines.registry import engine
from engines.scene import Channel, Prescribed, Scene

ROUNDS: Final = 3
EVERYTHING: Final = frozenset(Channel)
MOTION: Final = frozenset({Channel.POSITION, Channel.VELOCITY, Channel.ACCELERATION})


@dataclass(frozen=True)
class SceneReduction:
    """A scene with less in it: the ``channels`` to record, and the kinds of loads that its linkage goes ``without``."""

    name: str
    about: str
    channels: frozenset[Channel] = EVERYTHING
    without: tuple[str, ...] = ()

    def reduce(self, linkage: Linkage) -> Linkage | None:
        """The linkage without these loads; None if it has no such load."""
        reduced = without(linkage, *self.without)
        return None if self.without and reduced == linkage else reduced


REDUCTIONS: Final = (
    SceneReduction("everything", "all channels, weights and loads"),
    SceneReduction("no joint forces", "motion and drive torque", EVERYTHING - {Channel.JOINT_FORCE}),
    SceneReduction("motion alone", "positions, velocities and accelerations", MOTION),
    SceneReduction("Jeq alone", "velocities, from which Jeq is read", QUANTITIES["Jeq"].channels),
    SceneReduction("nothing recorded", "no channel", frozenset()),
    SceneReduction("no gravity", "all channels, no weights", without=("gravity",)),
    SceneReduction("no loads", "all channels, no forces, torques, springs or dampers", without=LOADS),
)
"""The scenes that are compared; the first is the whole one."""


def measure(linkage: Linkage, engines: Sequence[str]) -> list[MeasuredCost]:
    """Every reduction of a linkage in these engines; what an engine cannot do is a row with its outcome."""
    jobs = list(_jobs(linkage, engines))
    for job in {cost.solver: job for cost, job in jobs}.values():
        job()  # imports, and whatever else is done only once
    costs = [cost for cost, _ in jobs]
    for number in range(ROUNDS):
        places = range(len(jobs))
        for place in places if number % 2 == 0 else reversed(places):
            costs[place] = _with_repeat(costs[place], *timed(jobs[place][1]))
    return costs


def most_reducible(linkages: Sequence[Linkage]) -> Linkage:
    """The linkage with most in it to be left out, the first of several."""
    return max(linkages, key=lambda linkage: sum(part.reduce(linkage) is not None for part in REDUCTIONS))


def _jobs(linkage: Linkage, engines: Sequence[str]) -> Iterator[tuple[MeasuredCost, Callable[[], Run]]]:
    """A run of every reduction in every engine: brought to speed over half a turn, and half a turn more."""
    drive = Prescribed(crank_motion("run-up-quintic", ramp_time=0.06, hold_time=0.03))
    rests = [(part, part.reduce(linkage)) for part in REDUCTIONS]
    models = [(part, scene(Mechanism(rest), drive, part.channels)) for part, rest in rests if rest is not None]
    for name in engines:
        adapter = engine(name)
        for part, model in models:
            cost = MeasuredCost(linkage.name, linkage.variant, name, part.name, part.about)
            yield replace(cost, is_control=adapter.is_control), partial(_run_once, adapter, model)


def _run_once(adapter: Engine, model: Scene) -> Run:
    try:
        return replace(run_engine(adapter, model, Setting.TUNED), history=None)
    except AdapterError as error:
        return Run(Outcome.DIVERGED, str(error))


def _with_repeat(cost: MeasuredCost, run: Run, seconds: float) -> MeasuredCost:
    return replace(
        cost,
        outcome=run.outcome.value,
        reason="" if run.outcome is Outcome.FINISHED else run.reason,
        seconds=(*cost.seconds, seconds),
        stepping=(*cost.stepping, run.seconds),
        steps=run.steps,
    )
