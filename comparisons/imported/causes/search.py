"""Which causes explain what the file shows: the likeliest, and all that the rounding cannot tell apart from it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Final

import numpy as np
from numpy.typing import NDArray

from comparisons.imported.causes.fitting import FaultModel, Fit, fitted, refitted, tolerance
from comparisons.imported.causes.group_changes import group_changes
from comparisons.imported.causes.length_changes import length_changes
from comparisons.imported.causes.model_changes import model_changes
from comparisons.imported.causes.motion_changes import motion_changes
from comparisons.imported.causes.signal_changes import UNIT_RATIOS, signal_changes
from comparisons.imported.columns import Correction
from comparisons.imported.judging.judgement import SignalVerdict
from comparisons.imported.judging.samples import JudgedModel, depends_on_masses

Array = NDArray[np.float64]

SAMPLES: Final = 300  # of a signal to which causes of the model are fitted,
FEWEST: Final = 100  # or fewer of each where they are many
MANY: Final = 4  # signals
NOTICED: Final = 1.5  # of the tolerance: a larger difference wants a cause
EXPLAINED: Final = 0.1  # of a signal's difference may be left by a cause that explains it
HARMED: Final = 1.5  # times as much is left of a signal that a cause makes worse
ALIKE: Final = 1.5  # times the rounding, or the least that any cause leaves: no telling apart
ROUNDED: Final = 0.6  # rms of a rounding over its bound
BY_SIZE: Final = 0.15  # by which two logarithms differ that one more free number has to earn
MOST_ALIKE: Final = 12  # causes that cannot be told apart: so many name none
BETTER: Final = 0.3  # of what is left without a correction of sign or unit
SIMILAR: Final = 0.9  # correlation of a signal that is right but for its sign or unit
NEAR_UNIT: Final = 0.35  # natural logarithm within which a factor is taken for a unit's, other faults besides


@dataclass(frozen=True)
class FaultFinding:
    """Signals that one cause explains, by its names: the likeliest and the ``others`` that cannot be told apart.

    ``left`` is what it leaves of their error, over the signals' scales; ``fully`` whether that is within the rounding.
    ``aligned`` are corrections of sign and unit that were taken for it to be found.
    """

    signals: tuple[str, ...]
    likeliest: Fit
    others: tuple[Fit, ...]
    left: float
    fully: bool
    aligned: Mapping[str, Correction] = field(default_factory=dict)

    @property
    def corrections(self) -> dict[str, Correction]:
        """What the mapping may agree to, by the names of signals: the likeliest's own, and what was taken before it."""
        cause = self.likeliest.cause
        return {**self.aligned, **(cause.corrections(self.likeliest.numbers) if cause.corrections else {})}

    @property
    def every(self) -> tuple[Fit, ...]:
        """All of them, the likeliest first."""
        return (self.likeliest, *self.others)


@dataclass(frozen=True)
class Explanation:
    """What was found, and the signals that differ without a cause found."""

    findings: tuple[FaultFinding, ...]
    unexplained: tuple[str, ...]


def explain(model: JudgedModel, verdicts: Sequence[SignalVerdict], names: Sequence[str]) -> Explanation:
    """The causes of all differences beyond the rounding; ``names`` are the signals that a column may be taken for."""
    raw = _explain(model, verdicts, names)
    partly = {name for finding in raw.findings if not finding.fully for name in finding.signals}
    open_names = {*raw.unexplained, *partly}
    estimates = {v.name: c for v in verdicts if v.name in open_names and (c := estimated(v)) is not None}
    if not estimates:
        return raw
    again = _explain(model, [corrected(v, estimates.get(v.name)) for v in verdicts], names)
    better = tuple(finding for finding in again.findings if _is_better(finding, raw))
    covered = {name for finding in better for name in finding.signals}
    kept = tuple(finding for finding in raw.findings if not covered & set(finding.signals))
    unexplained = tuple(name for name in raw.unexplained if name not in covered)
    return Explanation((*kept, *(_after(finding, estimates) for finding in better)), unexplained)


def _is_better(finding: FaultFinding, raw: Explanation) -> bool:
    """Whether a finding leaves much less of its signals than those before any correction."""
    before = [other.left for other in raw.findings if set(other.signals) & set(finding.signals)]
    return finding.left < BETTER * min(before, default=math.inf)


def estimated(verdict: SignalVerdict) -> Correction | None:
    """Sign and unit that a signal has but for its other faults; None where it is right or cannot be estimated."""
    values, truth = verdict.samples.values[verdict.kept], verdict.truth[verdict.kept]
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


def _after(finding: FaultFinding, estimates: Mapping[str, Correction]) -> FaultFinding:
    """A finding with the corrections of its own signals that were taken for it."""
    return replace(finding, aligned={name: c for name, c in estimates.items() if name in finding.signals})


def corrected(verdict: SignalVerdict, correction: Correction | None) -> SignalVerdict:
    """A verdict's signal with sign and factor corrected; its errors are not judged anew."""
    if correction is None:
        return verdict
    factor = correction.sign * correction.factor
    samples = replace(
        verdict.samples, values=factor * verdict.samples.values, rounding=abs(factor) * verdict.samples.rounding
    )
    more = (abs(factor) - 1.0) * verdict.samples.rounding
    return replace(verdict, samples=samples, open=np.maximum(verdict.open + more, samples.rounding))


def differs(verdict: SignalVerdict) -> bool:
    """Whether a signal's difference is beyond its rounding and what is negligible."""
    rest = np.abs(verdict.residual / tolerance(verdict))[verdict.kept]
    return bool(np.any(rest > NOTICED))


