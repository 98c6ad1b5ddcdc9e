"""Which faults explain what a file shows: what an engineer would look at first, and all that fit as well."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np

from comparisons.faults.columns import UNIT_RATIOS, Evidence, column_faults, group_faults
from comparisons.faults.fault import Correction, Fault, Kind
from comparisons.faults.fitting import Fit, Fitting
from comparisons.faults.numbers import misplaced_loads, number_faults, several_numbers
from comparisons.faults.settings import CrankColumn, model_settings, motion_settings
from comparisons.faults.simulation import Simulation, is_rotary

SAMPLES: Final = 300  # of a signal to which faults of the model are fitted,
FEWEST: Final = 100  # or fewer of each where they are many
MANY: Final = 4  # signals
MOST_FITTED: Final = 3000  # samples of a column to which its own faults are fitted
NOTICED: Final = 1.5  # of the tolerance: a larger difference wants a cause
EXPLAINED: Final = 0.1  # of a signal's difference may be left by a cause that explains it
WORTH: Final = 0.2  # the same on some samples, so that it is measured on all
HARMED: Final = 1.5  # times as much is left of a signal that a cause makes worse
ALIKE: Final = 1.5  # times the rounding, or the least that any cause leaves: not distinguished
ROUNDED: Final = 0.6  # rms of a rounding over its bound
MOST_ALIKE: Final = 12  # causes of one rank that are not distinguished: so many name none
MOST_OF_ALL: Final = 24  # the same, of any rank: the difference is too small to tell anything
BETTER: Final = 0.3  # of what is left without a correction of sign or unit
SIMILAR: Final = 0.9  # correlation of a signal that is right but for its sign or unit
NEAR_UNIT: Final = 0.35  # natural logarithm within which a factor is taken for a unit's, other faults besides


@dataclass(frozen=True)
class FaultFinding:
    """Signals that one cause explains, by its names: the likeliest and the ``others`` that fit as well.

    ``left`` is what it leaves of their error, over the peaks that they have with it; ``fully`` whether that is within
    the rounding. ``aligned`` are corrections of sign and unit without which it does not fit.
    """

    signals: tuple[str, ...]
    likeliest: Fit
    others: tuple[Fit, ...]
    left: float
    fully: bool
    aligned: Mapping[str, Correction] = field(default_factory=dict)

    @property
    def corrections(self) -> dict[str, Correction]:
        """Corrections for the mapping by the names of signals: those of the likeliest cause, and those it presumes."""
        return {**self.aligned, **self.likeliest.fault.cure(self.likeliest.numbers)}

    @property
    def every(self) -> tuple[Fit, ...]:
        """All causes that fit, the likeliest first."""
        return (self.likeliest, *self.others)


@dataclass(frozen=True)
class Explanation:
    """The causes of differences, and the signals that differ without one."""

    findings: tuple[FaultFinding, ...]
    unexplained: tuple[str, ...]


def explain(
    simulation: Simulation, evidence: Sequence[Evidence], names: Sequence[str], column: CrankColumn | None = None
) -> Explanation:
    """The causes of all differences beyond the rounding; ``names`` are the signals that a column may be taken for."""
    raw = _explain_as_read(simulation, evidence, names, column)
    partly = {name for finding in raw.findings if not finding.fully for name in finding.signals}
    open_names = {*raw.unexplained, *partly}
    estimates = {v.name: c for v in evidence if v.name in open_names and (c := estimate_correction(v)) is not None}
    if estimates:
        aligned = [_apply_correction(v, estimates.get(v.name)) for v in evidence]
        raw = _merge_findings(raw, _explain_as_read(simulation, aligned, names, column), estimates)
    return raw


def _merge_findings(raw: Explanation, again: Explanation, estimates: Mapping[str, Correction]) -> Explanation:
    """The ``raw`` findings, replaced where a finding ``again``, on corrected signs and units, leaves much less."""
    better = []
    for finding in again.findings:
        before = [other.left for other in raw.findings if set(other.signals) & set(finding.signals)]
        if finding.left < BETTER * min(before, default=math.inf):
            aligned = {name: c for name, c in estimates.items() if name in finding.signals}
            better.append(replace(finding, aligned=aligned))
    covered = {name for finding in better for name in finding.signals}
    findings = (finding for finding in raw.findings if not covered & set(finding.signals))
    return Explanation((*findings, *better), tuple(name for name in raw.unexplained if name not in covered))


def estimate_correction(evidence: Evidence) -> Correction | None:
    """The correction of a signal's sign and unit, its other faults aside; None where both are right or unclear."""
    values, truth = evidence.values[evidence.counted], evidence.truth[evidence.counted]
    size = float(np.sqrt(np.sum(values**2) * np.sum(truth**2)))
    product = float(values @ truth)
    if not size or abs(product) < SIMILAR * size:
        return None
    ratio = abs(product) / float(truth @ truth)
    factors = [1.0, *(k for ratio in UNIT_RATIOS.values() if ratio > 2.0 for k in (ratio, 1.0 / ratio))]
    factor = min(factors, key=lambda k: abs(np.log(ratio / k)))
    if abs(np.log(ratio / factor)) > NEAR_UNIT or (factor == 1.0 and product > 0.0):
        return None
    return Correction(sign=1 if product > 0.0 else -1, factor=1.0 / factor)


