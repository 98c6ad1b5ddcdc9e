"""Faults fitted to what a file shows, and which of them explain it: what an engineer would look at first."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.errors import LinkproofError
from comparisons.filejudge.column_faults import UNIT_RATIOS, Evidence, column_faults, group_faults
from comparisons.filejudge.fault import (
    Correction,
    Fault,
    FaultKind,
    Numbers,
    Simulation,
    holds_acceleration,
    is_angle,
    is_rotary,
)
from comparisons.filejudge.number_faults import misplaced_loads, number_faults, several_numbers
from comparisons.filejudge.setting_faults import CrankColumn, model_settings, motion_settings
from comparisons.trials.judging.quantities import near_jumps

Array = NDArray[np.float64]

TURN: Final = 2.0 * math.pi
ROUNDS: Final = 8  # of Gauss-Newton
MOST_GUESSES: Final = 3  # from which fits are made
HALVINGS: Final = 6
SETTLED: Final = 1e-3  # relative gain below which a fit ends
DIFFERENCE_STEP: Final = 1e-4  # of a number's own size, for its difference quotient
MOST_OPEN: Final = 0.2  # of a signal's samples that a cause may leave open
AS_GOOD: Final = 1.3  # times the rms of the best numbers that usual ones may leave
AS_ROUND: Final = 1.1  # the same, of round ones
DIGITS: Final = (1, 2, 3)  # of round numbers
NOT_ROUND: Final = 4  # digits of a number that is not round
HOPELESS: Final = 0.05  # of the squares: a number that takes less away where it is small explains nothing

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
class Fit:
    """A fault with its numbers, and what it leaves of each signal's difference, relative to the signal's tolerance.

    ``digits`` are those of its number: 0 for a usual one or none, fewer for a round one.
    """

    fault: Fault
    numbers: Array
    rms: Array
    largest: Array
    digits: int = NOT_ROUND

    @property
    def words(self) -> str:
        """The fault in one sentence."""
        return self.fault.words(self.numbers)

    @property
    def change(self) -> float:
        """How far its numbers are from those with which nothing is wrong, over what counts as a change of each."""
        start = np.array(self.fault.start)
        return float(np.linalg.norm((self.numbers - start) / self.fault.sizes)) if len(start) else 0.0

    @property
    def rank(self) -> tuple[int, int]:
        """Small for what an engineer looks at first."""
        kind = self.fault.kind
        if kind is FaultKind.SEVERAL and not self.digits:
            return (FaultKind.SETTING, 0) if len(self.numbers) < 2 else (FaultKind.NUMBER, NOT_ROUND)
        return kind, self.digits


class Fitting:
    """Faults fitted to some columns, of a simulation without them."""

    def __init__(self, simulation: Simulation, evidence: Sequence[Evidence]) -> None:
        self.simulation, self.evidence = simulation, evidence

    def residuals(self, fault: Fault, numbers: Array) -> list[Array] | None:
        """Residuals (n,) of every column with a fault, over its tolerance, nan where undecided; None if impossible."""
        try:
            with np.errstate(all="ignore"):  # two points of a link in one place, a speed beyond all bounds
                other = fault.apply(self.simulation, numbers)
                curves = other.predict(self.evidence)
        except (LinkproofError, ArithmeticError):
            return None
        moved = other.motion.jumps != self.simulation.motion.jumps
        remains = []
        for signal, values in zip(self.evidence, curves, strict=True):
            apart = signal.values - values
            if is_angle(signal.name) and np.any(np.isfinite(apart)):  # known but for whole turns
                apart = apart - TURN * np.round(np.nanmedian(apart) / TURN)
            residuals = np.where(signal.counted, apart / signal.tolerance, np.nan)
            if moved and holds_acceleration(signal.name):
                residuals = np.where(near_jumps(signal.time, other.motion) & ~signal.over, np.nan, residuals)
            residuals = np.where(
                signal.over & np.isnan(residuals), signal.residual, residuals
            )  # left open, it is not explained
            remains.append(residuals)
        return remains

    def evaluate(self, fault: Fault, numbers: Numbers | Array, digits: int = NOT_ROUND) -> Fit | None:
        """What a fault leaves of the columns with exactly these numbers; None where it cannot be simulated.

        ``digits`` goes into the Fit: how round the number is.
        """
        numbers = np.array(numbers, dtype=float)
        residuals = self.residuals(fault, numbers)
        return None if residuals is None else Fit(fault, numbers, *_measures(residuals), digits)

    def best(self, fault: Fault) -> Fit | None:
        """The best fit of a fault, with usual or round numbers where they leave as little; None if it cannot be."""
        if fault.usual and not fault.start:
            return _least_fit(self.evaluate(fault, numbers, 0) for numbers in fault.usual)
        if not fault.start:
            return self.evaluate(fault, (), 0)
        best = _least_fit(self._gauss_newton(fault, np.array(guess)) for guess in self._best_guesses(fault))
        if best is None:
            return None
        usual = _least_fit(self.evaluate(fault, numbers, 0) for numbers in fault.usual)
        if usual and _is_as_good(usual, best, AS_GOOD):
            return usual
        return best

    def rounded(self, fit: Fit) -> Fit:
        """A fit with its number as round as the file allows, in the unit in which it is written; itself if none is."""
        unit = fit.fault.unit
        if not unit or len(fit.numbers) != 1 or not fit.digits:
            return fit
        for digits in DIGITS:
            value = float(f"{fit.numbers[0] / unit:.{digits - 1}e}") * unit
            trial = self.evaluate(fit.fault, (value,), digits)
            if trial and _is_as_good(trial, fit, AS_ROUND):
                return trial
        return fit

    def _best_guesses(self, fault: Fault) -> Sequence[Numbers]:
        """The guesses from which a fit is made: of many those that are nearest to the file as they are."""
        if len(fault.guesses) <= MOST_GUESSES:
            return fault.guesses or (fault.start,)
        fits = {guess: self.evaluate(fault, guess) for guess in fault.guesses}
        costs = {guess: float(np.sum(fit.rms**2)) for guess, fit in fits.items() if fit is not None}
        return sorted(costs, key=lambda guess: costs[guess])[:MOST_GUESSES]

    def _gauss_newton(self, fault: Fault, numbers: Array) -> Fit | None:
        """The fit of a fault's numbers from a guess, by Gauss-Newton with halved steps; None if not simulated."""
        is_start = np.array_equal(numbers, fault.start)
        residuals = [signal.residual for signal in self.evidence] if is_start else self.residuals(fault, numbers)
        if residuals is None:
            return None
        sizes = np.array(fault.sizes)
        for _ in range(ROUNDS):
            vector = _stacked_residuals(residuals)
            cost = float(vector @ vector)
            beside = [self.residuals(fault, numbers + DIFFERENCE_STEP * size) for size in np.diag(sizes)]
            slopes = [_slopes(residuals, groups) for groups in beside if groups is not None]
            if len(slopes) < len(sizes):
                break
            jacobian = np.stack(slopes, axis=1)
            if not np.all(np.isfinite(jacobian)) or not np.any(jacobian):
                break
            step = -np.linalg.lstsq(jacobian, vector, rcond=1e-10)[0]
            gain = cost - float(np.sum((vector + jacobian @ step) ** 2))
            if gain <= (HOPELESS if is_start else SETTLED) * cost:
                break
            step, is_start = step * sizes, False
            for _ in range(HALVINGS):
                trial = self.residuals(fault, numbers + step)
                gain = -1.0 if trial is None else cost - float(np.sum(_stacked_residuals(trial) ** 2))
                if gain > 0.0:
                    break
                step = 0.5 * step
            if trial is None or gain <= 0.0:
                break
            numbers, residuals = numbers + step, trial
            if gain <= SETTLED * cost:
                break
        return Fit(fault, numbers, *_measures(residuals))


