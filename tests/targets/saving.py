"""What a setting saves against a newcomer's fixed steps at the same error: the engine's first method, step by step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from comparisons.reference.case import Case
from comparisons.runs.study import Announce
from comparisons.work_precision.analysis import by_engine, method_sweeps
from comparisons.work_precision.points import Extent
from comparisons.work_precision.records import METHOD, SETTING, BenchRecord
from comparisons.work_precision.step_sweep import price, short
from comparisons.work_precision.study import BenchRequest, bench
from engines.contract import Setting
from engines.registry import engine
from engines.scene import Channel


@dataclass(frozen=True)
class Saving:
    """A setting against plain fixed steps at an error ``wanted``, in one quantity of one mechanism and regime.

    ``seconds`` is what the plain steps cost where they first hold that error, read between two measured steps; None
    where they never do. They then were followed down to ``least_error`` at a cost of ``spent``, s, and ``why`` they get
    no further; ``projected`` is what they would cost by their observed order, s, None where they have stopped falling.
    """

    wanted: float
    record: BenchRecord
    plain: str
    seconds: float | None
    least_error: float
    spent: float
    why: str
    projected: float | None

    @property
    def own_seconds(self) -> float:
        """Time of the setting, set-up and stepping, s."""
        return self.record.total_seconds

    @property
    def ratio(self) -> float | None:
        """How many times as long the plain steps take; None where they never get there."""
        return None if self.seconds is None else self.seconds / self.own_seconds

    @property
    def sentence(self) -> str:
        """The comparison in words."""
        one = self.record
        held = f"{short(one.error_max or 0.0)} of {one.quantity} in {_ms(self.own_seconds)}"
        told = f"{one.engine} {one.setting} reaches {held}; "
        if self.seconds is not None:
            times = self.seconds / self.own_seconds
            return (
                told
                + f"{self.plain} first holds {short(self.wanted, 0)} after {_ms(self.seconds)}, {times:.3g} × as long"
            )
        told += (
            f"{self.plain} did not reach {short(self.wanted, 0)}: {short(self.least_error)} after {_ms(self.spent)}, "
        )
        if self.projected is None:
            return told + self.why
        times = self.projected / self.own_seconds
        return told + f"{self.why}; by its order it would take {_ms(self.projected)}, {times:.3g} × as long"


def _ms(seconds: float) -> str:
    return f"{1e3 * seconds:.3g} ms" if seconds < 1.0 else f"{seconds:.3g} s"


def saving(records: Sequence[BenchRecord], setting: str, wanted: float) -> Saving | None:
    """A setting against the engine's first method, at the effort it comes with, among one engine's records.

    All records are of one quantity of one mechanism and regime. None where the setting does not hold the error itself,
    or nothing plain was measured.
    """
    held = [
        one
        for one in records
        if one.kind == SETTING and one.setting == setting and one.finished and (one.error_max or 0.0) <= wanted
    ]
    first = next((one.sweep for one in records if one.kind == METHOD), None)
    plain = next((one for one in method_sweeps(records) if one.first.sweep == first), None)
    if not held or plain is None:
        return None
    errors = plain.numbers.errors
    return Saving(
        wanted=wanted,
        record=held[0],
        plain=plain.first.setting,
        seconds=price(plain.seconds, errors, wanted),
        least_error=min(errors),
        spent=plain.least.total_seconds,
        why=f"{plain.floor.cause} ({plain.floor.evidence})",
        projected=_projected(plain.seconds[-1], errors[-1], wanted, plain.order if plain.numbers.is_falling else None),
    )


def _projected(seconds: float, error: float, wanted: float, order: float | None) -> float | None:
    """What the steps would cost at an error not reached, if they went on as they fell; cost goes as 1/step."""
    return None if order is None or error <= wanted else seconds * (error / wanted) ** (1.0 / order)


# The plain steps are followed for as long as a point takes no more than ten seconds, or two refinements bring nothing.
PATIENT = Extent(tuple(12.0 * 2.0**k for k in range(16)), budget=10.0, repeats=3, patience=2.0)


def plain_savings(
    case: Case,
    engines: Sequence[str],
    wanted: float = 1e-6,
    *,
    quantity: str = "Mkr",
    extent: Extent = PATIENT,
    announce: Announce = lambda *_: None,
) -> dict[str, Saving]:
    """What each engine's ``best`` saves against its first method at an error, ``wanted`` of the quantity's peak.

    Engines that are not installed, or whose ``best`` misses the error, are left out. Takes seconds to a minute.
    """
    scene = case.scene([Channel.POSITION])
    installed = {name: engine(name) for name in engines}
    installed = {name: adapter for name, adapter in installed.items() if adapter.version() is not None}
    savings = {}
    for name, adapter in installed.items():
        plain = adapter.methods(scene)[0].name
        request = BenchRequest((case,), (name,), (quantity,), (Setting.BEST,), (plain,), extent)
        for records in by_engine(bench(request, announce).records).values():
            found = saving(records, Setting.BEST.value, wanted)
            if found is not None:
                savings[name] = found
    return savings
