"""A cause is the closed form with one thing changed; its few numbers are fitted to the file by least squares."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.errors import LinkproofError
from comparisons.imported.columns import Correction
from comparisons.imported.judging.judgement import SignalVerdict

Array = NDArray[np.float64]
Predict = Callable[[Array, Sequence[SignalVerdict]], Sequence[Array]]

NEGLIGIBLE: Final = 1e-5  # of a signal's scale: what every solver's numerics may do, and no fault of a model
ROUNDS: Final = 8  # of Gauss-Newton
MOST_GUESSES: Final = 3  # from which fits are made
HALVINGS: Final = 6
SETTLED: Final = 1e-3  # relative gain below which a fit ends
STEP: Final = 1e-4  # of a number's own size, for its difference quotient
MOST_OPEN: Final = 0.2  # of a signal's samples that a cause may leave open, such as a filter's ends


@dataclass(frozen=True)
class FaultModel:
    """One thing that may be wrong: ``predict(numbers, verdicts)`` gives every signal with it, nan where it is open.

    ``start`` (k,) are the numbers with which nothing is wrong, ``sizes`` what a change of 1 means for each; ``guesses``
    are where fits begin. ``words(numbers)`` says it in one sentence; a number ``special`` to the fault is tried as it
    is, so that a missing mass is distinguished from 0.001 of the mass. ``corrections`` are what a mapping may agree
    to; a ``handicap`` makes it less likely, as one more number to fit would. Beside a cause of a kind that it
    ``contains`` it says nothing new.
    """

    kind: str
    predict: Predict
    words: Callable[[Array], str]
    start: tuple[float, ...] = ()
    sizes: tuple[float, ...] = ()
    guesses: tuple[tuple[float, ...], ...] = ()
    special: tuple[tuple[float, ...], ...] = ()
    signals: frozenset[str] = frozenset()
    corrections: Callable[[Array], dict[str, Correction]] | None = None
    handicap: int = 0
    contains: tuple[str, ...] = ()


@dataclass(frozen=True)
class Fit:
    """A cause with its numbers, and what it leaves of each signal's difference, relative to the signal's tolerance."""

    cause: FaultModel
    numbers: Array
    rms: Array
    largest: Array
    is_special: bool = False
    deviations: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def words(self) -> str:
        """What it is, in one sentence."""
        return self.cause.words(self.numbers)


def said(words: str) -> Callable[[Array], str]:
    """The words of a cause without numbers."""
    return lambda _: words


def tolerance(verdict: SignalVerdict) -> Array:
    """What a cause need not explain of a signal (n,)."""
    return np.asarray(verdict.open + NEGLIGIBLE * verdict.scale)


def left(verdicts: Sequence[SignalVerdict], predicted: Sequence[Array]) -> list[Array]:
    """What a prediction leaves of every signal, over its tolerance; nan where it is open or nothing is compared."""
    remains = []
    for verdict, values in zip(verdicts, predicted, strict=True):
        rest = (verdict.samples.values - values) / tolerance(verdict)
        remains.append(np.where(verdict.kept, rest, np.nan))
    return remains


def measures(rest: Sequence[Array]) -> tuple[Array, Array]:
    """RMS and largest magnitude of what is left of every signal; infinite where too much of it is open."""
    rms, largest = [], []
    for one in rest:
        known = one[np.isfinite(one)]
        enough = len(known) and len(known) >= (1.0 - MOST_OPEN) * len(one)
        rms.append(float(np.sqrt(np.mean(known**2))) if enough else np.inf)
        largest.append(float(np.max(np.abs(known))) if enough else np.inf)
    return np.array(rms), np.array(largest)


def fitted(cause: FaultModel, verdicts: Sequence[SignalVerdict]) -> Fit | None:
    """The best fit of a cause from its guesses; None where the linkage cannot be so."""
    fits = [fit for guess in _promising(cause, verdicts) if (fit := _from(cause, verdicts, np.array(guess)))]
    best = min(fits, key=lambda fit: float(np.sum(fit.rms**2)), default=None)
    if best is None:
        return None
    for special in cause.special:
        plain = _at(cause, verdicts, np.array(special), is_special=True)
        if plain and np.all(plain.rms <= np.maximum(1.3 * best.rms, 1.0)):
            return plain
    return best


def _promising(cause: FaultModel, verdicts: Sequence[SignalVerdict]) -> Sequence[tuple[float, ...]]:
    """The guesses from which a fit is made: of many those that are nearest to the file as they are."""
    if len(cause.guesses) <= MOST_GUESSES:
        return cause.guesses or (cause.start,)
    fits = {guess: _at(cause, verdicts, np.array(guess)) for guess in cause.guesses}
    costs = {guess: float(np.sum(fit.rms**2)) for guess, fit in fits.items() if fit is not None}
    return sorted(costs, key=lambda guess: costs[guess])[:MOST_GUESSES]


def _at(
    cause: FaultModel, verdicts: Sequence[SignalVerdict], numbers: Array, *, is_special: bool = False
) -> Fit | None:
    rest = _rest(cause, verdicts, numbers)
    return None if rest is None else Fit(cause, numbers, *measures(rest), is_special)


def refitted(fit: Fit, verdicts: Sequence[SignalVerdict]) -> Fit | None:
    """A fit made on some samples, measured on all."""
    return _at(fit.cause, verdicts, fit.numbers, is_special=fit.is_special)


def _rest(cause: FaultModel, verdicts: Sequence[SignalVerdict], numbers: Array) -> list[Array] | None:
    try:
        return left(verdicts, cause.predict(numbers, verdicts))
    except LinkproofError:
        return None


def _vector(rest: Sequence[Array]) -> Array:
    """Every signal alike, however many samples it has."""
    return np.concatenate([np.nan_to_num(one) / np.sqrt(len(one)) for one in rest])


def _from(cause: FaultModel, verdicts: Sequence[SignalVerdict], numbers: Array) -> Fit | None:
    """Gauss-Newton with halved steps."""
    rest = _rest(cause, verdicts, numbers)
    if rest is None:
        return None
    sizes = np.array(cause.sizes)
    for _ in range(ROUNDS if len(numbers) else 0):
        vector = _vector(rest)
        cost = float(vector @ vector)
        columns = []
        for k, size in enumerate(sizes):
            beside = _rest(cause, verdicts, numbers + STEP * size * np.eye(len(sizes))[k])
            if beside is None:
                return Fit(cause, numbers, *measures(rest))
            columns.append((_vector(beside) - vector) / STEP)
        jacobian = np.stack(columns, axis=1)
        if not np.all(np.isfinite(jacobian)) or not np.any(jacobian):
            break
        step = -np.linalg.lstsq(jacobian, vector, rcond=1e-10)[0] * sizes
        for _ in range(HALVINGS):
            trial = _rest(cause, verdicts, numbers + step)
            gain = -1.0 if trial is None else cost - float(np.sum(_vector(trial) ** 2))
            if gain > 0.0:
                break
            step = 0.5 * step
        if trial is None or gain <= 0.0:
            break
        numbers, rest = numbers + step, trial
        if gain <= SETTLED * cost:
            break
    return Fit(cause, numbers, *measures(rest))