def _least_fit(fits: Iterable[Fit | None]) -> Fit | None:
    """The fit that leaves least; None without one."""
    return min((fit for fit in fits if fit), key=lambda fit: float(np.sum(fit.rms**2)), default=None)


def _is_as_good(fit: Fit, best: Fit, times: float) -> bool:
    return bool(np.all(fit.rms <= np.maximum(times * best.rms, 1.0)))


def _measures(residuals: Sequence[Array]) -> tuple[Array, Array]:
    """RMS and largest magnitude of what is left of every signal; infinite where too much of it is open."""
    rms, largest = [], []
    for values in residuals:
        known = values[np.isfinite(values)]
        enough = len(known) and len(known) >= (1.0 - MOST_OPEN) * len(values)
        rms.append(float(np.sqrt(np.mean(known**2))) if enough else np.inf)
        largest.append(float(np.max(np.abs(known))) if enough else np.inf)
    return np.array(rms), np.array(largest)


def _slopes(residuals: Sequence[Array], beside: Sequence[Array]) -> Array:
    """Derivative of the residuals by a small step to those ``beside``; 0 where either is open."""
    return _stacked_residuals(
        [(other - values) / DIFFERENCE_STEP for values, other in zip(residuals, beside, strict=True)]
    )


def _stacked_residuals(residuals: Sequence[Array]) -> Array:
    """The residuals of all signals in one vector, each signal weighted alike however many samples it has; 0 for nan."""
    return np.concatenate([np.nan_to_num(values) / np.sqrt(len(values)) for values in residuals])


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
    most = FaultKind.NUMBER if kind <= FaultKind.SETTING else max(FaultKind.SEVERAL, kind)
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
