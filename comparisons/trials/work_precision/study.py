"""Work-precision: every engine, method and step measured on every case, round after round, one run at a time.

The first round goes down all sweeps of a case at once, coarse steps first, and takes the errors; the rounds after it
repeat every point of the case for its time alone. Each round visits all points in turn, so that a slow spell of the
machine hits all alike.
"""

from __future__ import annotations

import gc
import math
import pickle
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, contextmanager, suppress
from dataclasses import asdict, dataclass, field, replace
from itertools import groupby
from pkgutil import resolve_name
from typing import Any

from comparisons.motion.case import Case, unpickle_case
from comparisons.trials.judging.quantities import (
    JOINT_FORCE,
    QUANTITIES,
    NoSampleError,
    Quantity,
    all_quantities,
    deviation,
)
from comparisons.trials.judging.records import Error, Verdict, run_of
from comparisons.trials.observed_motion import ObservedMotion
from comparisons.trials.runs.environment import environment
from comparisons.trials.runs.plugins import engine
from comparisons.trials.runs.run_engine import Failure, Lost, RunBounds, blamed_on, checked, started
from comparisons.trials.runs.store import Runs
from comparisons.trials.runs.workers import ONE_BY_ONE, Announce, Pool, Task, TaskList
from comparisons.trials.work_precision.table import METHOD, SETTING, Bench, BenchRun, still_improves
from engines.contract import Engine, Method, Origin, Outcome, Run, Setting, StudiedEngine
from engines.mechanics.joints import turn_of_driver
from engines.registry import why_unavailable
from engines.scene import Channel, Scene

JOINTS = JOINT_FORCE.rstrip(":")
# Steps per turn of the peak speed in the run that warms an engine up.
WARM_UP_STEPS = 16.0
_WARM: set[str] = set()  # the engines this process has run


def longest_step(case: Case, steps_per_turn: float) -> float:
    """The step, s, of which ``steps_per_turn`` make a turn at the peak speed of a case's crank, which has to move.

    Of a linear driver a travel of the scene's size counts as a turn, as in the recipes of engines.
    """
    return turn_of_driver(case.scene(())) / (case.motion.peak_speed * steps_per_turn)


def chosen_families(case: Case, names: Sequence[str]) -> dict[str, tuple[Quantity, ...]]:
    """The quantities that a case has, by those of the ``names`` that it has; other names are left out.

    ``joint_force`` stands for all joints' forces. φ belongs to every case: under a prescribed motion it shows how well
    the drive is followed.
    """
    known = all_quantities(case)
    families: dict[str, tuple[Quantity, ...]] = {}
    for name in names:
        if name == JOINTS:
            families[name] = tuple(quantity for key, quantity in known.items() if key.startswith(JOINT_FORCE))
        elif name in known or name == "phi":
            families[name] = (known.get(name, QUANTITIES["phi"]),)
    return {name: quantities for name, quantities in families.items() if quantities}


