"""Searches for the least of a problem: downhill from one design or several, or over all of the bounds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from comparisons.designs.optimum.descent import APART, Counter, Descent, End
from comparisons.designs.optimum.problem import DesignProblem

Array = NDArray[np.float64]

ANGLES: Final = 90  # crank angles at which designs are sampled, before the best are searched from
SAMPLES: Final = 4096  # designs sampled over all of the bounds, times a power of two for each variable beyond two
MOST_SAMPLES: Final = 65_536
PICKED: Final = 12  # of them, from which is searched downhill
AGREEING: Final = 6  # where so many searches, the first ones, all end at the same, that is taken for the least
SPACED: Final = 0.1  # share of the bounds by which two of these differ in one variable or more
PENALTY: Final = 3.0  # weight of a violated constraint beside the aim
Announce = Callable[[str, int, int], None]


@dataclass(frozen=True)
class Search:
    """The ends of searches from several designs, the first from the file's; None where one cannot be assembled."""

    method: str
    ends: tuple[End | None, ...]
    counter: Counter
    residual: float

    @property
    def best(self) -> End | None:
        """The lowest end that meets the constraints; else the end with the least violation."""
        return _best(self.ends)

    @property
    def elsewhere(self) -> tuple[End, ...]:
        """Ends that are higher than the best, or violate a constraint."""
        return _elsewhere(self.ends)


def _best(ends: Sequence[End | None]) -> End | None:
    return min((end for end in ends if end is not None), key=lambda end: end.rank, default=None)


def _elsewhere(ends: Sequence[End | None]) -> tuple[End, ...]:
    """Ends that are higher than the best, or violate a constraint."""
    best = _best(ends)
    return tuple(
        end for end in ends if best is not None and end is not None
        and (not end.is_feasible or end.aim > best.aim + APART * max(1.0, abs(best.aim)))
    )  # fmt: skip


def search(
    problem: DesignProblem,
    start: Array,
    announce: Announce,
    *,
    starts: int = 1,
    seed: int = 0,
    everywhere: bool = False,
) -> Search:
    """Search from the file's design ``start``, and from others: ``starts`` in all, or ``everywhere`` the best sampled.

    The others are drawn by ``seed``, a Sobol sequence. Those sampled everywhere are not all searched from where the
    first few searches have ended at the same.
    """
    counter = Counter()
    descent = Descent(problem, counter)
    others = []
    if everywhere or starts > 1:
        others = _picked(problem, counter, seed) if everywhere else _drawn(problem, counter, starts - 1, seed)
    ends: list[End | None] = []
    for number, place in enumerate([start, *others]):
        announce(f"search {number + 1}", number, 1 + len(others))
        ends.append(descent.run(place))
        if everywhere and len(ends) == AGREEING and None not in ends and not _elsewhere(ends):
            break
    if ends == [None]:  # the file's design is out of the bounds, and the nearest within cannot be assembled
        ends += map(descent.run, _drawn(problem, counter, 1, seed))
    method = "SLSQP" + (", from the best of a Sobol sample" if everywhere else "")
    result = Search(method, tuple(ends), counter, np.nan)
    best = result.best
    if best is None:
        return result
    return replace(result, residual=descent.residual(best.place))


def _drawn(problem: DesignProblem, counter: Counter, count: int, seed: int) -> list[Array]:
    """The first designs of a Sobol sequence that can be assembled; fewer if the sequence has fewer."""
    places, merits = _sampled(problem, counter, max(64, 16 * count), seed)
    return list(places[np.isfinite(merits)][:count])


def _picked(problem: DesignProblem, counter: Counter, seed: int) -> list[Array]:
    """The best of a Sobol sample, no two of them near each other."""
    count = min(SAMPLES * 2 ** max(0, len(problem.variables) - 2), MOST_SAMPLES)
    places, merits = _sampled(problem, counter, count, seed)
    picked: list[Array] = []
    for number in np.argsort(merits):
        if len(picked) == PICKED or not np.isfinite(merits[number]):
            break
        if all(np.max(np.abs(places[number] - values)) > SPACED for values in picked):
            picked.append(places[number])
    return picked


def _sampled(problem: DesignProblem, counter: Counter, count: int, seed: int) -> tuple[Array, Array]:
    """Designs of a Sobol sequence (designs, variables), and how low they are: nan where they cannot be assembled."""
    from scipy.stats import qmc  # noqa: PLC0415

    places = qmc.Sobol(len(problem.variables), rng=seed).random_base2(int(np.ceil(np.log2(count))))
    counter.sampled += len(places)
    angles = problem.maxima.grid[:: max(1, len(problem.maxima.grid) // ANGLES)]
    aim, missed = problem.sampled(places, angles)
    return np.asarray(places, dtype=float), np.asarray(aim + PENALTY * missed)