def _apply_correction(evidence: Evidence, correction: Correction | None) -> Evidence:
    """A signal with its sign and factor corrected; itself without a correction."""
    if correction is None:
        return evidence
    factor = correction.sign * correction.factor
    return replace(evidence, values=factor * evidence.values, rounding=max(abs(factor), 1.0) * evidence.rounding)


def differs(evidence: Evidence) -> bool:
    """Whether a signal's difference is beyond its rounding and what is negligible."""
    return bool(np.any(np.abs(evidence.residual) > NOTICED))


def _explain_as_read(
    simulation: Simulation, evidence: Sequence[Evidence], names: Sequence[str], column: CrankColumn | None = None
) -> Explanation:
    """The causes of the differences of columns as they are: first the cause that explains most signals."""
    open_names = [signal.name for signal in evidence if differs(signal)]
    if not open_names:
        return Explanation((), ())
    search = _Search(simulation, evidence)
    fits = search.fits(names, open_names, column)
    findings: list[FaultFinding] = []
    unnamed: list[str] = []
    while open_names:
        covering = [(search.explained_signals(fit, open_names), fit) for fit in fits]
        most = max((len(covered) for covered, _ in covering), default=0)
        if not most:
            break
        rivals = [(covered, fit) for covered, fit in covering if len(covered) == most]
        covered = min(rivals, key=lambda pair: search.log_remainder(pair[1], pair[0]))[0]
        finding = search.make_finding([fit for names, fit in rivals if names == covered], covered)
        equal = sum(fit.rank == finding.likeliest.rank for fit in finding.others)
        if equal < MOST_ALIKE and len(finding.others) < MOST_OF_ALL:
            findings.append(finding)
        else:
            unnamed += covered
        open_names = [name for name in open_names if name not in covered]
    return Explanation(tuple(findings), (*unnamed, *open_names))