def measure(
    pickled: bytes, usage: Setting | Method, blank: BenchRun, quantities: Sequence[str], with_errors: bool
) -> BenchRun:
    """Make the ``blank`` run of a pickled case once, by a setting or by a method at its step: a copy with the result.

    The engine is warmed up before, and the calls inside a setting's run are clocked in a run of their own.
    ``with_errors`` adds the errors of ``quantities``, by name; the outcome is then "undefined" where one has no sample
    to compare, "diverged" where an error is not finite, "not-provided" where the engine tells none. Raises AdapterError
    for every exception of the adapter but MemoryError and SystemExit.
    """
    case, adapter = unpickle_case(pickled), engine(blank.engine)
    families = chosen_families(case, quantities)
    channels = frozenset(
        channel for family in families.values() for quantity in family for channel in quantity.channels
    )
    scene = case.scene(channels)
    with blamed_on(adapter):
        if isinstance(usage, Method) and isinstance(adapter, StudiedEngine):
            adapter.methods(scene)  # an engine that cannot say its methods says here why
        _warm_up(adapter, scene, longest_step(case, WARM_UP_STEPS))
        with no_collection():
            run = started(adapter, scene, usage, blank.step)
        run = checked(run, scene, blank.engine)
        inside = None
        if run.outcome is Outcome.FINISHED and isinstance(usage, Setting):
            inside = engine_seconds(adapter, lambda: started(adapter, scene, usage, None))
    measured = replace(_with_run(blank, run), engine_seconds=inside)
    if not with_errors or run.outcome is not Outcome.FINISHED or run.history is None:
        return measured
    try:
        errors = tuple(_family_errors(case, families, ObservedMotion(scene, run.history), blank.blank))
    except NoSampleError as error:
        return replace(measured, outcome=Verdict.UNDEFINED.value, detail=str(error))
    endless = [record.quantity for record in errors if not math.isfinite(record.error_max or 0.0)]
    if endless:
        return replace(measured, outcome=Outcome.DIVERGED.value, detail=f"{endless[0]} is not finite")
    if all(record.error_max is None for record in errors):
        reasons = "; ".join(record.detail for record in errors)
        measured = replace(measured, outcome=Verdict.NOT_PROVIDED.value, detail=reasons)
    return replace(measured, errors=errors)


def _with_run(blank: BenchRun, run: Run) -> BenchRun:
    """A copy of the ``blank`` record with outcome, reason, times and steps of a run; 0 ``runs`` without a history."""
    return replace(
        blank,
        outcome=run.outcome.value,
        detail=run.reason,
        seconds=run.seconds,
        setup_seconds=run.setup_seconds,
        steps=run.steps,
        runs=max(1, len(run.passes)) if run.history else 0,
        details=dict(run.details),
    )


def _family_errors(
    case: Case, families: Mapping[str, Sequence[Quantity]], motion: ObservedMotion, blank: Error
) -> Iterator[Error]:
    """Yield a motion's errors, of a family of quantities the worst member's, under the family's name.

    Each says in ``detail`` what the engine does not tell. Raises NoSampleError where a quantity has no sample to
    compare.
    """
    alone = replace(case)  # the closed form on this clock goes when the point is done
    for name, family in families.items():
        reasons = {quantity.name: reason for quantity in family if (reason := _why_not_measured(quantity, motion))}
        detail = f"{', '.join(reasons)} {' or '.join(dict.fromkeys(reasons.values()))}" if reasons else ""
        found = [
            deviation(alone, quantity, motion, blank._replace(unit=quantity.unit))[0]
            for quantity in family
            if quantity.name not in reasons
        ]
        if not found:
            yield blank._replace(quantity=name, outcome=Verdict.NOT_PROVIDED.value, detail=detail)
            continue
        worst = max(found, key=lambda error: error.error_max or 0.0)
        rms = max(error.error_rms or 0.0 for error in found)
        yield worst._replace(quantity=name, error_rms=rms, outcome=Verdict.MEASURED.value, detail=detail)


def _why_not_measured(quantity: Quantity, motion: ObservedMotion) -> str:
    """The reason why the engine has no value of its own for a quantity; "" where it has one.

    It is "not offered" or "computed by the adapter".
    """
    if quantity.lacking(motion):
        return "not offered"
    return "computed by the adapter" if quantity.origin(motion) is Origin.COMPUTED else ""


def _warm_up(adapter: Engine, scene: Scene, step: float) -> None:
    """Run an engine that this process has not run before, so that it has imported all that it needs.

    It runs by its first method at a ``step``, s, or, without methods, in ``tuned``; later calls for this engine do
    nothing. Its exceptions are ignored: the measured run need not raise them.
    """
    if adapter.name in _WARM:
        return
    _WARM.add(adapter.name)
    with suppress(Exception):
        if isinstance(adapter, StudiedEngine):
            adapter.run_method(scene, adapter.methods(scene)[0], step)
        else:
            adapter.run(scene, Setting.TUNED)


