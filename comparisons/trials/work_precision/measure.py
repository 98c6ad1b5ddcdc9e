"""One point of a benchmark measured once, in a worker process."""

from __future__ import annotations

import gc
import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from pkgutil import resolve_name
from typing import Any, TypeVar

from comparisons.motion.case import Case, unpickle_case
from comparisons.trials.judging.quantities import (
    JOINT_FORCE,
    QUANTITIES,
    NoSampleError,
    Quantity,
    all_quantities,
    deviation,
)
from comparisons.trials.judging.records import Error, Verdict
from comparisons.trials.observed_motion import ObservedMotion
from comparisons.trials.runs.plugins import engine
from comparisons.trials.runs.run_engine import blamed_on, checked, started
from comparisons.trials.work_precision.table import BenchRun
from engines.contract import Engine, Method, Origin, Outcome, Run, Setting, StudiedEngine
from engines.scene import Scene

JOINTS = JOINT_FORCE.rstrip(":")
# Steps per turn of the peak speed in the run that warms an engine up.
WARM_UP_STEPS = 16.0
_WARM: set[str] = set()  # the engines this process has run

T = TypeVar("T")


def longest_step(case: Case, steps_per_turn: float) -> float:
    """The step, s, of which ``steps_per_turn`` make a turn at the crank's peak speed."""
    return 2.0 * math.pi / (case.motion.peak_speed * steps_per_turn)


def chosen_families(case: Case, names: Sequence[str]) -> dict[str, tuple[Quantity, ...]]:
    """The quantities that a case has, by those of the ``names`` that it has.

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

    ``with_errors`` adds the errors of ``quantities``. Raises AdapterError for every exception of the adapter but
    MemoryError.
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
        run, wall = timed(lambda: started(adapter, scene, usage, blank.step))
        run = checked(run, scene, blank.engine)
        inside = None
        if run.outcome is Outcome.FINISHED and isinstance(usage, Setting):
            inside = engine_seconds(adapter, lambda: started(adapter, scene, usage, None))
    measured = replace(_with_run(blank, run, wall), engine_seconds=inside)
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


def _with_run(blank: BenchRun, run: Run, wall: float) -> BenchRun:
    """A copy of the ``blank`` record with outcome, times and steps of a run.

    ``wall`` is the time of the whole call, s.
    """
    return replace(
        blank,
        outcome=run.outcome.value,
        detail=run.reason,
        seconds=run.seconds,
        setup_seconds=run.setup_seconds,
        readout_seconds=max(0.0, wall - run.seconds - run.setup_seconds),
        steps=run.steps,
        solver_work=run.solver_work,
        runs=max(1, len(run.passes)) if run.history else 0,
        used=", ".join(f"{name.replace('_', ' ')} {_number_words(value)}" for name, value in run.details.items()),
    )


def _number_words(value: str | int | float) -> str:
    """A number with six digits at most, or any other value, as text."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _family_errors(
    case: Case, families: Mapping[str, Sequence[Quantity]], motion: ObservedMotion, blank: Error
) -> Iterator[Error]:
    """Yield a motion's errors, of a family of quantities the worst member's.

    Each says what the engine does not tell.
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
    """The reason, in words, why the engine has no value of its own for a quantity; "" where it has one."""
    if quantity.lacking(motion):
        return "not offered"
    return "computed by the adapter" if quantity.origin(motion) is Origin.COMPUTED else ""


def _warm_up(adapter: Engine, scene: Scene, step: float) -> None:
    """Run an engine that this process has not run before, at a ``step``, s, so that it has imported all that it needs.

    Its exceptions are ignored: the measured run need not raise them.
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
        """The function made to add its time to ``inside``, or to subtract it for a ``sign`` of -1."""

        def clocked(*given: Any, **named: Any) -> Any:  # noqa: ANN401 - whatever the function takes
            """Call the function, whose result it returns, and add its time, s, with the sign, to ``inside``."""
            begun = time.perf_counter()
            try:
                return function(*given, **named)
            finally:
                self.inside += sign * (time.perf_counter() - begun)

        return clocked

    def around_callbacks(self, setter: Callable[..., Any]) -> Callable[..., Any]:
        """The function ``setter`` made to hand on a callback whose time is subtracted from ``inside``."""
        return lambda function: setter(function and self.around(function, -1.0))


def engine_seconds(adapter: Engine, run: Callable[[], Run]) -> float | None:
    """Wall time of a run inside the engine's own calls, s.

    None, without a run, if the adapter does not name these calls. The clock slows the run.
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
        timed(run)
    return clock.inside


def timed(work: Callable[[], T]) -> tuple[T, float]:
    """The return value of ``work`` and its wall time, s, without the garbage collector."""
    with no_collection():
        begun = time.perf_counter()
        result = work()
        return result, time.perf_counter() - begun
