"""Hypotheses fitted to what a file shows, and which of them explain it: what an engineer would look at first."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Final

import numpy as np
import scipy  # whose parts are loaded where they are used

from analytic.description.law import FULL_TURN
from analytic.errors import LinkproofError
from analytic.numerics.arrays import Array
from analytic.signals import MAGNITUDE
from comparisons.filejudge.columns import Correction, Evidence, ImportedSignal
from comparisons.filejudge.hypotheses import (
    ZERO_ANGLE,
    FaultKind,
    Hypothesis,
    Numbers,
    of_column,
    of_columns,
    of_model,
    of_motion,
    unit_slips,
    wrap_angle,
)
from comparisons.filejudge.simulation import CRANK, JUMPING, LINKAGE, OF_MOTION, Simulation
from comparisons.motion.case import DriverMotion
from comparisons.trials.judging.quantities import near_jumps

EVALUATIONS: Final = 16  # of a fit
IMPOSSIBLE: Final = 1e9  # tolerances that are left where a linkage cannot be so
MOST_GUESSES: Final = 3  # from which fits are made
SETTLED: Final = 1e-2  # relative gain below which a fit ends
DIFFERENCE_STEP: Final = 1e-4  # of a number's own size, for its difference quotient
MOST_OPEN: Final = 0.2  # of a signal's samples that a cause may leave open
AS_GOOD: Final = 1.3  # times the rms of the best numbers that usual ones may leave
AS_ROUND: Final = 1.1  # the same, of round ones
DIGITS: Final = (1, 2, 3)  # of round numbers
NOT_ROUND: Final = 4  # digits of a number that is not round
FIRST_LOOK: Final = 4  # evaluations after which a fit goes on if it leaves
PROMISING: Final = 0.5  # of the difference of a column, or less
HOPELESS: Final = 0.05  # of the squares: a number that takes less away where it is small explains nothing

MOST_SAMPLES: Final = 5000  # of a signal with which faults are compared,
WORST: Final = 100  # and so many of the worst
SAMPLES: Final = 300  # of a signal to which faults are fitted,
FEWEST: Final = 100  # or fewer of each where they are many
MANY: Final = 4  # signals
NOTICED: Final = 1.5  # of the tolerance: a larger difference wants a cause
EXPLAINED: Final = 0.1  # of a signal's difference may be left by a cause that explains it
WORTH: Final = 0.2  # the same on some samples, so that it is measured on all
HARMED: Final = 1.5  # times as much is left of a signal that a cause makes worse
ALIKE: Final = 1.5  # times the rounding, or the least that any cause leaves: not distinguished
ROUNDED: Final = 0.6  # rms of a rounding over its bound
MOST_ALIKE: Final = 12  # causes of one rank that are not distinguished: so many name none
MOST_OF_ALL: Final = 24  # the same, of any rank: the difference is too small to tell anything
PARTLY: Final = 1e-3  # of a peak: a cause that leaves more may be beside a wrong sign or unit
BETTER: Final = 0.3  # of what is left without a correction of sign or unit
SIMILAR: Final = 0.9  # correlation of a signal that is right but for its sign or unit
NEAR_UNIT: Final = 0.35  # natural logarithm within which a factor is taken for a unit's, other faults besides


@dataclass(frozen=True)
class Fit:
    """A fault with its numbers (k,), and what it leaves of each signal's difference, over the signal's tolerance.

    ``rms`` and ``largest`` are (columns,), infinite where too much is open. ``digits`` are those of its number: 0 for a
    usual one or none, fewer for a round one.
    """

    fault: Hypothesis
    numbers: Array
    rms: Array
    largest: Array
    digits: int = NOT_ROUND

    @property
    def words(self) -> str:
        """The sentence on the fault with its fitted numbers."""
        return self.fault.words(*self.numbers)

    @property
    def change(self) -> float:
        """Distance of the numbers from those of no fault, in noticeable changes of each; 0 without numbers."""
        start = np.array(self.fault.start)
        return float(np.linalg.norm((self.numbers - start) / self.fault.sizes)) if len(start) else 0.0

    @property
    def rank(self) -> tuple[int, int]:
        """Sort key of causes, least for what an engineer looks at first: the ``FaultKind``, then the digits.

        Several numbers at usual values count as one number, a single one as a setting.
        """
        kind = self.fault.kind
        if kind is FaultKind.SEVERAL and not self.digits:
            return (FaultKind.SETTING, 0) if len(self.numbers) < 2 else (FaultKind.NUMBER, NOT_ROUND)
        return kind, self.digits

    def applied(self, simulation: Simulation) -> Simulation:
        """A copy of the simulation with this fault and these numbers; raises LinkproofError where it cannot be so."""
        return simulation.with_values(self.fault.targets(*self.numbers))


class Fitting:
    """Faults fitted to some columns, of a simulation without them."""

    def __init__(self, simulation: Simulation, evidence: Sequence[Evidence]) -> None:
        """Prepare to fit faults in a simulation to the differences of the columns in ``evidence``."""
        self.simulation, self.evidence = simulation, evidence
        self.before = [signal.residual for signal in evidence]
        self.rms = np.array([float(np.sqrt(np.nanmean(r**2))) if np.isfinite(r).any() else 0.0 for r in self.before])

    def residuals(self, fault: Hypothesis, numbers: Iterable[float]) -> list[Array] | None:
        """Residuals (n,) of every column with a fault at these numbers, over its tolerance; None if impossible.

        The numbers are SI or factors, as the hypothesis has them. A residual is nan where a sample is left open.
        """
        remains = list(self.before)
        try:
            with np.errstate(all="ignore"):  # two points of a link in one place, a speed beyond all bounds
                other = self.simulation.with_values(fault.targets(*numbers))
                concerned = [
                    n for n, signal in enumerate(self.evidence) if other.concerns(signal.name, self.simulation)
                ]
                curves = other.predict([self.evidence[n] for n in concerned])
        except (LinkproofError, ArithmeticError):
            return None
        moved = other.motion.jumps != self.simulation.motion.jumps
        for n, curve in zip(concerned, curves, strict=True):
            remains[n] = self._residual(n, curve, other.motion if moved else None)
        return remains

    def _residual(self, number: int, curve: Array, moved: DriverMotion | None) -> Array:
        """The residual (n,) of column ``number`` from ``curve`` (n,), SI, over its tolerance; nan if not counted.

        Of an angle the whole turns nearest to its median difference are taken away. Near jumps of a motion ``moved``,
        if there is one, it is nan, too, but for a sample that is over even so.
        """
        signal = self.evidence[number]
        apart = signal.values - curve
        if signal.si == "rad" and np.any(np.isfinite(apart)):  # known but for whole turns
            apart = apart - FULL_TURN * np.round(np.nanmedian(apart) / FULL_TURN)
        residual = np.where(signal.counted, apart / signal.tolerance, np.nan)
        if moved and signal.si in JUMPING:
            residual = np.where(near_jumps(signal.time, moved) & ~signal.over, np.nan, residual)
        return np.where(signal.over & np.isnan(residual), self.before[number], residual)  # left open, unexplained

    def evaluate(self, fault: Hypothesis, numbers: float | Iterable[float], digits: int = NOT_ROUND) -> Fit | None:
        """The fit of a fault with exactly these numbers, one or (k,); None where it cannot be simulated.

        ``digits`` goes into the Fit: how round the number is.
        """
        exact = np.array(numbers, dtype=float, ndmin=1)
        return _fit_of(fault, exact, self.residuals(fault, exact), digits)

    def best(self, fault: Hypothesis) -> Fit | None:
        """The best fit of a fault, with usual numbers where they leave nearly as little; None if it is impossible."""
        measured = _OnALine(self, fault) if self._is_linear(fault) else self
        usual = (measured.evaluate(fault, numbers, 0) for numbers in fault.usual or ((),) * (not fault.start))
        if not fault.start:
            return _least_fit(usual)
        best = _least_fit(measured._fitted(fault, np.array(guess, ndmin=1)) for guess in measured._best_guesses(fault))
        if best is None or not (fault.guesses or fault.is_slow or best.change):
            return best
        tried = _least_fit(usual)
        return tried if tried and _is_as_good(tried, best, AS_GOOD) else best

    def rounded(self, fit: Fit) -> Fit:
        """A fit with its one number as round as the file allows, in the unit in which it is written.

        Else the fit itself: one of several numbers, of a usual number, or of a number without unit.
        """
        unit = fit.fault.unit
        if not unit or len(fit.numbers) != 1 or not fit.digits:
            return fit
        for digits in DIGITS:
            trial = self.evaluate(fit.fault, float(f"{fit.numbers[0] / unit:.{digits - 1}e}") * unit, digits)
            if trial and _is_as_good(trial, fit, AS_ROUND):
                return trial
        return fit

    def _is_linear(self, fault: Hypothesis) -> bool:
        """Whether every column is a linear function of a fault's numbers.

        Not so with friction in the linkage, or with a column that is the size of a force.
        """
        sizes = any(signal.name.endswith(MAGNITUDE) for signal in self.evidence)
        return fault.is_linear and not sizes and not self.simulation.linkage.friction

    def _best_guesses(self, fault: Hypothesis) -> Sequence[float | Numbers]:
        """The numbers to fit from: the fault's guesses or else its start.

        Of more than MOST_GUESSES those that come nearest to the file.
        """
        if len(fault.guesses) <= MOST_GUESSES:
            return fault.guesses or (fault.start,)
        fits = {guess: self.evaluate(fault, guess) for guess in fault.guesses}
        costs = {guess: float(np.sum(fit.rms**2)) for guess, fit in fits.items() if fit is not None}
        return sorted(costs, key=lambda guess: costs[guess])[:MOST_GUESSES]

    def _fitted(self, fault: Hypothesis, guess: Array) -> Fit | None:
        """The least-squares fit of a fault's numbers from a guess (k,) to the columns it changes; None if impossible.

        It ends early where the first steps explain no column by half.
        """
        sizes, here, axes = np.array(fault.sizes), np.zeros(len(guess)), DIFFERENCE_STEP * np.eye(len(guess))
        is_start = np.array_equal(guess, fault.start)
        seen: dict[bytes, list[Array] | None] = {here.tobytes(): self.before} if is_start else {}

        def remains(step: Array) -> Array | None:
            """The residuals of the columns that change, joined, each weighted alike however many samples it has.

            ``step`` (k,) is the way from the guess, in the fault's sizes. Each is computed once. None if impossible.
            """
            key, numbers = step.tobytes(), guess + sizes * step
            if key not in seen:
                seen[key] = self.residuals(fault, numbers) if np.all(numbers >= fault.least) else None
            parts = seen[key]
            return None if parts is None else np.concatenate([parts[n] / np.sqrt(len(parts[n])) for n in changing])

        def known(step: Array) -> Array:
            """The residuals (n,) at a ``step`` (k,) for the solver: 0 where open, IMPOSSIBLE if the fault cannot be.

            A step is the way from the guess, in the fault's sizes.
            """
            values = remains(step)
            if values is None:
                return np.full(sum(len(self.before[n]) for n in changing), IMPOSSIBLE)
            return np.nan_to_num(values)

        def slopes(step: Array) -> Array:
            """Derivatives of the residuals by the ``step`` (k,), in the fault's sizes: (n, k).

            They are one-sided differences.
            """
            base, beside = remains(step), [remains(step + axis) for axis in axes]
            rises = [0.0 * known(step) if base is None or other is None else other - base for other in beside]
            return np.nan_to_num(np.stack(rises, axis=1) / DIFFERENCE_STEP)

        changing = list(range(len(self.before)))
        if remains(here) is None:
            return None
        slopes(here)
        tried = [parts for parts in seen.values() if parts is not None]
        changing = [n for n in changing if not all(np.array_equal(p[n], tried[0][n], equal_nan=True) for p in tried)]
        found, fit = here, _fit_of(fault, guess, seen[here.tobytes()])
        if not changing:
            return fit
        if is_start:
            rest, jacobian = known(here), slopes(here)
            least = rest - jacobian @ np.linalg.lstsq(jacobian, rest, rcond=1e-10)[0]
            if least @ least >= (1.0 - HOPELESS) * (rest @ rest):
                return fit
        for most in (FIRST_LOOK, EVALUATIONS):
            found = scipy.optimize.least_squares(
                known, found, slopes, method="lm", x_scale=1.0, ftol=SETTLED, max_nfev=most
            ).x
            fit = _fit_of(fault, guess + sizes * found, seen[found.tobytes()])
            if fit is None or not np.any(fit.rms < PROMISING * self.rms):
                break
        return fit


class _OnALine(Fitting):
    """The fitting of a linear fault, whose residuals are known from one change of each of its numbers."""

    def __init__(self, whole: Fitting, fault: Hypothesis) -> None:
        """Simulate a linear ``fault`` once per number, so that its residuals follow without simulation."""
        super().__init__(whole.simulation, whole.evidence)
        self.start, self.sizes = np.array(fault.start), np.array(fault.sizes)
        self.ends = [whole.residuals(fault, self.start + change) for change in np.diag(self.sizes)]

    def residuals(self, fault: Hypothesis, numbers: Iterable[float]) -> list[Array] | None:
        """Residuals (n,) of every column, as a linear function of the fault's numbers; simulated where that failed.

        ``fault`` is the one given at the start. None where they cannot be simulated either.
        """
        remains = list(self.before)
        for end, share in zip(self.ends, (np.asarray(numbers) - self.start) / self.sizes, strict=True):
            if end is None:
                return super().residuals(fault, numbers)
            remains = [
                now + share * (then - before) for now, then, before in zip(remains, end, self.before, strict=True)
            ]
        return remains


def _fit_of(
    fault: Hypothesis, numbers: Iterable[float], residuals: list[Array] | None, digits: int = NOT_ROUND
) -> Fit | None:
    """The fit with these residuals, (n,) of each column; None without residuals.

    It is infinite in a column where more than MOST_OPEN of them are nan. ``digits`` is how round its number is.
    """
    if residuals is None:
        return None
    rms, largest = [], []
    for values in residuals:
        known = values[np.isfinite(values)]
        enough = len(known) and len(known) >= (1.0 - MOST_OPEN) * len(values)
        rms.append(float(np.sqrt(np.mean(known**2))) if enough else np.inf)
        largest.append(float(np.max(np.abs(known))) if enough else np.inf)
    return Fit(fault, np.array(numbers, dtype=float), np.array(rms), np.array(largest), digits)


def _least_fit(fits: Iterable[Fit | None]) -> Fit | None:
    """The fit that leaves the least sum of squares of ``rms``; None where all are None."""
    return min((fit for fit in fits if fit), key=lambda fit: float(np.sum(fit.rms**2)), default=None)


def _is_as_good(fit: Fit, best: Fit, times: float) -> bool:
    """Whether a fit leaves of each column at most ``times`` what the ``best`` one leaves, or at most its tolerance."""
    return bool(np.all(fit.rms <= np.maximum(times * best.rms, 1.0)))


@dataclass(frozen=True)
class FaultFinding:
    """Signals that one cause explains, by its names: the likeliest and the ``others`` that fit as well.

    ``left`` is the largest error that it leaves, as a share of the peaks that the signals have in the file; ``fully``
    whether that is within the rounding. ``aligned`` are corrections of sign and unit, by signal, without which it does
    not fit, ``corrections`` those for the mapping: these, and what undoes the likeliest cause.
    """

    signals: tuple[str, ...]
    likeliest: Fit
    others: tuple[Fit, ...]
    left: float
    fully: bool
    corrections: Mapping[str, Correction]
    aligned: Mapping[str, Correction] = field(default_factory=dict)

    @property
    def every(self) -> tuple[Fit, ...]:
        """All causes that fit, the likeliest first."""
        return (self.likeliest, *self.others)


@dataclass(frozen=True)
class Explanation:
    """The causes of differences, and the names of signals that differ without one."""

    findings: tuple[FaultFinding, ...]
    unexplained: tuple[str, ...]


def explain(
    simulation: Simulation, evidence: Sequence[Evidence], names: Sequence[str], column: ImportedSignal | None = None
) -> Explanation:
    """The Explanation of all differences beyond rounding; ``names`` are signals that a column may be taken for.

    ``column`` is that which gives the crank's motion, None where the motion is stated. Causes that fit only once sign
    or unit are corrected count, too.
    """
    raw = _explain_as_read(simulation, evidence, names, column)
    partly = {name for finding in raw.findings if finding.left > PARTLY for name in finding.signals}
    open_names = {*raw.unexplained, *partly}
    estimates = {v.name: c for v in evidence if v.name in open_names and (c := estimate_correction(v)) is not None}
    if estimates:
        aligned = [_apply_correction(v, estimates.get(v.name)) for v in evidence]
        raw = _merge_findings(raw, _explain_as_read(simulation, aligned, names, column), estimates)
    return raw


def _merge_findings(raw: Explanation, again: Explanation, estimates: Mapping[str, Correction]) -> Explanation:
    """The ``raw`` findings, replaced where a finding ``again``, on corrected signs and units, leaves much less.

    ``estimates`` are these corrections, by signal.
    """
    better = []
    for finding in again.findings:
        before = [other.left for other in raw.findings if set(other.signals) & set(finding.signals)]
        if finding.left < BETTER * min(before, default=math.inf):
            aligned = {name: c for name, c in estimates.items() if name in finding.signals}
            better.append(replace(finding, aligned=aligned, corrections={**aligned, **finding.corrections}))
    covered = {name for finding in better for name in finding.signals}
    findings = (finding for finding in raw.findings if not covered & set(finding.signals))
    return Explanation((*findings, *better), tuple(name for name in raw.unexplained if name not in covered))


def estimate_correction(evidence: Evidence) -> Correction | None:
    """The correction of a signal's sign and unit, its other faults aside.

    None where none is needed, or where signal and closed form are not similar enough to tell.
    """
    values, truth = evidence.values[evidence.counted], evidence.truth[evidence.counted]
    size = float(np.sqrt(np.sum(values**2) * np.sum(truth**2)))
    product = float(values @ truth)
    if not size or abs(product) < SIMILAR * size:
        return None
    ratio = abs(product) / float(truth @ truth)
    factors = [1.0, *(k for k, _ in unit_slips(evidence.si, evidence.header) if max(k, 1.0 / k) > 2.0)]
    factor = min(factors, key=lambda k: abs(np.log(ratio / k)))
    if abs(np.log(ratio / factor)) > NEAR_UNIT or (factor == 1.0 and product > 0.0):
        return None
    return Correction(sign=1 if product > 0.0 else -1, factor=1.0 / factor)


def _apply_correction(evidence: Evidence, correction: Correction | None) -> Evidence:
    """A copy of the evidence, its sign and factor corrected, its rounding never reduced; itself for None."""
    if correction is None:
        return evidence
    factor = correction.sign * correction.factor
    return replace(evidence, values=factor * evidence.values, rounding=max(abs(factor), 1.0) * evidence.rounding)


def differs(evidence: Evidence) -> bool:
    """Whether a signal differs from the closed form by more than rounding and what is negligible.

    That is at some counted sample, by more than NOTICED tolerances.
    """
    return bool(np.any(np.abs(evidence.residual) > NOTICED))


def _explain_as_read(
    simulation: Simulation, evidence: Sequence[Evidence], names: Sequence[str], column: ImportedSignal | None = None
) -> Explanation:
    """The causes of the differences of columns as they are: one by one the cause that explains most signals.

    Where too many causes fit alike none is named, and their signals count as unexplained. ``names`` and ``column`` are
    as for ``explain``.
    """
    open_names = [signal.name for signal in evidence if differs(signal)]
    if not open_names:
        return Explanation((), ())
    search = _Search(simulation, evidence, column)
    fits = search.fits(names, open_names)
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

    def __init__(self, simulation: Simulation, evidence: Sequence[Evidence], column: ImportedSignal | None) -> None:
        """Prepare fits to many samples and to few; ``column`` is the one that gives the crank's motion, if any."""
        self.simulation, self.evidence, self.column = simulation, evidence, column
        self.places = {signal.name: n for n, signal in enumerate(evidence)}
        self.whole = Fitting(simulation, [signal.thinned(MOST_SAMPLES, WORST) for signal in evidence])
        few = max(FEWEST, min(SAMPLES, SAMPLES * MANY // len(evidence)))
        self.thin = Fitting(simulation, [signal.thinned(few) for signal in evidence])
        self.differ = np.array([differs(signal) for signal in evidence])
        self.rms = self.whole.rms
        shares = [(signal.rounding / signal.tolerance)[signal.counted] for signal in evidence]
        self.floor = np.array([ROUNDED * float(np.sqrt(np.mean(s**2))) if len(s) else 0.0 for s in shares]) + 1e-4

    def fits(self, names: Sequence[str], open_names: Sequence[str]) -> list[Fit]:
        """The fits, to all samples, of all hypotheses that do no harm; ``names`` are signals a column may be taken for.

        Slow hypotheses are tried only while no setting explains everything, and numbers only where no column of the
        motion is right; for a linkage computed by iteration, only while nothing explains everything that is among
        ``open_names``.
        """
        rows = [*of_motion(self.simulation, self.column, list(self.places)), *of_model(self.simulation)]
        for signal in self.evidence:
            rows += of_column(signal, self.simulation, names) if signal.name in open_names else ()
        rows += of_columns(self.evidence)
        result = self._harmless(row for row in rows if not row.is_slow)
        if self.simulation.mechanism.is_numerical:
            is_settled = any(len(self.explained_signals(fit, open_names)) == len(open_names) for fit in result)
        else:
            moves = any(signal.si in OF_MOTION and not differs(signal) for signal in self.evidence)
            sure = FaultKind.NUMBER if moves else FaultKind.SETTING
            is_settled = any(fit.rank[0] <= sure and np.all(fit.largest <= NOTICED) for fit in result)
        return result if is_settled else result + self._harmless(row for row in rows if row.is_slow)

    def _harmless(self, rows: Iterable[Hypothesis]) -> list[Fit]:
        """Fits of hypotheses that explain a column and make none worse beyond its rounding, in the order of ``rows``.

        They are first made to a part of the samples, then measured on all.
        """
        made = (fit for row in rows if (fit := self.thin.best(row)))
        helps = (fit for fit in made if np.any(self.differ & (fit.rms <= np.maximum(1.0, WORTH * self.rms))))
        whole = (self.whole.evaluate(fit.fault, fit.numbers, fit.digits) for fit in helps)
        return [fit for fit in whole if fit and np.all(fit.rms <= np.maximum(1.0, HARMED * self.rms))]

    def explained_signals(self, fit: Fit, names: Sequence[str]) -> tuple[str, ...]:
        """The signals among ``names`` that a fit explains: it leaves a small part of their difference, or rounding."""
        return tuple(n for n in names if fit.rms[(p := self.places[n])] <= max(ROUNDED, EXPLAINED * self.rms[p]))

    def log_remainder(self, fit: Fit, names: Sequence[str]) -> float:
        """Mean natural logarithm, over these signals, of the RMS that a fit leaves over that of rounding.

        A ratio below ALIKE counts as ALIKE.
        """
        places = [self.places[name] for name in names]
        return float(np.mean(np.log(np.maximum(fit.rms[places] / self.floor[places], ALIKE))))

    def make_finding(self, rivals: Sequence[Fit], names: tuple[str, ...]) -> FaultFinding:
        """The finding with the likeliest of ``rivals``, fits that explain the signals ``names``, and those as good.

        Numbers are as round as the file allows.
        """
        places = [self.places[name] for name in names]
        least = min(rivals, key=lambda fit: self.log_remainder(fit, names))
        bound = ALIKE * np.maximum(least.rms[places], self.floor[places])
        alike = [self.whole.rounded(fit) for fit in rivals if np.all(fit.rms[places] <= bound)]
        best, *others = sorted(alike, key=lambda fit: (fit.rank, round(self.log_remainder(fit, names), 1), fit.change))
        explained = [self.whole.evidence[place] for place in places]
        shares = [np.max(signal.tolerance) / (np.max(np.abs(signal.values)) or signal.scale) for signal in explained]
        left = float(np.max(shares * best.largest[places]))
        fully = bool(np.all(best.largest[places] <= NOTICED))
        cure = corrections(best, names, self.column)
        return FaultFinding(names, best, tuple(_rivals_to_report(best, others)), left, fully, cure)


def _rivals_to_report(best: Fit, others: Iterable[Fit]) -> Iterator[Fit]:
    """Rivals to name beside the best fit, as an iterator in the order of ``others``.

    Beside a column or setting they are those up to one number, else up to several. Freer ones, such as a factor that no
    unit explains, are left out, unless the best one is as free.
    """
    kind, _ = best.rank
    most = FaultKind.NUMBER if kind <= FaultKind.SETTING else max(FaultKind.SEVERAL, kind)
    return (fit for fit in others if fit.rank[0] <= most)


def corrections(fit: Fit, signals: Iterable[str], column: ImportedSignal | None) -> dict[str, Correction]:
    """The corrections that undo a cause, by the names of the signals whose columns are corrected.

    Those of the crank are of the ``column`` that gives its motion, or of the crank angle as the axis; a shift of all
    clocks is one of every signal in ``signals``, or of "time" without a column. {} for a cause that lies in the model
    or in a stated motion, but for its start and clock, and for a factor that no unit explains.
    """
    knobs: dict[str, dict[str, Any]] = {}
    for target, value in fit.fault.targets(*fit.numbers).items():
        if not isinstance(target, str):
            knobs.setdefault(target[0], {})[target[1]] = value
    crank = knobs.pop(CRANK, {})
    if fit.fault.kind is FaultKind.FREE or LINKAGE in knobs or (crank and not column and not fit.fault.start):
        return {}
    found = {
        name: _undone(own.get("scale", 1.0), -own.get("offset", 0.0) / own.get("scale", 1.0), own.get("shift", 0.0))
        for name, own in knobs.items()
        if own.keys() <= {"scale", "offset", "shift"}
    }
    if "shift" in crank:
        return found | dict.fromkeys(signals if column else ("time",), Correction(time_shift=float(crank["shift"])))
    pace, zero = crank.get("pace", 1.0), wrap_angle(crank.get("offset", 0.0))
    if abs(pace) != 1.0:  # of one column, the other unit
        return found | ({column.name: Correction(factor=abs(pace))} if column else {})
    if pace < 0.0 or zero:
        found["phi"] = Correction(int(pace), offset=0.0 if abs(zero) < ZERO_ANGLE else zero)
    return found | ({"omega": Correction(-1)} if pace < 0.0 else {})


def _undone(scale: float, offset: float, shift: float) -> Correction:
    """The correction that undoes a column's ``scale``; its ``offset``, SI, and ``shift``, s, are those given."""
    return Correction(-1 if scale < 0.0 else 1, 1.0 / abs(scale), float(shift), float(offset))


def proposals(
    explanation: Explanation, columns: Iterable[str], agreed: Mapping[str, Correction]
) -> dict[str, Correction]:
    """The corrections of the likeliest causes by the names of ``columns``, each after the one ``agreed`` to before.

    The two are composed to one. Of two causes for one column the first counts; others than ``columns`` are left out.
    """
    known, found = set(columns), dict[str, Correction]()
    for name, correction in (pair for finding in explanation.findings for pair in finding.corrections.items()):
        if name in known:
            found.setdefault(name, correction.compose(agreed.get(name, Correction())))
    return found