# Time measured properly: without the garbage collector.


@contextmanager
def no_collection() -> Iterator[None]:
    """In the block, switch the garbage collector off; afterwards it is as before."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


class Clock:
    """Wall time, s, ``inside`` an engine's own calls, without that of the functions it calls back."""

    def __init__(self) -> None:
        """A clock that stands at 0 s."""
        self.inside = 0.0

    def around(self, function: Callable[..., Any], sign: float = 1.0) -> Callable[..., Any]:
        """The function made to add its time to ``inside``, or to subtract it for a ``sign`` of -1.

        Arguments, result and exceptions are the function's own.
        """

        def clocked(*given: Any, **named: Any) -> Any:  # noqa: ANN401 - whatever the function takes
            """Call the function, whose result it returns, and add its time, s, with the sign, to ``inside``."""
            begun = time.perf_counter()
            try:
                return function(*given, **named)
            finally:
                self.inside += sign * (time.perf_counter() - begun)

        return clocked

    def around_callbacks(self, setter: Callable[..., Any]) -> Callable[..., Any]:
        """The function ``setter`` made to hand on a callback whose time is subtracted from ``inside``.

        ``setter(callback)`` takes the callback, or None, and its result comes back.
        """
        return lambda function: setter(function and self.around(function, -1.0))


def engine_seconds(adapter: Engine, run: Callable[[], Run]) -> float | None:
    """Wall time, s, inside the engine's own calls in a run that ``run()`` makes; None, without one, if none is named.

    The adapter names these calls, as dotted paths, in ``engine_calls``, and in ``callback_calls`` those that take a
    function of its own for the engine to call back. They are wrapped in place for the time of the run. The clock slows
    the run.
    """
    clock = Clock()
    wrappers = dict.fromkeys(getattr(adapter, "engine_calls", ()), clock.around)
    if not wrappers:
        return None
    wrappers |= dict.fromkeys(getattr(adapter, "callback_calls", ()), clock.around_callbacks)
    with ExitStack() as restored:
        for name, wrapper in wrappers.items():
            path, _, attribute = name.rpartition(".")
            owner = resolve_name(path)
            restored.callback(setattr, owner, attribute, getattr(owner, attribute))
            setattr(owner, attribute, wrapper(getattr(owner, attribute)))
        with no_collection():
            run()
    return clock.inside


# The sweeps, round after round.


# A step too long for an engine may be cured by a shorter one, but not for ever.
MOST_FAILURES = 3
# Steps that every sweep takes, whatever they cost and gain: fewer are no curve, and show neither order nor floor.
FEWEST = 6
LASTING_FAILURES = (
    Failure.TIMED_OUT,
    Outcome.UNSUPPORTED,
    Outcome.UNAVAILABLE,
    Verdict.NOT_PROVIDED,
)  # whatever the step
# A run that takes this much longer than its budget, s, hangs.
HANG_SECONDS = 60.0
USUAL_QUANTITIES = ("Mkr", "Jeq", "phi", "joint_force")


@dataclass(frozen=True)
class Extent:
    """The extent of a benchmark.

    ``steps_per_turn`` of the crank's peak speed, coarse to fine; after ``FEWEST`` a sweep ends before a point that
    would take longer than ``budget``, s. A point is timed ``repeats`` times, fewer once it has taken ``patience``, s,
    in all; both count set-up and stepping. No run is begun after ``deadline``, s from the start. ``fronts_only``
    measures of each engine the most advanced method, of a single run and of several, and leaves out the best setting,
    which repeats one.
    """

    steps_per_turn: tuple[float, ...]
    budget: float
    repeats: int
    patience: float
    deadline: float = math.inf
    fronts_only: bool = False


FULL = Extent(tuple(12.0 * 2.0**k for k in range(12)), budget=1.0, repeats=5, patience=0.6)
QUICK = Extent(
    tuple(6.0 * 2.0**k for k in range(8)), budget=0.3, repeats=2, patience=0.1, deadline=45.0, fronts_only=True
)
OUT_OF_TIME = "the time for the whole benchmark was up"


