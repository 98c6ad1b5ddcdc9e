"""Which engine to trust for which quantity: a campaign's records by engine, setting and family of quantities."""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

from analytic.description.linkage import ReleasedRegime
from comparisons.trials.campaign.results import CampaignResults
from comparisons.trials.judging.limits import deciding, grouped
from comparisons.trials.judging.records import CONTROL, Error, RunRecord, Verdict
from engines.contract import Setting
from reports.document import numbers
from reports.document.numbers import figure
from reports.document.templates import sentence
from reports.records import family, share

# Quantities that go together; any other quantity that is no check stands under OTHER.
FAMILIES: Final = {
    "S/v/a": ("S", "v", "a"),
    "thread feed": ("thread_feed",),
    "Jeq/Teq": ("Jeq", "Teq"),
    "Mkr/Peq": ("Mkr", "Peq"),
    "joint forces": ("joint_force",),
}
OTHER: Final = "other signals"
RELEASED: Final = "a released crank"
CHECKS: Final = "checks of the motion"
MOST_PERCENT: Final = 100.0  # peaks that are given in per cent
SHIFT: Final = 0.01  # s that is added to times for their geometric mean, lest the shortest decide it
# The setting that decides, the first of these that ran; what an engine does untuned is shown and decides nothing.
DECISIVE: Final = (Setting.TUNED.value, Setting.BEST.value, Setting.NAIVE.value)


@dataclass(frozen=True)
class EngineRecords:
    """The records of one engine at one setting in one family of quantities, judged or not."""

    records: tuple[Error, ...]

    @cached_property
    def judged(self) -> tuple[Error, ...]:
        """The records that count for or against the engine."""
        return tuple(record for record in self.records if Verdict(record.outcome).judged)

    @property
    def worst(self) -> Error | None:
        """The record with the largest error over its limit; None if no record has an error."""
        return max((r for r in self.judged if r.error_max is not None), key=share, default=None)

    @property
    def error(self) -> float | None:
        """The largest error over the peak; None if no record has an error."""
        return max((r.error_max for r in self.judged if r.error_max is not None), default=None)

    @property
    def failed(self) -> bool:
        """Whether any record counts against the engine."""
        return any(Verdict(record.outcome).failed for record in self.judged)


@dataclass(frozen=True)
class EngineRanking:
    """The ranking of a campaign's engines."""

    results: CampaignResults

    @cached_property
    def cells(self) -> Mapping[tuple[str, str, str], EngineRecords]:
        """Records and invariants by engine, setting and family of quantities."""
        every = (*self.results.records, *self.results.invariants)
        groups = grouped(((record.engine, record.setting, self._family_of_record(record)), record) for record in every)
        return {key: EngineRecords(tuple(records)) for key, records in groups.items()}

    @cached_property
    def families(self) -> tuple[str, ...]:
        """The families in which any engine was judged, in the order of the table."""
        some = {name for (_, _, name), cell in self.cells.items() if cell.judged}
        return tuple(name for name in (*FAMILIES, OTHER, RELEASED, CHECKS) if name in some)

    @cached_property
    def settings(self) -> tuple[str, ...]:
        """The settings that ran, the decisive one first."""
        ran = {setting for _, setting, _ in self.cells}
        return (*(name for name in DECISIVE if name in ran), *sorted(ran - {*DECISIVE}))

    def is_idle(self, setting: str) -> bool:
        """Whether a setting decides nothing: the naive one beside others."""
        return setting == Setting.NAIVE.value and setting in self.settings[1:]

    @cached_property
    def controls(self) -> frozenset[str]:
        """Names of the controls, that is, of the reference's second derivation."""
        return frozenset(record.engine for record in self.results.records if record.origin == CONTROL)

    @cached_property
    def engines(self) -> tuple[str, ...]:
        """Names of the engines, sorted, those of controls last."""
        return tuple(sorted({engine for engine, _, _ in self.cells}, key=lambda name: (name in self.controls, name)))

    def records(self, engine: str, setting: str) -> tuple[Error, ...]:
        """All records of an engine at a setting."""
        return tuple(r for key, cell in self.cells.items() if key[:2] == (engine, setting) for r in cell.records)

    def runs(self, engine: str, setting: str) -> list[RunRecord]:
        """All runs of an engine at a setting."""
        return [run for run in self.results.runs if (run.engine, run.setting) == (engine, setting)]

    def cell(self, engine: str, setting: str, family_name: str) -> EngineRecords:
        """The records of an engine at a setting in a family of quantities; empty without any."""
        return self.cells.get((engine, setting, family_name), EngineRecords(()))

    def row(self, engine: str, setting: str) -> list[EngineRecords]:
        """The judged families of an engine at a setting."""
        cells = (self.cell(engine, setting, name) for name in self.families)
        return [cell for cell in cells if cell.judged]

    def most_accurate(self, setting: str, family_name: str) -> str:
        """The engine with the least maximum error in a family, of those that failed in none of it.

        Empty if there is only one engine, or none passed.
        """
        cells = {
            engine: self.cell(engine, setting, family_name) for engine in self.engines if engine not in self.controls
        }
        errors = {engine: cell.error for engine, cell in cells.items() if cell.error is not None and not cell.failed}
        return min(errors, key=lambda engine: errors[engine] or 0.0, default="") if len(cells) > 1 else ""

    def seconds(self, engine: str, setting: str) -> float | None:
        """Set-up and stepping of a run, s, as the shifted geometric mean of all runs; None without runs."""
        runs = [run.setup_seconds + run.seconds for run in self.runs(engine, setting) if run.steps]
        return statistics.geometric_mean(time + SHIFT for time in runs) - SHIFT if runs else None

    def _family_of_record(self, record: Error) -> str:
        if record.quantity in self.checks:
            return CHECKS
        if (record.mechanism, record.variant, record.regime) in self._released_regimes:
            return RELEASED
        return next((name for name, members in FAMILIES.items() if family(record.quantity) in members), OTHER)

    @cached_property
    def checks(self) -> frozenset[str]:
        """Names of what needs no reference."""
        return frozenset(record.quantity for record in self.results.invariants)

    @cached_property
    def _released_regimes(self) -> frozenset[tuple[str, str, str]]:
        return frozenset(
            (linkage.name, linkage.variant, regime.name)
            for linkage in self.results.linkages
            for regime in linkage.regimes
            if isinstance(regime, ReleasedRegime)
        )


