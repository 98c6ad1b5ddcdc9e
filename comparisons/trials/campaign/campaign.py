"""A campaign: every mechanism under every regime in every engine and setting, judged into records."""

from __future__ import annotations

import pickle
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import Final

from analytic.description.crank_motion import CrankMotion
from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError, UnknownNameError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer.building import bare_sheet, usual_sheet
from comparisons.designer.sheet import Sheet
from comparisons.motion.case import Case, case_of_file_regime, unpickle_case
from comparisons.trials.invariants.checks import checks
from comparisons.trials.judging.limits import LimitTable, judge, shipped_limits
from comparisons.trials.judging.quantities import (
    JOINT_FORCE,
    NoSampleError,
    Quantity,
    check_defined,
    chosen_quantities,
    deviation,
)
from comparisons.trials.judging.records import CONTROL, Error, RunRecord, Verdict, run_of
from comparisons.trials.observed_motion import ObservedMotion
from comparisons.trials.runs.plugins import engine
from comparisons.trials.runs.run_engine import DEFAULT_BOUNDS, Failure, Lost, RunBounds, blamed_on, run_engine
from comparisons.trials.runs.store import Curve, Runs
from comparisons.trials.runs.workers import Announce, LocalPool, Pool, Task, TaskList, usual_processes
from engines.contract import Engine, Outcome, Setting
from engines.registry import engine_names, why_unavailable
from engines.scene import Channel

GRAVITY: Final = ", gravity "  # before "on" or "off", at the end of a motion's conditions


@dataclass(frozen=True)
class CampaignRequest:
    """What to compare. ``conditions`` words the motions' speed, times, direction and start angle, the same for all.

    ``own_regimes`` names regimes that a linkage's own file may define; linkages without them are not run in them. They
    have settings of their own: a released crank takes many turns. No quantities means all that are results.
    """

    linkages: tuple[Linkage, ...]
    motions: tuple[CrankMotion, ...]
    conditions: str
    engines: tuple[str, ...]
    settings: tuple[Setting, ...] = (Setting.TUNED,)
    quantities: tuple[str, ...] = ()
    own_regimes: tuple[str, ...] = ()
    own_settings: tuple[Setting, ...] = (Setting.TUNED,)
    with_invariants: bool = True


def tasks(request: CampaignRequest) -> list[Task]:
    """The tasks of a request's runs, in a stable order; a key identifies a run as ``Error.run`` does.

    Raises UnknownNameError for an engine or quantity, AssemblyError, StructureError, or LinkproofError where there is
    no regime to run in or a quantity has no value, before any run is made.
    """
    for name in request.engines:
        if name not in engine_names():
            raise UnknownNameError("engine", name, engine_names())
    return [task for case in each_case(request) for task in _tasks(request, case)]


def _tasks(request: CampaignRequest, case: Case) -> Iterator[Task]:
    """Yield the tasks of one case: every engine in every setting, of a released crank in the settings for own regimes.

    A task's job are the arguments of ``judged``. Raises UnknownNameError for an unknown quantity and LinkproofError for
    one without a value, but not for a thread's feed that is not asked for.
    """
    quantities = chosen_quantities(case, request.quantities)
    # A thread whose feed has no value is a row with the reason, unless it is requested explicitly.
    check_defined(
        case, [quantity for quantity in quantities if not quantity.needs_thread or quantity.name in request.quantities]
    )
    linkage, motion = case.mechanism.linkage, case.motion
    # Without what the check has worked out, which is a hundred times as large: there may be thousands of cases.
    pickled = pickle.dumps(replace(case, mechanism=Mechanism(linkage)))
    names = tuple(quantity.name for quantity in quantities)
    turned = motion.duration * motion.peak_speed
    for name in request.engines:
        for setting in request.settings if case.is_prescribed else request.own_settings:
            yield Task(
                key=run_of(case, setting, name).key,
                job=(pickled, name, setting, names, request.with_invariants),
                label=f"{linkage.name}, {motion.regime}: {name} {setting}",
                weight=turned * len(linkage.links),
            )


