"""A campaign: every mechanism under every regime in every engine and setting, judged into records."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace

from analytic.errors import UnknownNameError
from analytic.linkage import Linkage
from analytic.mechanism import Mechanism
from analytic.regimes import CrankMotion
from comparisons import invariants
from comparisons.attempt import attempt
from comparisons.case import Case, own_case
from comparisons.checks import checks
from comparisons.deviations import Deviation, deviation
from comparisons.judging import judge
from comparisons.motion import ObservedMotion
from comparisons.quantities import Quantity, chosen_quantities
from comparisons.records import Record, Verdict
from engines.contract import Channel, Outcome, Run, Setting
from engines.registry import engine, engine_names


@dataclass(frozen=True)
class Request:
    """What to compare. ``conditions`` words the motions' speed, times, direction and start angle, the same for all.

    ``own_regimes`` names regimes that a linkage's own file may define; linkages without them are not run in them. They
    have settings of their own: a released crank adds up its phase error. No quantities means all that are results.
    """

    linkages: tuple[Linkage, ...]
    motions: tuple[CrankMotion, ...]
    conditions: str
    engines: tuple[str, ...]
    settings: tuple[Setting, ...] = (Setting.TUNED,)
    quantities: tuple[str, ...] = ()
    own_regimes: tuple[str, ...] = ()
    own_settings: tuple[Setting, ...] = (Setting.BEST,)
    with_invariants: bool = True


@dataclass(frozen=True)
class RunResult:
    """One run, judged: its records, its invariants, and the curves behind them by quantity."""

    records: tuple[Record, ...]
    invariants: tuple[Record, ...]
    deviations: dict[str, Deviation] = field(default_factory=dict)
    details: dict[str, str | int | float] = field(default_factory=dict)


@dataclass(frozen=True)
class _Task:
    """One run still to be made."""

    case: Case
    engine: str
    setting: Setting
    quantities: tuple[Quantity, ...]

    @property
    def label(self) -> str:
        return f"{self.case.mechanism.linkage.name}, {self.case.motion.regime}: {self.engine} {self.setting}"


def tasks(request: Request) -> list[_Task]:
    """The runs of a request, in a stable order.

    Raises UnknownNameError, AssemblyError or StructureError before any run is made.
    """
    for name in request.engines:
        if name not in engine_names():
            raise UnknownNameError("engine", name, engine_names())
    chosen = [(case, tuple(chosen_quantities(case, request.quantities))) for case in cases(request)]
    return [
        _Task(case, name, setting, quantities)
        for case, quantities in chosen
        for name in request.engines
        for setting in (request.settings if case.is_prescribed else request.own_settings)
    ]


def cases(request: Request) -> list[Case]:
    """Every linkage under every motion asked for, then in those of its own regimes that are asked for."""
    found = []
    for linkage in request.linkages:
        mechanism = Mechanism(linkage)
        if request.motions:
            mechanism.check_full_turn()
        found += [Case(mechanism, motion, conditions=request.conditions) for motion in request.motions]
        found += [own_case(mechanism, own) for own in linkage.regimes if own.name in request.own_regimes]
    return found


def compare(request: Request, announce: Callable[[str, int, int], None] = lambda *_: None) -> Iterator[RunResult]:
    """Make the runs one by one; ``announce`` hears a label, the number of the run and how many there are.

    What ``tasks`` raises is raised at once, before the first run is asked for.
    """
    return _runs(tasks(request), request, announce)


def _runs(todo: list[_Task], request: Request, announce: Callable[[str, int, int], None]) -> Iterator[RunResult]:
    for number, task in enumerate(todo):
        announce(task.label, number, len(todo))
        yield _judged(task, request)
    announce("", len(todo), len(todo))


def _channels(quantities: Iterable[Quantity], with_invariants: bool) -> frozenset[Channel]:
    """What the engine has to record: what the quantities need, and for the invariants everything but joint forces."""
    needed = frozenset(channel for q in quantities for channel in q.channels)
    return needed | frozenset().union(*invariants.INVARIANTS.values()) if with_invariants else needed


def _judged(task: _Task, request: Request) -> RunResult:
    wanted = list(task.quantities)
    adapter = engine(task.engine)
    version = adapter.version()
    blank = _blank(task, version or "")
    if version is None:
        reason = f"engine '{task.engine}' is not installed; install it with: pip install 'linkproof[{task.engine}]'"
        return _all_alike(blank, wanted, Verdict.UNAVAILABLE, reason)
    model = task.case.scene(_channels(wanted, request.with_invariants))
    run = attempt(adapter, model, task.setting)
    blank = replace(blank, seconds=run.seconds, setup_seconds=run.setup_seconds, steps=run.steps)
    if run.outcome is not Outcome.FINISHED or run.history is None:
        return _all_alike(blank, wanted, Verdict(run.outcome.value), run.reason)
    return _measured(
        task, wanted, run, ObservedMotion(model, run.history), blank, with_invariants=request.with_invariants
    )


def _measured(
    task: _Task, wanted: list[Quantity], run: Run, motion: ObservedMotion, blank: Record, *, with_invariants: bool
) -> RunResult:
    deviations = {q.name: deviation(task.case, q, motion) for q in wanted}
    records = tuple(_record(replace(blank, quantity=q.name, unit=q.unit), deviations[q.name]) for q in wanted)
    found = checks(task.case, motion, blank) if with_invariants else ()
    return RunResult(records, found, deviations, dict(run.details))


def _blank(task: _Task, version: str) -> Record:
    linkage = task.case.mechanism.linkage
    return Record(
        mechanism=linkage.name,
        variant=linkage.variant,
        regime=task.case.motion.regime,
        conditions=task.case.conditions,
        engine=task.engine,
        engine_version=version,
        setting=task.setting.value,
        quantity="",
        unit="",
        error_max=None,
        error_rms=None,
        limit=None,
        baseline=None,
        outcome=Verdict.PASSED.value,
        detail="",
        peak=None,
        worst_time=None,
        samples=0,
        left_out=0,
        seconds=0.0,
        setup_seconds=0.0,
        steps=0,
    )


def _all_alike(blank: Record, wanted: list[Quantity], verdict: Verdict, reason: str) -> RunResult:
    """The records of a run that gave no motion."""
    return RunResult(
        tuple(replace(blank, quantity=q.name, unit=q.unit, outcome=verdict.value, detail=reason) for q in wanted), ()
    )


def _record(blank: Record, found: Deviation) -> Record:
    return judge(
        replace(
            blank,
            error_max=found.error_max,
            error_rms=found.error_rms,
            peak=found.peak,
            worst_time=found.worst_time,
            samples=found.samples,
            left_out=found.left_out,
        )
    )