class _Search:
    """Faults fitted to some columns, and how they compare with the residuals before any fault is applied."""

    def __init__(self, simulation: Simulation, evidence: Sequence[Evidence]) -> None:
        self.simulation, self.evidence = simulation, evidence
        self.places = {signal.name: n for n, signal in enumerate(evidence)}
        self.whole = Fitting(simulation, evidence)
        few = max(FEWEST, min(SAMPLES, SAMPLES * MANY // len(evidence)))
        self.thin = Fitting(simulation, [signal.thinned(few) for signal in evidence])
        self.differ = np.array([differs(signal) for signal in evidence])
        rest = [signal.residual[signal.counted] for signal in evidence]
        self.rms = np.array([float(np.sqrt(np.mean(r**2))) if len(r) else 0.0 for r in rest])
        shares = [(signal.rounding / signal.tolerance)[signal.counted] for signal in evidence]
        self.floor = np.array([ROUNDED * float(np.sqrt(np.mean(s**2))) if len(s) else 0.0 for s in shares]) + 1e-4

    def fits(self, names: Sequence[str], open_names: Sequence[str], column: CrankColumn | None) -> list[Fit]:
        """Every fault fitted that does no harm: those of the model to some samples, then those of columns.

        Where one of the model explains all columns at once, nothing is sought in the shape of a linkage whose positions
        are computed by iteration.
        """
        model = [*motion_settings(self.simulation.motion, column), *model_faults(self.simulation)]
        slow = [fault for fault in model if fault.reshapes and self.simulation.mechanism.is_numerical]
        result = [fit for fault in model if fault not in slow and (fit := self._fit_model_fault(fault))]
        if not any(
            self.is_harmless(fit) and len(self.explained_signals(fit, open_names)) == len(open_names) for fit in result
        ):
            result += [fit for fault in slow if (fit := self._fit_model_fault(fault))]
        result += [fit for fault in group_faults(self.evidence) if (fit := self.whole.best(fault))]
        result = [fit for fit in result if self.is_harmless(fit)]
        for signal in self.evidence:
            if signal.name in open_names:
                fitting = Fitting(self.simulation, [signal.thinned(MOST_FITTED)])
                of_column = column_faults(fitting.evidence[0], self.simulation, names)
                result += [
                    self._beside_other_columns(fit, signal.name) for fault in of_column if (fit := fitting.best(fault))
                ]
        return result

    def _fit_model_fault(self, fault: Fault) -> Fit | None:
        """A fault of the model fitted to some samples and measured on all; None if it explains nothing on those."""
        fit = self.thin.best(fault)
        if fit is None or not np.any(self.differ & (fit.rms <= np.maximum(1.0, WORTH * self.rms))):
            return None
        return self.whole.evaluate(fault, fit.numbers, fit.digits)

    def _beside_other_columns(self, fit: Fit, name: str) -> Fit:
        """A fit of the column ``name`` as a fit of all columns, of which it leaves the others as they are."""
        here = np.arange(len(self.rms)) == self.places[name]
        largest = np.array([float(np.nanmax(np.abs(signal.residual), initial=0.0)) for signal in self.evidence])
        return replace(fit, rms=np.where(here, fit.rms, self.rms), largest=np.where(here, fit.largest, largest))

    def is_harmless(self, fit: Fit) -> bool:
        """Whether a fit makes no signal worse beyond its rounding."""
        return bool(np.all(fit.rms <= np.maximum(1.0, HARMED * self.rms)))

    def explained_signals(self, fit: Fit, names: Sequence[str]) -> tuple[str, ...]:
        """The signals among ``names`` that a fit explains."""
        return tuple(n for n in names if fit.rms[(p := self.places[n])] <= max(ROUNDED, EXPLAINED * self.rms[p]))

    def log_remainder(self, fit: Fit, names: Sequence[str]) -> float:
        """Mean logarithm of what a fit leaves of some signals, over what their rounding leaves."""
        places = [self.places[name] for name in names]
        return float(np.mean(np.log(np.maximum(fit.rms[places] / self.floor[places], ALIKE))))

    def make_finding(self, rivals: Sequence[Fit], names: tuple[str, ...]) -> FaultFinding:
        """The likeliest of several fits that explain the same signals, and those that fit as well."""
        places = [self.places[name] for name in names]
        least = min(rivals, key=lambda fit: self.log_remainder(fit, names))
        bound = ALIKE * np.maximum(least.rms[places], self.floor[places])
        alike = [self.whole.rounded(fit) for fit in rivals if np.all(fit.rms[places] <= bound)]
        best, *others = sorted(alike, key=lambda fit: (fit.rank, round(self.log_remainder(fit, names), 1), fit.change))
        left = max(
            share * largest for share, largest in zip(self._tolerances(best, places), best.largest[places], strict=True)
        )
        fully = bool(np.all(best.largest[places] <= NOTICED))
        return FaultFinding(names, best, tuple(_rivals_to_report(best, others)), left, fully)

    def _tolerances(self, fit: Fit, places: Sequence[int]) -> Iterator[float]:
        """The tolerances of some signals, over the peaks that they have with a fault."""
        evidence = [self.evidence[place] for place in places]
        curves = fit.fault.apply(self.simulation, fit.numbers).predict(evidence)
        for signal, curve in zip(evidence, curves, strict=True):
            peak, right = (float(np.nanmax(np.abs(y), initial=0.0)) for y in (curve, signal.truth))
            yield float(np.max(signal.tolerance)) / (signal.scale * (peak / right if peak and right else 1.0))


def _rivals_to_report(best: Fit, others: Iterable[Fit]) -> Iterator[Fit]:
    """Rivals to name beside the likeliest fit: no freer ones beside a setting or a column."""
    kind, _ = best.rank
    most = Kind.NUMBER if kind <= Kind.SETTING else max(Kind.SEVERAL, kind)
    return (fit for fit in others if fit.rank[0] <= most)


def model_faults(simulation: Simulation) -> Iterator[Fault]:
    """Every fault of a model but those of its motion: settings, then numbers."""
    yield from model_settings(simulation)
    yield from misplaced_loads(simulation.linkage)
    yield from number_faults(simulation.linkage)
    yield from several_numbers(simulation.linkage)


def proposals(
    explanation: Explanation, columns: Iterable[str], agreed: Mapping[str, Correction]
) -> dict[str, Correction]:
    """The corrections among the likeliest causes by the names of ``columns``, those agreed to already included."""
    known, corrections = list(columns), dict[str, Correction]()
    for finding in explanation.findings:
        for name, correction in finding.corrections.items():
            groups = {"*": finding.signals, "rotary": [label for label in known if is_rotary(label)]}
            for key in groups.get(name, (name,)):
                if key in known and key not in corrections:
                    corrections[key] = correction.compose(agreed.get(key, Correction()))
    return corrections