def each_case(request: CampaignRequest) -> Iterator[Case]:
    """Yield every linkage under every requested motion, then in its own requested regimes.

    Raises LinkproofError where there is none, AssemblyError where a linkage cannot follow its motion, StructureError
    for one that is no driver followed by Assur groups.
    """
    own = [regime for linkage in request.linkages for regime in linkage.regimes if regime.name in request.own_regimes]
    if not request.motions and not own:
        names = ", ".join(f"'{linkage.name}'" for linkage in request.linkages)
        raise LinkproofError(f"expected a regime that {names} can run in, got none of its own: ask for another regime")
    for linkage in request.linkages:
        conditions = f"{request.conditions}{GRAVITY}{'on' if any(linkage.gravity) else 'off'}"
        mechanism = Mechanism(linkage)
        cases = [Case(mechanism, motion, conditions=conditions) for motion in request.motions]
        mine = (regime for regime in linkage.regimes if regime.name in request.own_regimes)
        for case in chain(cases, (case_of_file_regime(mechanism, regime) for regime in mine)):
            case.check_motion()
            yield case


def compare(
    request: CampaignRequest,
    announce: Announce = lambda *_: None,
    *,
    bounds: RunBounds = DEFAULT_BOUNDS,
    pool: Pool | None = None,
    finished: Runs | None = None,
    todo: Sequence[Task] = (),
    limits: LimitTable | None = None,
) -> tuple[RunRecord, ...]:
    """The runs of a request, in its order, judged by the suite's limits or others; their curves stay in the store.

    ``announce`` receives the label of the run begun last, the number of finished runs and the number of all. Runs are
    made in the ``pool``, each within ``bounds``: in worker processes, one for every core, by default; a single run is
    made here, unbounded. ``finished`` runs are not repeated, and every further one is stored among them. ``todo`` are
    the request's ``tasks`` where they are known.

    What ``tasks`` raises is raised at once, before the first run; LinkproofError where no worker can start.
    """
    todo = todo or tasks(request)
    where = pool or LocalPool(usual_processes(len(todo)))
    study = TaskList(judged, lost, RunRecord.written, RunRecord.from_row, finished, announce, where)
    table = limits or shipped_limits()
    return tuple(run.judged(table.judge) for run in study.complete(todo, bounds))


def lost(
    failure: Lost, pickled: bytes, engine_name: str, setting: Setting, names: tuple[str, ...], _: bool
) -> RunRecord:
    """The record of a run whose process gave no result, with the reason in every quantity.

    Arguments after ``failure`` are those of ``judged``. Raises UnknownNameError for an engine or quantity,
    LinkproofError for a quantity that the case lacks.
    """
    case = unpickle_case(pickled)
    run = run_of(case, setting, engine_name, engine(engine_name).version() or "")
    return _without_motion(run, chosen_quantities(case, names), failure.outcome, failure.reason)


def judged(
    pickled: bytes, engine_name: str, setting: Setting, names: tuple[str, ...], with_invariants: bool
) -> RunRecord:
    """Make the run of a pickled case in an engine, in a worker, and judge these quantities by the suite's limits.

    ``names`` are those of quantities, () all that the case has. With it go the invariants, if wanted. A run that gives
    no motion has its outcome and reason in each quantity. Raises AdapterError for what the adapter raises,
    LinkproofError for a quantity that the case lacks or of which the closed form has no value.
    """
    case, adapter = unpickle_case(pickled), engine(engine_name)
    quantities = chosen_quantities(case, names)
    with blamed_on(adapter):
        version, absent = adapter.version(), why_unavailable(adapter)
    run = run_of(case, setting, engine_name, version or "")
    if absent is not None:
        return _without_motion(run, quantities, Outcome.UNAVAILABLE, absent)
    model = case.scene(Channel if with_invariants else {channel for q in quantities for channel in q.channels})
    made = run_engine(adapter, model, setting)
    run = replace(
        run, seconds=made.seconds, setup_seconds=made.setup_seconds, steps=made.steps, runs=max(1, len(made.passes))
    )
    if made.outcome is not Outcome.FINISHED or made.history is None:
        return _without_motion(run, quantities, made.outcome, made.reason)
    run = replace(run, details=dict(made.details))
    return compared(
        case, ObservedMotion(model, made.history), quantities, run, adapter, with_invariants=with_invariants
    )


