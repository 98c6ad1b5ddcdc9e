"""Results of a tool that cannot be called, judged: aligned with the crank's motion, compared, their causes named."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.description.linkage import Linkage
from analytic.errors import LinkproofError
from analytic.signals import names, table
from comparisons.faults.fault import Correction
from comparisons.faults.ranking import Explanation, explain, proposals
from comparisons.faults.settings import CrankColumn
from comparisons.faults.simulation import Simulation, is_angle
from comparisons.imported.columns import Column, ImportedResults, ImportedSignal
from comparisons.imported.crank_column import (
    ColumnMotion,
    even_instants,
    motion_of_angles,
    motion_of_speeds,
    unwrap_angles,
)
from comparisons.imported.judgement import DEFAULT_LIMIT, Samples, SignalVerdict, judge_signals, rounding_floors
from comparisons.judging.records import Verdict
from comparisons.reference.motion import Motion

Array = NDArray[np.float64]

FEWEST: Final = 2  # samples of a signal that can be judged
FINE: Final = 2000  # instants by which a curve is looked at between few samples
SPARSE: Final = 1.0  # of the limit: a peak that the file's samples miss by more is reported


@dataclass(frozen=True)
class ImportedJudgement:
    """The result of a judgement; ``motion_source`` names the source of the crank's motion.

    ``missed`` are signals whose peak lies between the file's samples, each with the share of it that is missed.
    """

    model: Simulation
    verdicts: tuple[SignalVerdict, ...]
    explanation: Explanation
    not_judged: tuple[tuple[Column, str], ...]
    imported: ImportedResults
    motion_source: str
    limit: float
    missed: tuple[tuple[str, float], ...] = ()

    @property
    def proposals(self) -> dict[str, Correction]:
        """Corrections by the names of signals that would make them right, to be agreed to in the mapping."""
        known = self.imported
        columns = [signal.name for signal in known.signals] + [signal.axis for signal in known.signals]
        return proposals(self.explanation, dict.fromkeys(columns), known.corrections)

    @property
    def passed(self) -> bool:
        """Whether every signal is within the limit: one that the file leaves open has not passed."""
        return all(verdict.outcome is Verdict.PASSED for verdict in self.verdicts)

    def without_cause(self, verdict: SignalVerdict) -> tuple[str, Array | None]:
        """The likely cause of a signal's difference in words, and the file's values without it, (n,); "" for none.

        They are nan at jumps of the crank's acceleration, where either value is accepted.
        """
        finding = next(
            (fault_finding for fault_finding in self.explanation.findings if verdict.name in fault_finding.signals),
            None,
        )
        if finding is None:
            return "", None
        fault, numbers, correction = finding.likeliest.fault, finding.likeliest.numbers, finding.aligned
        (wrong,) = fault.apply(self.model, numbers).predict([verdict.samples])
        right = correction.get(verdict.name, Correction())
        values = right.sign * right.factor * verdict.samples.values + verdict.truth - wrong
        return finding.likeliest.words, np.where(verdict.counted, values, np.nan)


def judge(
    linkage: Linkage,
    imported: ImportedResults,
    motion: Motion | None = None,
    *,
    limit: float = DEFAULT_LIMIT,
    start_angle: float = 0.0,
    gives_speed: bool = True,
) -> ImportedJudgement:
    """Compare every imported signal with the closed form at the file's own instants.

    Without a ``motion`` the crank follows the file's column of its angle, or of its speed from ``start_angle``, rad.
    ``gives_speed`` is False where the user states no speed, which moving signals over the crank angle need.
    """
    moved, source, crank = _crank_motion(imported, motion, start_angle)
    model = Simulation(linkage, moved)
    every = [_samples_of(signal, moved) for signal in imported.signals if signal is not crank]
    _check_speed(model, every, gives_speed=gives_speed)
    signals = [signal for signal in every if len(signal.time) >= FEWEST]
    if not signals:
        reasons = "".join(f"; '{column.header}' is not judged: {why}" for column, why in imported.not_judged)
        raise LinkproofError(
            f"expected a signal to judge, got none besides the crank's motion ({source}){reasons}; name columns in a "
            "mapping, or export more of them"
        )
    truth = model.predict(signals)
    signals = [_without_turns(signal, values) for signal, values in zip(signals, truth, strict=True)]
    judged = judge_signals(model, signals, truth, rounding_floors(model, signals, truth), limit)
    column = None
    if crank is not None:
        name = "" if linkage.is_linear else crank.name
        column = CrankColumn(name, crank.column.header, crank.column.unit, imported.units.get(crank.name, 1.0))
    return ImportedJudgement(
        model,
        tuple(judged),
        explain(model, [verdict.evidence for verdict in judged], names(model.mechanism), column),
        (
            *imported.not_judged,
            *((signal.imported.column, "a single sample") for signal in every if len(signal.time) < FEWEST),
        ),
        imported,
        source,
        limit,
        tuple(_missed_peaks(model, judged)),
    )


def _crank_motion(
    imported: ImportedResults, motion: Motion | None, start_angle: float
) -> tuple[Motion, str, ImportedSignal | None]:
    """The crank's motion, its source in words, and the column that gives it; None where the motion is stated."""
    signals = imported.signals
    if motion is not None:
        return motion, f"regime {motion.regime}", None
    over_time = {signal.name: signal for signal in signals if signal.axis == "time"}
    angle, speed = over_time.get("phi"), over_time.get("omega")
    made = [(motion_of_angles(*_motion_samples(angle)), angle)] if angle else []
    if speed and not (made and made[0][0].is_known):
        made += [(motion_of_speeds(*_motion_samples(speed), float(angle.values[0]) if angle else start_angle), speed)]
    if made:
        best, column = min(made, key=lambda pair: pair[0].doubt)
        return best, f"column '{column.column.header}'", column
    kind = "over the crank angle" if signals and all(signal.axis == "phi" for signal in signals) else "over time"
    cure = "--speed" if kind.endswith("angle") else "--regime"
    raise LinkproofError(
        f"crank's motion: expected a column of the crank's angle or speed, got signals {kind} without one; say how the "
        f"crank moves with {cure}, or name the column in a mapping"
    )


