"""How far engines may be trusted over a space of designs, and where they give way: judged runs of a sample of it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from comparisons.designs.trust.sample import DesignSample
from comparisons.judging.records import Record, Verdict

Array = NDArray[np.float64]

TRANSMISSION: Final = "least transmission angle"
SHUFFLES: Final = 999
SAME: Final = 1e-12  # of shares
BY_CHANCE: Final = 0.05  # a rule that as many shuffles match tells nothing


class DesignStanding(StrEnum):
    """What came of a design in an engine; what is ``not judged`` has not passed."""

    WITHIN = "within limits"
    OVER = "over a limit"
    NO_RESULT = "no result"  # the engine diverged, crashed or took too long
    NOT_JUDGED = "not judged"


@dataclass(frozen=True)
class DesignRun:
    """A design in an engine. ``share`` is its largest error over that error's limit, of ``quantity``.

    ``reason`` says why it is not within its limits.
    """

    design: int
    standing: DesignStanding
    share: float = math.nan
    quantity: str = ""
    reason: str = ""

    @property
    def gives_way(self) -> bool:
        """Whether the engine failed here."""
        return self.standing in (DesignStanding.OVER, DesignStanding.NO_RESULT)


@dataclass(frozen=True)
class Side:
    """The designs on one side of a value: ``feature``, in ``unit``, ``below`` it or above it."""

    feature: str
    unit: str
    below: bool
    value: float


@dataclass(frozen=True)
class Rule:
    """The side that tells failing designs from the others best: how many of each lie there.

    ``chance`` is the share of random exchanges of failing and other designs in which some rule tells as well.
    """

    side: Side
    failing: tuple[int, int]
    others: tuple[int, int]
    chance: float

    @property
    def tells(self) -> bool:
        """Whether it is more than chance finds in a sample of this size."""
        return self.chance < BY_CHANCE


@dataclass(frozen=True)
class EngineTrust:
    """An engine over the sample: a run per design, and the ``rule`` of where it gives way.

    ``safe`` is the side with the most designs, and how many, that has none but those within limits. Both are None
    where there is nothing to tell apart.
    """

    engine: str
    setting: str
    runs: tuple[DesignRun, ...]
    rule: Rule | None
    safe: tuple[Side, int] | None

    def count(self, standing: DesignStanding) -> int:
        """Designs of this standing."""
        return sum(run.standing is standing for run in self.runs)

    @property
    def worst(self) -> DesignRun:
        """The run with the largest share of a limit, of those that were held against one."""
        return max(self.runs, key=lambda run: -1.0 if math.isnan(run.share) else run.share)

    @property
    def bound(self) -> float | None:
        """Of an engine that failed in none of n drawn designs 3/n: its share of failures is less, with 95 % certainty.

        None where it failed, or where n is no more than three. The file's own design was not drawn.
        """
        drawn = sum(run.standing is DesignStanding.WITHIN for run in self.runs if run.design)
        return 3.0 / drawn if drawn > 3 and not any(run.gives_way for run in self.runs) else None


@dataclass(frozen=True)
class SpaceTrust:
    """Engines over a sample of a space of designs."""

    sample: DesignSample
    engines: tuple[EngineTrust, ...]

    @property
    def told(self) -> dict[str, Any]:
        """The same, JSON-ready: a row per design, a row per engine and design."""
        names = [one.name for one in self.sample.parameters]
        return {
            "drawn_again": self.sample.in_vain,
            "units": {one.name: one.unit.name for one in self.sample.parameters} | {TRANSMISSION: "deg"},
            "designs": [
                {"design": one.number, "mechanism": one.linkage.name, "variant": one.linkage.variant}
                | dict(zip(names, one.values, strict=True))
                | {TRANSMISSION: _plain(one.transmission)}
                for one in self.sample.designs
            ],
            "runs": [
                {"engine": one.engine, "setting": one.setting, "design": run.design, "standing": run.standing.value}
                | {"share_of_limit": _plain(run.share), "quantity": run.quantity, "reason": run.reason}
                for one in self.engines
                for run in one.runs
            ],
        }


def _plain(value: float) -> float | None:
    return None if math.isnan(value) else value


def trust(sample: DesignSample, records: Iterable[Record], seed: int = 0) -> SpaceTrust:
    """What the judged records of a sample, invariants among them, say of every engine and setting."""
    numbers = {(one.linkage.name, one.linkage.variant): one.number for one in sample.designs}
    runs: dict[tuple[str, str], dict[int, list[Record]]] = {}
    for record in records:
        places = runs.setdefault((record.engine, record.setting), {})
        places.setdefault(numbers[record.mechanism, record.variant], []).append(record)
    found, told = [], features(sample)
    for (engine, setting), by_design in runs.items():
        judged = tuple(_run(one.number, by_design.get(one.number, [])) for one in sample.designs)
        found.append(EngineTrust(engine, setting, judged, _rule(told, judged, seed), _safe(told, judged)))
    return SpaceTrust(sample, tuple(found))


def _run(design: int, records: Sequence[Record]) -> DesignRun:
    """What all records of a design in an engine come to: it stands as its worst one does."""
    judged = [record for record in records if Verdict(record.outcome).judged]
    held = [record for record in judged if record.error_max is not None and record.limit]
    worst = max(held, key=_share, default=None)
    share, quantity = (math.nan, "") if worst is None else (_share(worst), worst.quantity)
    failed = [record for record in judged if Verdict(record.outcome).failed]
    if not judged:
        reason = next((record.detail for record in records), "")
        return DesignRun(design, DesignStanding.NOT_JUDGED, reason=reason)
    if not failed:
        return DesignRun(design, DesignStanding.WITHIN, share, quantity)
    lost = [record for record in failed if record.outcome != Verdict.OVER_LIMIT]
    reason = (lost or sorted(failed, key=_share))[-1].detail
    return DesignRun(design, DesignStanding.NO_RESULT if lost else DesignStanding.OVER, share, quantity, reason)


def _share(record: Record) -> float:
    return record.error_max / record.limit if record.error_max is not None and record.limit else 0.0


def features(sample: DesignSample) -> dict[tuple[str, str], Array]:
    """What designs may be told apart by, name and unit, with its values (designs,)."""
    values = np.array([one.values for one in sample.designs])
    found = {(one.name, one.unit.name): values[:, place] for place, one in enumerate(sample.parameters)}
    angles = np.array([one.transmission for one in sample.designs])
    return found if np.any(np.isnan(angles)) else found | {(TRANSMISSION, "deg"): angles}


def telling(values: Array, fails: NDArray[np.bool_]) -> float:
    """How well values (designs,) tell which designs fail, 0 to 1: the statistic of Kolmogorov and Smirnov."""
    return float(np.max(np.abs(_gaps(values, fails[None])[1]), initial=0.0))


def _rule(told: Mapping[tuple[str, str], Array], runs: Sequence[DesignRun], seed: int) -> Rule | None:
    """The side with the largest share of failing designs over that of the others; None where all or none fail.

    Values of a feature are cut halfway between neighbours. The statistic is that of Kolmogorov and Smirnov, and its
    chance is that of a permutation test over all features.
    """
    judged = np.array([run.standing is not DesignStanding.NOT_JUDGED for run in runs])
    fails = np.array([run.gives_way for run in runs])[judged]
    if not np.any(fails) or np.all(fails):
        return None
    shuffled = np.random.default_rng(seed).permuted(np.tile(fails, (SHUFFLES, 1)), axis=1)
    widest, found, side, there = np.zeros(SHUFFLES), 0.0, None, fails
    for (name, unit), values in told.items():
        cuts, gaps = _gaps(values[judged], np.vstack([fails, shuffled]))
        if not len(cuts):
            continue
        widest = np.maximum(widest, np.max(np.abs(gaps[1:]), axis=1))
        at = int(np.argmax(np.abs(gaps[0])))
        if abs(gaps[0, at]) > found:
            found, below = abs(float(gaps[0, at])), bool(gaps[0, at] > 0.0)
            side, there = Side(name, unit, below, float(cuts[at])), (values[judged] < cuts[at]) == below
    if side is None:
        return None
    failing = int(np.sum(fails & there)), int(np.sum(fails))
    others = int(np.sum(~fails & there)), int(np.sum(~fails))
    return Rule(side, failing, others, (1 + int(np.sum(widest >= found - SAME))) / (1 + SHUFFLES))


def _gaps(values: Array, fails: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Where designs are cut in two by their values, (cuts,), and what that tells of every row of ``fails``.

    That is the share of the failing designs below the cut less that of the others, (rows, cuts).
    """
    order = np.argsort(values, kind="stable")
    steps = np.flatnonzero(np.diff(values[order]) > 0.0)
    below = np.cumsum(fails[:, order], axis=1)
    failing = np.sum(fails, axis=1, keepdims=True)
    others = np.maximum(len(values) - failing, 1)
    gaps = below / np.maximum(failing, 1) - (np.arange(1, len(values) + 1) - below) / others
    ends = values[order]
    return 0.5 * (ends[steps] + ends[steps + 1]), np.asarray(gaps[:, steps])


def _safe(told: Mapping[tuple[str, str], Array], runs: Sequence[DesignRun]) -> tuple[Side, int] | None:
    """The side with the most designs that are all within their limits, up to the outermost of them."""
    within = np.array([run.standing is DesignStanding.WITHIN for run in runs])
    if np.all(within):
        return None
    best: tuple[Side, int] | None = None
    for (name, unit), values in told.items():
        for below, clear in ((True, values < np.min(values[~within])), (False, values > np.max(values[~within]))):
            count = int(np.sum(clear))
            if count > (best[1] if best else 0):
                edge = np.max(values[clear]) if below else np.min(values[clear])
                best = Side(name, unit, below, float(edge)), count
    return best