def compared(
    case: Case,
    motion: ObservedMotion,
    quantities: Iterable[Quantity],
    run: RunRecord,
    adapter: Engine,
    *,
    with_invariants: bool = True,
) -> RunRecord:
    """A copy of the run with the errors of its motion in these quantities and, if asked for, its invariants.

    They are judged by the suite's limits; a quantity that cannot be judged has the reason. The curves of the quantities
    go with them. ``run`` gives the names; ``adapter`` is asked whether it is a control, and what it offers. Raises
    LinkproofError where the closed form has no value of a quantity.
    """
    blank = run.blank._replace(origin=CONTROL if adapter.is_control else "")
    found = [_compare_quantity(case, quantity, motion, blank, adapter) for quantity in quantities]
    return replace(
        run,
        errors=tuple(error for error, _ in found),
        invariants=checks(case, motion, blank) if with_invariants else (),
        curves={error.quantity: curve for error, curve in found if curve is not None},
    )


def _without_motion(
    run: RunRecord, quantities: Iterable[Quantity], outcome: Outcome | Failure, reason: str
) -> RunRecord:
    """A copy of the run with outcome and reason in a row for each quantity, since it gave no motion; no other row."""
    blank = run.blank._replace(outcome=Verdict(outcome.value).value, detail=reason)
    return replace(run, errors=tuple(blank._replace(quantity=q.name, unit=q.unit) for q in quantities))


def _compare_quantity(
    case: Case, quantity: Quantity, motion: ObservedMotion, blank: Error, adapter: Engine
) -> tuple[Error, Curve | None]:
    """A quantity's error, judged by the suite's limits, and its curve.

    The curve is None where the run has no sample of the quantity to judge; the error's outcome and detail say why:
    NOT_PROVIDED what the engine does not offer, ADAPTER_ERROR what it offers and was not recorded, else UNDEFINED. The
    origin is that of the ``blank`` record, if it has one, or the engine's own. Raises LinkproofError where the closed
    form has no value.
    """
    blank = blank._replace(quantity=quantity.name, unit=quantity.unit)
    lacking = quantity.lacking(motion)
    if lacking:
        if quantity.clock not in adapter.abilities.readouts or quantity.name.startswith(JOINT_FORCE):
            detail = f"{blank.engine} offers no {lacking}"
            return blank._replace(outcome=Verdict.NOT_PROVIDED.value, origin="", detail=detail), None
        detail = f"its adapter offers {lacking} but did not record it"
        return blank._replace(outcome=Verdict.ADAPTER_ERROR.value, origin="", detail=detail), None
    blank = blank._replace(origin=blank.origin or quantity.origin(motion).value)
    try:
        record, curve = deviation(case, quantity, motion, blank)
    except NoSampleError as error:
        return blank._replace(outcome=Verdict.UNDEFINED.value, detail=str(error)), None
    return judge(record), curve


# The data sheets of a campaign's linkages, made in worker processes.


def sheets(
    linkages: Sequence[Linkage], motions: Sequence[CrankMotion], regimes: Sequence[str], processes: int | None = None
) -> list[Sheet]:
    """The data sheet of every linkage, in their order, made in up to ``processes``; a failed one has the reason alone.

    Each is of the linkage's usual motion, chosen from ``motions`` and its own ``regimes`` of these names. ``processes``
    is ``usual_processes`` by default; with 0, or where no worker can start, this process makes them.
    """
    jobs = [(linkage, motions, regimes) for linkage in linkages]
    count = usual_processes(len(jobs)) if processes is None else processes
    try:
        table = dict(LocalPool(count).run(usual_sheet, jobs))
    except LinkproofError:  # no worker can be started
        table = dict(LocalPool(0).run(usual_sheet, jobs))
    return [
        bare_sheet(linkages[number], entry.reason) if isinstance(entry, Lost) else entry
        for number, entry in sorted(table.items())
    ]