@dataclass
class PointSweep:
    """A sweep under way: a setting, or a method from coarse steps to fine ones, of one engine on one case.

    ``case`` is its place among the cases, ``usage`` the setting or method; None if the engine is not installed.
    ``points`` are its runs before they are made, ``measurements`` those that are made. ``ended`` says why it went no
    further, once it has ended.
    """

    case: int
    usage: Setting | Method | None
    points: Sequence[BenchRun]
    budget: float = math.inf
    measurements: list[BenchRun] = field(default_factory=list)
    ended: str = ""

    def next(self) -> BenchRun | None:
        """The point to measure next, the same until ``add``; None, with ``ended`` set, when the sweep has ended."""
        if not self.ended:
            self.ended = self._why_ended()
        return None if self.ended else self.points[len(self.measurements)]

    def add(self, measurement: BenchRun | None) -> None:
        """Record the measurement of the next point; None ends the sweep for lack of time."""
        if measurement is None:
            self.ended = OUT_OF_TIME
        else:
            self.measurements.append(measurement)

    def _why_ended(self) -> str:
        """Why the sweep has no next point, in words; "" while it goes on.

        It ends at the last point, at a failure that ends it, and after ``FEWEST`` points where no error improves or the
        next one would take longer than the budget.
        """
        done = self.measurements
        if done and done[-1].outcome != Outcome.FINISHED:
            return self._why_failed()
        if len(done) == len(self.points):
            return "the sweep ends here"
        if len(done) < FEWEST:
            return ""
        finished = [each for each in done if each.outcome == Outcome.FINISHED]
        errors = [[error.error_max for error in each.errors if error.error_max is not None] for each in finished]
        if not any(still_improves(entries) for entries in zip(*errors, strict=True)):
            return "two refinements in a row improved nothing"
        price = self._estimated_seconds(self.points[len(done)])
        if price > self.budget:
            return f"the next step would take about {price:.2g} s, over {self.budget:g} s"
        return ""

    def _estimated_seconds(self, point: BenchRun) -> float:
        """Estimated time of a point, s, from the cheapest set-up and step so far, without slow spells; 0 before any."""
        rates = [run.seconds / run.steps_per_turn for run in self.measurements if run.steps_per_turn and run.seconds]
        setup = min((measurement.setup_seconds for measurement in self.measurements), default=0.0)
        return setup + min(rates, default=0.0) * (point.steps_per_turn or 0.0)

    def _why_failed(self) -> str:
        """The last failure in words if it ends the sweep, else "".

        It does if it is lasting, follows a success, or is the third or the last point.
        """
        last = self.measurements[-1]
        lasting = last.outcome in LASTING_FAILURES
        worked = any(each.outcome == Outcome.FINISHED for each in self.measurements)
        if lasting or worked or len(self.measurements) in (MOST_FAILURES, len(self.points)):
            return f"{last.outcome}: {last.detail}"
        return ""


@dataclass(frozen=True)
class BenchRequest:
    """The request of a benchmark; no ``methods`` means all of them.

    ``engines``, ``quantities`` and ``methods`` are names. The ``pool`` makes one run at a time on a machine.
    ``command`` repeats it.
    """

    cases: tuple[Case, ...]
    engines: tuple[str, ...]
    quantities: tuple[str, ...] = USUAL_QUANTITIES
    settings: tuple[Setting, ...] = tuple(Setting)
    methods: tuple[str, ...] = ()
    extent: Extent = FULL
    pool: Pool = ONE_BY_ONE
    command: str = ""


