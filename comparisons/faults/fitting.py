"""A fault fitted to the columns of a file: its few numbers by least squares, usual and round ones as they are."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.errors import LinkproofError
from comparisons.faults.columns import Evidence
from comparisons.faults.fault import Fault, Kind, Numbers
from comparisons.faults.simulation import Simulation, holds_acceleration, is_angle
from comparisons.judging.deviations import near_jumps

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
        if kind is Kind.SEVERAL and not self.digits:
            return (Kind.SETTING, 0) if len(self.numbers) < 2 else (Kind.NUMBER, NOT_ROUND)
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
