"""A campaign: every mechanism under every regime in every engine and setting, judged into records."""

from __future__ import annotations

from collections.abc import Callable, Container, Generator, Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial

from analytic.description.crank_motion import CrankMotion
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from comparisons.invariants.checks import checks
from comparisons.judging import baseline
from comparisons.judging.deviations import Deviation, NoSampleError, deviation
from comparisons.judging.quantities import Quantity, check_defined, chosen_quantities
from comparisons.judging.records import Record, Verdict, blank_record
from comparisons.judging.run_result import RunResult, from_bytes, to_bytes
from comparisons.judging.verdicts import judge
from comparisons.observation.observed_motion import ObservedMotion
from comparisons.reference.case import Case, own_case
from comparisons.runs.failures import Failure, Lost, blamed_on
from comparisons.runs.journal import Journal
from comparisons.runs.run_engine import run_engine
from comparisons.runs.workers import DEFAULT_BOUNDS, Bounds, as_sent, run_jobs, usual_processes
from engines.contract import Outcome, Setting
from engines.registry import engine, engine_names
from engines.scene import Channel

__all__ = ["Request", "RunResult", "cases", "compare", "tasks"]

Announce = Callable[[str, int, int], object]


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
class _Task:
    """One run still to be made."""

    case: Case
    engine: str
    setting: Setting
    quantities: tuple[Quantity, ...]

    @property
    def label(self) -> str:
        return f"{self.case.mechanism.linkage.name}, {self.case.motion.regime}: {self.engine} {self.setting}"

    @property
    def key(self) -> str:
        """What identifies the run within its request, as ``Record.run`` does."""
        linkage = self.case.mechanism.linkage
        return "/".join((linkage.name, linkage.variant, self.case.motion.regime, self.engine, self.setting))

    @property
    def weight(self) -> float:
        """What a run costs, very roughly: crank angle turned through at top speed, times links."""
        return self.case.motion.duration * self.case.motion.peak_speed * len(self.case.mechanism.linkage.links)


def tasks(request: Request) -> list[_Task]:
    """The runs of a request, in a stable order.

    Raises UnknownNameError, AssemblyError or StructureError before any run is made.
    """
    for name in request.engines:
        if name not in engine_names():
            raise UnknownNameError("engine", name, engine_names())
    chosen = [(case, tuple(chosen_quantities(case, request.quantities))) for case in cases(request)]
    for case, quantities in chosen:
        check_defined(case, quantities)
    return [
        _Task(case, name, setting, quantities)
        for case, quantities in chosen
        for name in request.engines
        for setting in (request.settings if case.is_prescribed else request.own_settings)
    ]


def cases(request: Request) -> list[Case]:
    """Every linkage under every motion asked for, then in those of its own regimes that are asked for.

    Raises LinkproofError where there is none, AssemblyError where a linkage cannot follow its motion.
    """
    found = []
    for linkage in request.linkages:
        mechanism = Mechanism(linkage)
        found += [Case(mechanism, motion, conditions=request.conditions) for motion in request.motions]
        found += [own_case(mechanism, own) for own in linkage.regimes if own.name in request.own_regimes]
    if not found:
        names = ", ".join(f"'{linkage.name}'" for linkage in request.linkages)
        raise LinkproofError(f"expected a regime that {names} can run in, got none of its own: ask for another regime")
    for case in found:
        case.check_motion()
    return found


def compare(
    request: Request,
    announce: Announce = lambda *_: None,
    *,
    bounds: Bounds = DEFAULT_BOUNDS,
    processes: int | None = None,
    journal: Journal | None = None,
) -> Iterator[RunResult]:
    """Make the runs, in parallel, and yield them in the order of ``tasks``.

    ``announce`` hears the label of the run begun last, how many are finished and how many there are. Runs are made in
    ``processes`` worker processes (the cores by default), each run within ``bounds``; with 0, the default for a single
    run, they are made here, one by one and unbounded. A ``journal`` is given every finished run to keep, and spares
    those that it has kept already.

    What ``tasks`` raises is raised at once, before the first run is asked for; LinkproofError too, if the journal is
    another request's or the baseline is damaged.
    """
    baseline.recorded()
    todo = tasks(request)
    kept = {} if journal is None else journal.kept()
    done = {number: from_bytes(kept[task.key]) for number, task in enumerate(todo) if task.key in kept}
    way = _Way(announce, bounds, usual_processes(len(todo)) if processes is None else processes, journal)
    return _in_order(len(todo), done, _made(todo, frozenset(done), way, with_invariants=request.with_invariants))


@dataclass(frozen=True)
class _Way:
    """How runs are made, as ``compare`` is told."""

    announce: Announce
    bounds: Bounds
    processes: int
    journal: Journal | None


@dataclass(frozen=True)
class _Order:
    """One run asked for in words that another process understands; ``place`` is its case's among those it was given."""

    place: int
    engine: str
    setting: Setting
    quantities: tuple[str, ...]