class Rounds:
    """The measurements of every point in every round; no run begins after the deadline of the request's extent.

    The first round takes the errors, the others the time alone. ``finished`` ones are not measured again.
    """

    def __init__(self, request: BenchRequest, announce: Announce, finished: Runs | None) -> None:
        """Begin the time of a benchmark: its deadline counts from now.

        ``finished`` keeps the measurements, and None makes a temporary file do so; ``announce`` hears of each.
        """
        self.request, self.extent = request, request.extent
        self.pickled = [pickle.dumps(case) for case in request.cases]
        self.ends = time.monotonic() + request.extent.deadline
        self.study: TaskList[BenchRun] = TaskList(
            measure, self._lost_point, BenchRun.written, BenchRun.from_row, finished, announce, request.pool
        )

    def run(self, number: int, batch: Sequence[tuple[PointSweep, BenchRun]]) -> None:
        """Measure the points of a ``batch``, each of its sweep, in the round ``number``, as long as there is time.

        The first round is 0. Results are kept for ``measurement``. Raises LinkproofError where no worker can start.
        """
        tasks = [self._point_task(number, sweep, point) for sweep, point in batch]
        self.study.expect(tasks)
        bounds = RunBounds(seconds=min(HANG_SECONDS + 20.0 * self.extent.budget, max(1.0, self.seconds_left())))
        with closing(self.study.make(tasks, bounds)) as ended:  # which ends the worker, if the time is up
            while self.seconds_left() > 0.0 and next(ended, None) is not None:
                pass

    def measurement(self, number: int, point: BenchRun) -> BenchRun | None:
        """The measurement of a point in a round, from 0; None if it was not measured."""
        key = _task_key(number, point)
        return self.study.result(key) if self.study.has(key) else None

    def repeats(self, point: BenchRun, rounds: int) -> list[BenchRun]:
        """The finished measurements of a point in the first ``rounds`` rounds, round by round."""
        every = [run for number in range(rounds) if (run := self.measurement(number, point)) is not None]
        return [run for run in every if run.outcome == Outcome.FINISHED]

    def is_worth_repeating(self, point: BenchRun, number: int) -> bool:
        """Whether a point takes part in the round ``number``: it has finished, and its repeats were short enough.

        Their set-up and stepping have taken less than ``patience`` together.
        """
        before = self.repeats(point, number)
        return bool(before) and sum(run.total_seconds for run in before) < self.extent.patience

    def runs(self, sweep: PointSweep) -> Iterator[BenchRun]:
        """Yield one run per measured point of a sweep, its times, s, the shortest of its repeats, 0 without any.

        An unmeasured sweep is shown by its first point, timed out, with the reason.
        """
        if not sweep.measurements:
            late = Failure.TIMED_OUT.value
            yield replace(sweep.points[0], outcome=late, detail=sweep.ended, ended=sweep.ended)
        for point, first in zip(sweep.points, sweep.measurements, strict=False):
            repeats = self.repeats(point, self.extent.repeats)
            inside = [run.engine_seconds for run in repeats if run.engine_seconds is not None]
            yield replace(
                first,
                seconds=min((run.seconds for run in repeats), default=0.0),
                setup_seconds=min((run.setup_seconds for run in repeats), default=0.0),
                engine_seconds=min(inside, default=None),
                repeats=tuple(run.seconds for run in repeats),
                ended=sweep.ended,
            )

    def _point_task(self, number: int, sweep: PointSweep, point: BenchRun) -> Task:
        """The task that measures a point of a sweep in a round; only round 0 computes errors."""
        job = (self.pickled[sweep.case], sweep.usage, point, self.request.quantities, number == 0)
        steps = "" if point.steps_per_turn is None else f", {point.steps_per_turn:g} steps a turn"
        label = f"round {number + 1}: {point.mechanism}, {point.regime}, {point.engine} {point.setting}{steps}"
        return Task(_task_key(number, point), job, label)

    def _lost_point(self, lost: Lost, _: bytes, __: object, blank: BenchRun, *___: object) -> BenchRun | None:
        """The record of a run without a result; None if the benchmark's own deadline ended it.

        Its arguments are the loss and those of ``measure``, of which ``blank`` alone counts.
        """
        return None if self.seconds_left() <= 0.0 else replace(blank, outcome=lost.outcome.value, detail=lost.reason)

    def seconds_left(self) -> float:
        """Time until the deadline, s; negative after it."""
        return self.ends - time.monotonic()


