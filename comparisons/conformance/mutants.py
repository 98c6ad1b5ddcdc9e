"""Mutants of an engine, and the first row of the suite by which each is seen."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any, Final, TypeVar

from comparisons.conformance.misreadings import Misreading
from comparisons.conformance.mutations import Mutation
from comparisons.conformance.samples import SAMPLES, case
from comparisons.invariants.checks import checks
from comparisons.judging.deviations import NoSampleError, deviation
from comparisons.judging.quantities import chosen_quantities
from comparisons.judging.records import Verdict, blank_record
from comparisons.judging.verdicts import judge
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.case import Case
from comparisons.runs.failures import blamed_on
from comparisons.runs.run_engine import readable, started
from engines.contract import Engine, Outcome, Run, Setting
from engines.scene import Channel, Scene

T = TypeVar("T")
MOST_KEPT: Final = 2 * len(SAMPLES)
_KEPT: dict[tuple[int, str], tuple[Engine, Any]] = {}


class Misread:
    """An engine whose history is misread."""

    def __init__(self, engine: Engine, misreading: Misreading) -> None:
        self.engine, self.misreading = engine, misreading
        self.name, self.abilities, self.is_control = engine.name, engine.abilities, engine.is_control

    def version(self) -> str | None:
        """That of the engine."""
        return self.engine.version()

    def run(self, scene: Scene, setting: Setting) -> Run:
        """The engine's run, misread."""
        run = self.engine.run(scene, setting)
        channel = self.misreading.channel
        if run.history is None or channel not in scene.channels or getattr(run.history, channel.value) in (None, {}):
            return run
        return replace(run, history=self.misreading.change(run.history, scene))


def can_be_altered(engine: Engine) -> bool:
    """Whether a world of the engine can be built from another scene than the requested one."""
    return hasattr(engine, "altered")


def mutant(engine: Engine, mutation: Mutation) -> Engine:
    """The engine whose worlds are built as the mutation alters the case of its sample."""
    wrong = mutation.alter(case(mutation.sample))

    def altered(scene: Scene) -> Scene:
        return wrong.scene(scene.channels)

    changed: Any = copy.copy(engine)
    changed.altered = altered
    return changed  # type: ignore[no-any-return]


def own_run(engine: Engine, scene: Scene, setting: Setting) -> Run:
    """The engine's run of a scene; whether its samples cover the motion is a check of its own."""
    with blamed_on(engine):
        return readable(started(engine, scene, setting, None), scene, engine.name)


def tuned_run(engine: Engine, sample: str) -> Run:
    """The engine's tuned run of a sample, all channels recorded."""
    return own_run(engine, case(sample).scene(frozenset(Channel)), Setting.TUNED)


def kept_run(engine: Engine, sample: str) -> Run:
    """The engine's tuned run of a sample, made once."""
    return _kept(engine, f"run of {sample}", lambda: tuned_run(engine, sample))


def rows_failed_unaltered(engine: Engine, sample: str) -> frozenset[str]:
    """The rows that the engine's tuned run of a sample fails, found once."""
    return _kept(
        engine,
        f"rows of {sample}",
        lambda: frozenset(failing_rows(case(sample), engine, kept_run(engine, sample))),
    )


def _kept(engine: Engine, key: str, make: Callable[[], T]) -> T:
    """What was made for an engine before; of the engine itself, as another may be equal to it."""
    name = (id(engine), key)
    if name not in _KEPT:
        while len(_KEPT) >= MOST_KEPT:
            del _KEPT[next(iter(_KEPT))]
        _KEPT[name] = (engine, make())  # an engine that is kept shares its identity with no other
    result: T = _KEPT[name][1]
    return result


def failing_rows(of: Case, engine: Engine, run: Run) -> Iterator[str]:
    """Names of the quantities, then of the invariants, that a tuned run fails, of those that speak of the engine."""
    if run.outcome is not Outcome.FINISHED or run.history is None:
        yield run.outcome.value
        return
    motion = ObservedMotion(of.scene(frozenset(Channel)), run.history)
    blank = blank_record(of, Setting.TUNED, engine.name, "")
    for quantity in chosen_quantities(of, ()):
        if quantity.lacking(motion) or quantity.shared(of, motion):
            continue
        try:
            found = deviation(of, quantity, motion)
        except NoSampleError:
            continue
        row = replace(
            blank,
            quantity=quantity.name,
            origin=quantity.origin(motion).value,
            error_max=found.error_max,
            error_at_jumps=found.error_at_jumps,
        )
        if judge(row).outcome == Verdict.OVER_LIMIT:
            yield quantity.name
    for row in checks(of, motion, blank):
        if Verdict(row.outcome).failed:
            yield row.quantity