def _in_order(
    count: int, done: dict[int, RunResult], made: Generator[tuple[int, RunResult], None, None]
) -> Iterator[RunResult]:
    """Results in the order of their numbers, each as soon as all before it are there."""
    with closing(made):
        for number in range(count):
            while number not in done:
                finished, result = next(made)
                done[finished] = result
            yield done.pop(number)


def _made(
    todo: Sequence[_Task], done: Container[int], way: _Way, *, with_invariants: bool
) -> Generator[tuple[int, RunResult], None, None]:
    """The runs not done yet, as they finish."""
    missing = [number for number in range(len(todo)) if number not in done]
    if way.processes > 1:  # the heaviest first, so that no core is left alone with it at the end
        missing.sort(key=lambda number: -todo[number].weight)
    cases, jobs = _ordered([todo[number] for number in missing])
    finished = len(todo) - len(missing)

    def begun(index: int) -> None:
        way.announce(todo[missing[index]].label, finished, len(todo))

    run = partial(_run, as_sent(cases), with_invariants)
    with closing(run_jobs(run, jobs, bounds=way.bounds, processes=way.processes, begun=begun)) as results:
        for index, found in results:
            task = todo[missing[index]]
            result = _lost(task, found) if isinstance(found, Lost) else found
            if way.journal is not None:
                way.journal.keep(task.key, to_bytes(result))
            finished += 1
            way.announce(task.label, finished, len(todo))
            yield missing[index], result


def _ordered(todo: Sequence[_Task]) -> tuple[tuple[Case, ...], list[tuple[_Order]]]:
    """The cases of these tasks, each once, and an order for every task."""
    cases = {id(task.case): task.case for task in todo}
    places = {key: place for place, key in enumerate(cases)}
    orders = [
        _Order(places[id(task.case)], task.engine, task.setting, tuple(q.name for q in task.quantities))
        for task in todo
    ]
    return tuple(cases.values()), [(order,) for order in orders]


def _run(cases: Sequence[Case], with_invariants: bool, order: _Order) -> RunResult:
    case = cases[order.place]
    quantities = tuple(chosen_quantities(case, order.quantities))
    return _judged(_Task(case, order.engine, order.setting, quantities), with_invariants)


def _lost(task: _Task, lost: Lost) -> RunResult:
    """The records of a run whose process gave no result."""
    version = engine(task.engine).version() or ""
    return _all_alike(task, blank_record(task.case, task.setting, task.engine, version), lost.outcome, lost.reason)


def _channels(quantities: Iterable[Quantity], with_invariants: bool) -> frozenset[Channel]:
    """What the engine has to record: joint forces where something needs them, all else always.

    An engine may choose its steps by what it records, and what is asked for is not to change what is simulated.
    """
    needed = frozenset(channel for quantity in quantities for channel in quantity.channels)
    return frozenset(Channel) if with_invariants else needed | (frozenset(Channel) - {Channel.JOINT_FORCE})


def _judged(task: _Task, with_invariants: bool) -> RunResult:
    adapter = engine(task.engine)
    with blamed_on(adapter):
        version = adapter.version()
    blank = blank_record(task.case, task.setting, task.engine, version or "")
    if version is None:
        reason = f"engine '{task.engine}' is not installed; install it with: pip install 'linkproof[{task.engine}]'"
        return _all_alike(task, blank, Outcome.UNAVAILABLE, reason)
    model = task.case.scene(_channels(task.quantities, with_invariants))
    run = run_engine(adapter, model, task.setting)
    blank = replace(blank, seconds=run.seconds, setup_seconds=run.setup_seconds, steps=run.steps)
    if run.outcome is not Outcome.FINISHED or run.history is None:
        return _all_alike(task, blank, run.outcome, run.reason)
    motion = ObservedMotion(model, run.history)
    compared = {quantity.name: _compared(task.case, quantity, motion, blank) for quantity in task.quantities}
    return RunResult(
        tuple(record for record, _ in compared.values()),
        checks(task.case, motion, blank) if with_invariants else (),
        {name: found for name, (_, found) in compared.items() if found is not None},
        dict(run.details),
    )


def _all_alike(task: _Task, blank: Record, outcome: Outcome | Failure, reason: str) -> RunResult:
    """The records of a run that gave no motion."""
    blank = replace(blank, outcome=Verdict(outcome.value).value, detail=reason)
    return RunResult(tuple(replace(blank, quantity=q.name, unit=q.unit) for q in task.quantities), ())


def _compared(case: Case, quantity: Quantity, motion: ObservedMotion, blank: Record) -> tuple[Record, Deviation | None]:
    """The record of one quantity, and the deviation behind it; None where the run has no sample to judge."""
    blank = replace(blank, quantity=quantity.name, unit=quantity.unit)
    try:
        found = deviation(case, quantity, motion)
    except NoSampleError as error:
        return replace(blank, outcome=Verdict.UNDEFINED.value, detail=str(error)), None
    record = replace(
        blank,
        error_max=found.error_max,
        error_rms=found.error_rms,
        peak=found.peak,
        worst_time=found.worst_time,
        samples=found.samples,
        left_out=found.left_out,
    )
    return judge(record), found