def ratio(record: Error) -> str:
    """An error over its limit for a reader."""
    value = share(record)
    return "< 0.001" if value < 1e-3 else figure(value, 2)


def verdict(trust: EngineRanking) -> tuple[str, ...]:
    """Changes, the engines to trust, and the naive settings.

    Nobody is to be trusted where the campaign has not passed. The quickest is not named: a campaign times each run
    once, which cannot tell times from noise; a benchmark can.
    """
    setting, results = trust.settings[0], trust.results
    engines = [name for name in trust.engines if name not in trust.controls] or list(trust.engines)
    count = sum(entry.fails for entry in results.changes)
    lines = (
        sentence("verdict_changes", count=count) if count else "",
        _trust_sentence(trust, engines, setting),
        _naive_sentence(trust, engines) if trust.is_idle(Setting.NAIVE.value) else "",
    )
    return tuple(line for line in lines if line)


def _trust_sentence(trust: EngineRanking, engines: Sequence[str], setting: str) -> str:
    """The engines that may be trusted for all families, for some, and for none."""
    judged = {name: [f for f in trust.families if trust.cell(name, setting, f).judged] for name in engines}
    wrong = {name: [f for f in judged[name] if trust.cell(name, setting, f).failed] for name in engines}
    right = [name for name in engines if judged[name] and not wrong[name]]
    return sentence(
        "verdict_trust",
        setting=setting,
        whole=Names(name for name in right if len(judged[name]) == len(trust.families)),
        part=_engines_by_families({name: [f for f in trust.families if f not in judged[name]] for name in right}),
        wrong=_engines_by_families(wrong),
        silent=Names(name for name in engines if not judged[name]),
        red=_has_failed(trust.results),
        count=sum(len(cell.judged) for name in right for cell in trust.row(name, setting)),
    )


def _has_failed(results: CampaignResults) -> bool:
    """Whether the campaign has failed, in any engine, or by a change since its results were recorded."""
    decided = deciding((*results.records, *results.invariants))
    failed = any(Verdict(record.outcome).failed or record.outcome == Verdict.SUITE_ERROR for record in decided)
    return failed or any(entry.fails for entry in results.changes)


def _naive_sentence(trust: EngineRanking, engines: Sequence[str]) -> str:
    """A sentence on the engines' naive settings, which decide nothing."""
    ran = {name: trust.row(name, Setting.NAIVE.value) for name in engines}
    over = {name: max(h.error or 0.0 for h in cells) for name, cells in ran.items() if any(h.failed for h in cells)}
    within = Names(name for name, cells in ran.items() if cells and name not in over)
    rows = [(name, _share_of_peak(error)) for name, error in sorted(over.items(), key=lambda item: item[1])]
    return sentence("verdict_untuned", within=within, over=rows)


def _share_of_peak(error: float) -> str:
    """An error over the peak in per cent: 0.2 %, 16 %, 390 %; of one that is many peaks its order."""
    if error < MOST_PERCENT:
        return f"{float(f'{100.0 * error:.2g}'):g} %"
    return f"{numbers.printed(float(f'{error:.2g}'))} peaks"


class Names:
    """Engines as a subject: their ``words``, and whether they are ``many``."""

    def __init__(self, names: Iterable[str]) -> None:
        every = [*names]
        self.words, self.many = listed(every), len(every) > 1


def _engines_by_families(families: Mapping[str, Sequence[str]]) -> list[tuple[Names, str]]:
    """Engines grouped by equal families: their names, and the families in words; engines without any are left out."""
    groups = grouped((tuple(names), name) for name, names in families.items() if names)
    return [(Names(names), listed(texts)) for texts, names in groups.items()]


def listed(words: Iterable[str]) -> str:
    """Words one after the other: "a, b and c"."""
    *first, last = [*words] or [""]
    return f"{', '.join(first)} and {last}" if first else last