def _explain(model: JudgedModel, verdicts: Sequence[SignalVerdict], names: Sequence[str]) -> Explanation:
    open_names = [verdict.name for verdict in verdicts if differs(verdict)]
    if not open_names:
        return Explanation((), ())
    before = _Before(verdicts)
    fits = _fits(model, verdicts, names, before)
    findings: list[FaultFinding] = []
    unnamed: list[str] = []
    while open_names:
        covering = [(before.explains(fit, open_names), fit) for fit in fits]
        most = max((len(covered) for covered, _ in covering), default=0)
        if not most:
            break
        rivals = [(covered, fit) for covered, fit in covering if len(covered) == most]
        covered = min(rivals, key=lambda pair: before.score(pair[1], pair[0]))[0]
        finding = before.finding([fit for names, fit in rivals if names == covered], covered)
        if len(finding.others) < MOST_ALIKE:
            findings.append(finding)
        else:
            unnamed += covered
        open_names = [name for name in open_names if name not in covered]
    return Explanation(tuple(findings), (*unnamed, *open_names))


def _fits(model: JudgedModel, verdicts: Sequence[SignalVerdict], names: Sequence[str], before: _Before) -> list[Fit]:
    """Every cause fitted that does no harm: those of the model to some samples of all signals, then those of columns.

    Where one of the model explains several columns at once, nothing is sought in each of them.
    """
    thin = [verdict.thinned(max(FEWEST, min(SAMPLES, SAMPLES * MANY // len(verdicts)))) for verdict in verdicts]
    masses = model_changes(model) if any(depends_on_masses(verdict.name) for verdict in verdicts) else ()
    causes = (length_changes(model), chain(motion_changes(model), masses))
    first, then = reversed(causes) if model.mechanism.is_numerical else causes
    found = _of_model(first, thin, verdicts)
    if not (model.mechanism.is_numerical and any(before.is_explained(fit) for fit in found)):
        found += _of_model(then, thin, verdicts)
    found += [fit for cause in group_changes(verdicts) if (fit := fitted(cause, verdicts)) is not None]
    found = [fit for fit in found if before.is_harmless(fit)]
    open_names = [verdict.name for verdict in verdicts if differs(verdict)]
    if len(open_names) > MANY and any(len(before.explains(fit, open_names)) == len(open_names) for fit in found):
        return found
    of_columns = [cause for v in verdicts if differs(v) for cause in signal_changes(model, v, names)]
    fits = [fit for cause in of_columns if (fit := fitted(cause, verdicts)) is not None]
    return [*found, *(fit for fit in fits if before.is_harmless(fit))]


def _of_model(
    causes: Iterable[FaultModel], thin: Sequence[SignalVerdict], verdicts: Sequence[SignalVerdict]
) -> list[Fit]:
    """Causes fitted to some samples, measured on all."""
    fits = (fit for cause in causes if (fit := fitted(cause, thin)) is not None)
    return [whole for fit in fits if (whole := refitted(fit, verdicts)) is not None]


class _Before:
    """Residuals of every signal before any fault is applied, and how fits compare with them."""

    def __init__(self, verdicts: Sequence[SignalVerdict]) -> None:
        self.verdicts = verdicts
        self.places = {verdict.name: n for n, verdict in enumerate(verdicts)}
        rest = [(v.residual / tolerance(v))[v.kept] for v in verdicts]
        self.rms = np.array([float(np.sqrt(np.mean(r**2))) if len(r) else 0.0 for r in rest])
        opens = [(v.open / tolerance(v))[v.kept] for v in verdicts]
        self.floor = np.array([ROUNDED * float(np.sqrt(np.mean(o**2))) if len(o) else 0.0 for o in opens]) + 1e-4

    def is_harmless(self, fit: Fit) -> bool:
        """Whether a fit makes no signal worse beyond its rounding."""
        return bool(np.all(fit.rms <= np.maximum(1.0, HARMED * self.rms)))

    def is_explained(self, fit: Fit) -> bool:
        """Whether a fit leaves no more than the rounding of any signal."""
        return bool(np.all(fit.largest <= NOTICED))

    def explains(self, fit: Fit, names: Sequence[str]) -> tuple[str, ...]:
        """Which of the signals a fit explains."""
        return tuple(n for n in names if fit.rms[(p := self.places[n])] <= max(ROUNDED, EXPLAINED * self.rms[p]))

    def score(self, fit: Fit, names: Sequence[str]) -> float:
        """Small for a likely cause: little left beyond the rounding, few numbers fitted."""
        places = [self.places[name] for name in names]
        left = np.log(np.maximum(fit.rms[places] / self.floor[places], ALIKE))
        free = 0 if fit.is_special else len(fit.numbers)
        return float(np.mean(left)) + BY_SIZE * (free + fit.cause.handicap) - BY_SIZE * fit.is_special

    def finding(self, rivals: Sequence[Fit], names: tuple[str, ...]) -> FaultFinding:
        """The likeliest of several fits that explain the same signals, and those that cannot be told from it."""
        ordered = sorted(rivals, key=lambda fit: self.score(fit, names))
        places = [self.places[name] for name in names]
        best = ordered[0]
        bound = ALIKE * np.maximum(best.rms[places], self.floor[places])
        alike = [fit for fit in ordered if np.all(fit.rms[places] <= bound)]
        kinds = {fit.cause.kind.partition(":")[0] for fit in alike}
        alike = [fit for fit in alike if fit is not best and not kinds & set(fit.cause.contains)]
        scales = [float(np.max(tolerance(self.verdicts[p]))) / self.verdicts[p].scale for p in places]
        left = max(largest * scale for largest, scale in zip(best.largest[places], scales, strict=True))
        fully = bool(np.all(best.largest[places] <= NOTICED))
        return FaultFinding(names, best, tuple(alike), left, fully)