def _task_key(number: int, point: BenchRun) -> str:
    """The key of a point's measurement in a round, from 0: "NUMBER KEY"."""
    return f"{number} {point.key}"


def bench(request: BenchRequest, announce: Announce = lambda *_: None, finished: Runs | None = None) -> Bench:
    """Measure everything requested, round after round; ``finished`` points are not measured again, new ones are added.

    ``announce`` hears a label, how many runs are done and how many are known of. Raises UnknownNameError for an engine
    before any run is made, LinkproofError where no worker can start.
    """
    sweeps = list(_sweeps(request))
    rounds = Rounds(request, announce, finished)
    longest = 0.0
    for turn in _sweep_groups(request.cases, sweeps):
        begun = time.monotonic()
        if rounds.seconds_left() < longest:  # some points of a curve would show nothing
            for sweep in turn:
                sweep.add(None)
        while batch := [(sweep, point) for sweep in turn if (point := sweep.next()) is not None]:
            rounds.run(0, batch)
            for sweep, point in batch:
                sweep.add(rounds.measurement(0, point))
        done = [(sweep, point) for sweep in turn for point in sweep.points[: len(sweep.measurements)]]
        for number in range(1, request.extent.repeats):
            rounds.run(number, [each for each in done if rounds.is_worth_repeating(each[1], number)])
        longest = max(longest, time.monotonic() - begun)
    return Bench(_document(request), _runs(request, sweeps, rounds))


def _document(request: BenchRequest) -> dict[str, Any]:
    """The benchmark without its points, JSON-ready, as ``SavedBench``."""
    linkages = {case.mechanism.linkage.name: case.mechanism.linkage for case in request.cases}
    return {
        "command": request.command,
        "conditions": "; ".join(dict.fromkeys(case.conditions for case in request.cases)),
        "environment": environment(request.engines),
        "extent": {name: value for name, value in asdict(request.extent).items() if value != math.inf},
        "mechanisms": [
            {"name": linkage.name, "title": linkage.title, "variant": linkage.variant} for linkage in linkages.values()
        ],
        "methods": _method_descriptions(request),
        "quantities": list(request.quantities),
    }


def _method_descriptions(request: BenchRequest) -> list[Mapping[str, Any]]:
    """The engines' descriptions of the requested methods, each once, JSON-ready: "engine" and ``Method``'s fields."""
    methods: dict[tuple[str, str], Mapping[str, Any]] = {}
    for case in request.cases:
        for name in request.engines:
            for method in _methods(request, case, name):
                methods.setdefault((name, method.name), {"engine": name, **asdict(method)})
    return list(methods.values())


def _methods(request: BenchRequest, case: Case, name: str) -> list[Method]:
    """The requested methods of an engine, named, for a case; [] if it cannot be used or studied here.

    Where the adapter raises, methods of the requested names, or one, "methods", whose runs show what it raises. Raises
    UnknownNameError for an engine that does not exist.
    """
    adapter = engine(name)
    if why_unavailable(adapter) is not None or not isinstance(adapter, StudiedEngine):
        return []
    try:
        offered = adapter.methods(case.scene([Channel.POSITION]))
    except Exception as error:  # a run tells what the adapter raises
        return [Method(name, str(error)) for name in request.methods or ("methods",)]
    return [method for method in offered if not request.methods or method.name in request.methods]


def _sweeps(request: BenchRequest) -> Iterator[PointSweep]:
    """Yield all sweeps of the request; an engine that cannot be used has a single point that says why.

    Raises UnknownNameError for an engine that does not exist.
    """
    for number, case in enumerate(request.cases):
        for name in request.engines:
            absent = why_unavailable(engine(name))
            if absent is not None:
                run = replace(blank_run(case, name, None), outcome=Outcome.UNAVAILABLE.value, detail=absent)
                yield PointSweep(number, None, [run], measurements=[run])
            else:
                methods = _methods(request, case, name)
                yield from planned_sweeps(number, case, name, methods, request)


