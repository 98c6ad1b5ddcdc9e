"""The results seen one mechanism at a time: its closed form, its records in a stable order, its curves."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from analytic.errors import LinkproofError
from analytic.harmonics import top_dead_centre
from analytic.linkage import Linkage
from analytic.mechanism import Mechanism
from analytic.regimes import CrankMotion
from comparisons.deviations import near_jumps
from comparisons.quantities import QUANTITIES
from comparisons.records import Record
from comparisons.results import Results
from engines.contract import Setting

Array = NDArray[np.float64]
SETTINGS = tuple(setting.value for setting in Setting)


@dataclass(frozen=True)
class Trace:
    """One quantity of one run: ``time``, ``angle`` (φ), ``observed`` and ``reference``, all (n,), SI.

    ``error`` is |observed − reference| over the reference's peak, NaN where the comparison left a sample out.
    """

    record: Record
    time: Array
    angle: Array
    observed: Array
    reference: Array
    error: Array

    @property
    def label(self) -> str:
        """Engine and setting."""
        return f"{self.record.engine} {self.record.setting}"


@dataclass(frozen=True)
class View:
    """One mechanism in one variant, with its part of the results."""

    results: Results
    linkage: Linkage

    @property
    def key(self) -> str:
        """A name fit for an anchor."""
        return f"{self.linkage.name}-{self.linkage.variant}"

    @cached_property
    def mechanism(self) -> Mechanism:
        """The closed form."""
        return Mechanism(self.linkage)

    @cached_property
    def has_output(self) -> bool:
        """Whether S, v and a exist: the linkage names an output, and the output reverses."""
        if self.linkage.output is None:
            return False
        try:
            top_dead_centre(self.mechanism)
        except LinkproofError:
            return False
        return True

    @cached_property
    def records(self) -> tuple[Record, ...]:
        """Records and invariants of this mechanism, by regime, engine, setting and quantity."""
        mine = (self.linkage.name, self.linkage.variant)
        every = (*self.results.records, *self.results.invariants)
        return ordered(self.results, [record for record in every if record.run[:2] == mine])

    @cached_property
    def motions(self) -> tuple[CrankMotion, ...]:
        """The crank motions this mechanism ran through."""
        ran = {record.regime for record in self.records}
        return tuple(motion for motion in self.results.motions if motion.regime in ran)

    @cached_property
    def final_speed(self) -> float:
        """Crank speed at the end of the first regime, rad/s, signed."""
        motion = self.motions[0]
        return float(motion.speed(motion.duration))

    @cached_property
    def setting(self) -> str:
        """The setting whose curves stand for an engine: tuned where it ran."""
        ran = {record.setting for record in self.records}
        return Setting.TUNED.value if Setting.TUNED.value in ran else next((s for s in SETTINGS if s in ran), "")

    def traces(self, motion: CrankMotion, quantity: str) -> list[Trace]:
        """The curves of a quantity under a regime, of every run that gave one."""
        return [
            self._trace(motion, record)
            for record in self.records
            if record.regime == motion.regime and record.quantity == quantity and record.error_max is not None
        ]

    def _trace(self, motion: CrankMotion, record: Record) -> Trace:
        time, observed, reference = self.results.curve(record.run, record.quantity)
        error = np.abs(observed - reference) / (record.peak or 1.0)
        if QUANTITIES[record.quantity].holds_acceleration:
            error = np.where(near_jumps(time, motion.jumps), np.nan, error)
        return Trace(record, time, motion.angle(time), observed, reference, error)


def views(results: Results) -> tuple[View, ...]:
    """One view per mechanism and variant, in the campaign's order."""
    return tuple(View(results, linkage) for linkage in results.linkages)


def engines(results: Results) -> tuple[str, ...]:
    """Names of all engines asked for, sorted: an engine keeps its colour within a report."""
    return tuple(sorted({record.engine for record in results.records}))


def columns(results: Results) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Names of the quantities and of the invariants, in the order of their definition."""
    quantities = tuple(dict.fromkeys(record.quantity for record in results.records))
    invariants = tuple(dict.fromkeys(record.quantity for record in results.invariants))
    return quantities, invariants


def ordered(results: Results, records: Iterable[Record]) -> tuple[Record, ...]:
    """Records by mechanism, variant and regime as the campaign has them, then engine, setting, quantity."""
    mechanisms = [(linkage.name, linkage.variant) for linkage in results.linkages]
    regimes = [motion.regime for motion in results.motions]
    quantities, invariants = columns(results)
    names = [*quantities, *invariants]

    def rank(record: Record) -> tuple[int, int, str, int, int]:
        return (
            mechanisms.index(record.run[:2]),
            regimes.index(record.regime),
            record.engine,
            SETTINGS.index(record.setting) if record.setting in SETTINGS else len(SETTINGS),
            names.index(record.quantity),
        )

    return tuple(sorted(records, key=rank))