def _motion_samples(signal: ImportedSignal) -> tuple[Array, Array, Array]:
    """Times, values and roundings of a column of the crank's motion, whose times are rounded too."""
    time, open_ = even_instants(signal.at, signal.at_resolution)
    values = unwrap_angles(signal.values) if signal.name == "phi" else signal.values
    return time, values, signal.resolution + open_ * np.abs(np.gradient(values, time))


def _samples_of(signal: ImportedSignal, motion: Motion) -> Samples:
    """A signal at its times; over the crank angle those of a constant speed."""
    at, rounding = even_instants(signal.at, signal.at_resolution)
    if signal.axis == "phi":
        speed = float(motion.speed(0.0))
        at, rounding = (at - float(motion.angle(0.0))) / speed, rounding / abs(speed)
        order = np.argsort(at, kind="stable")
        return Samples(signal.name, at[order], signal.values[order], signal.resolution[order], rounding[order], signal)
    return Samples(signal.name, at, signal.values, signal.resolution, rounding, signal)


def _check_speed(model: Simulation, signals: Sequence[Samples], *, gives_speed: bool) -> None:
    """Raise LinkproofError for moving signals over the crank angle where the user states no speed."""
    known = table(model.mechanism)
    over_angle = [signal.name for signal in signals if signal.imported.axis == "phi"]
    moving = [name for name in over_angle if name not in known or not known[name].is_still]
    if moving and not gives_speed:
        raise LinkproofError(
            f"{moving[0]} over the crank angle: expected the crank's speed, got none; say it with --speed, in rpm"
        )


def _without_turns(signal: Samples, truth: Array) -> Samples:
    """An angle without the whole turns that a tool adds or takes away; a transmission angle as the acute one."""
    if not is_angle(signal.name):
        return signal
    if signal.name.startswith("transmission_angle"):
        return replace(signal, values=np.abs(signal.values - np.pi * np.round(signal.values / np.pi)))
    values = unwrap_angles(signal.values)
    turns = np.round(np.median(truth - values) / (2.0 * np.pi))
    return replace(signal, values=values + 2.0 * np.pi * turns)


def _missed_peaks(model: Simulation, judged: Sequence[SignalVerdict]) -> Iterator[tuple[str, float]]:
    """Signals whose closed form peaks between the samples by more than the limit, each with the share missed."""
    for verdict in judged:
        time = verdict.samples.time
        if len(time) > FINE or (isinstance(model.motion, ColumnMotion) and len(time) < 4):
            continue
        between = np.linspace(0.0, 1.0, max(9, FINE // len(time)))[:-1]
        fine = (time[:-1, None] + np.diff(time)[:, None] * between).ravel()
        whole = model.predict([replace(verdict.samples, time=fine)])[0]
        peak = float(np.max(np.abs(whole)))
        share = 1.0 - float(np.max(np.abs(verdict.truth))) / peak if peak else 0.0
        if share > SPARSE * verdict.limit and not verdict.near_zero:
            yield verdict.name, share