def planned_sweeps(
    number: int, case: Case, engine_name: str, methods: Sequence[Method], request: BenchRequest
) -> Iterator[PointSweep]:
    """Yield the sweeps of one engine on the case numbered ``number``: settings first, then these ``methods``.

    Settings and extent are the request's; with ``fronts_only`` all settings but the best, and of the methods the last
    of a single run and the last of several. Raises UnknownNameError for the engine.
    """
    settings, extent = request.settings, request.extent
    if extent.fronts_only:
        settings = tuple(setting for setting in settings if setting is not Setting.BEST)
        methods = [*_most_advanced(methods, extrapolated=False), *_most_advanced(methods, extrapolated=True)]
    for setting in settings:
        yield PointSweep(number, setting, [blank_run(case, engine_name, setting)])
    for method in methods:
        points = [blank_run(case, engine_name, method, steps) for steps in extent.steps_per_turn]
        yield PointSweep(number, method, points, extent.budget)


def _most_advanced(methods: Sequence[Method], *, extrapolated: bool) -> list[Method]:
    """The last-named method of one run, or of several runs if ``extrapolated``, as a list of one; [] without one."""
    return [method for method in methods if (method.runs > 1) == extrapolated][-1:]


def blank_run(case: Case, name: str, usage: Setting | Method | None, steps_per_turn: float | None = None) -> BenchRun:
    """The run of a case in an engine by a ``usage``, a setting or a method at a step, before it is made.

    ``name`` is the engine's; a ``usage`` of None is that of an engine that cannot be used. A method takes the step of
    ``steps_per_turn``, a setting has None. Raises UnknownNameError for the engine.
    """
    adapter, method = engine(name), usage if isinstance(usage, Method) else None
    own = run_of(case, method.name if method else str(usage or ""), name, adapter.version() or "")
    return BenchRun(
        **vars(own),
        is_control=adapter.is_control,
        kind=METHOD if method else SETTING,
        effort=method.effort if method else None,
        effort_unit=method.effort_unit if method else "",
        step=None if steps_per_turn is None else longest_step(case, steps_per_turn),
        steps_per_turn=steps_per_turn,
        outcome="",
    )


def _sweep_groups(cases: Sequence[Case], sweeps: Sequence[PointSweep]) -> list[list[PointSweep]]:
    """Sweeps in groups, of a case each, to be measured to their ends and repeated one after the other.

    Where the time ends first, a linkage of each structure has whole curves, rather than every linkage a point: the
    first case of a structure comes before all that repeat one, single runs before extrapolated ones.
    """
    known: set[frozenset[str]] = set()
    repeated = []
    for case in cases:
        kinds = frozenset(group.kind for group in case.mechanism.structure.groups)
        repeated.append(kinds in known)
        known.add(kinds)

    def place(sweep: PointSweep) -> tuple[bool, bool, int]:
        """The sort key of a sweep: first of its structure, then single runs, then the order of cases.

        Sweeps of equal keys are a group.
        """
        is_extrapolated = isinstance(sweep.usage, Method) and sweep.usage.runs > 1
        return repeated[sweep.case], is_extrapolated, sweep.case

    return [list(group) for _, group in groupby(sorted(sweeps, key=place), place)]


def _runs(request: BenchRequest, sweeps: Sequence[PointSweep], rounds: Rounds) -> list[BenchRun]:
    """All runs by case and engine in the requested order, then in the order of sweeps and measuring."""
    places = {name: place for place, name in enumerate(request.engines)}
    ordered = sorted(sweeps, key=lambda sweep: (sweep.case, places[sweep.points[0].engine]))
    return [run for sweep in ordered for run in rounds.runs(sweep)]
