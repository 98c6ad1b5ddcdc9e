"""Local search for the least aim of a problem, with its cost and the residual of its optimality conditions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from analytic.errors import AssemblyError
from analytic.numerics.arrays import Array
from comparisons.designer.problem import ALLOWED_EXCESS, DesignProblem, Linearised, SampleWindow, shifted

ROUNDS: Final = 15
SETTLED: Final = 1e-10  # by which a round has to lower the aim for another one as wide
STATIONARY: Final = 1e-7  # residual of a design from which no way leads down
SMALLEST: Final = 1e-6  # part of the bounds in which a lower design is still looked for
STEPS: Final = 60
ENOUGH: Final = 1e-9  # of a violation, to which it is lowered where a constraint does not hold
APART: Final = 1e-6  # shares of the aim by which two ends are different
OUT_OF_REACH: Final = 10.0  # penalty, scaled, of a design that cannot be assembled
ACTIVE: Final = 1e-7
INDEPENDENT: Final = 1e-9  # scaled slope from which a constrained figure depends on the variables


@dataclass(frozen=True)
class End:
    """End of a search from one design: its ``place`` (variables,), 0 to 1, the scaled aim, the largest violation.

    A violation is a share of the constraint's size.
    """

    place: Array
    aim: float
    violation: float

    @property
    def is_feasible(self) -> bool:
        """Whether the design there meets all constraints."""
        return self.violation <= ALLOWED_EXCESS

    @property
    def rank(self) -> tuple[float, float]:
        """Sort key of ends, the best first: violation, 0 for one that meets all constraints, then scaled aim."""
        return (0.0, self.aim) if self.is_feasible else (self.violation, self.aim)


@dataclass
class Descent:
    """Local search with SLSQP in rounds, each with the local maxima of its start; ends when no round lowers the aim.

    It counts the designs evaluated with their ``gradients``, and of these, those ``beyond`` what can be assembled.
    """

    problem: DesignProblem
    gradients: int = 0
    beyond: int = 0

    def run(self, start: Array) -> End | None:
        """The end of a search from a place (variables,); None where the design there cannot be assembled.

        It counts the designs that it evaluates.
        """
        try:
            end = self.end(start)
        except AssemblyError:
            return None
        radius = 1.0
        for _ in range(ROUNDS):
            result = self._search_round(end, radius)
            gain = (
                -np.inf
                if result is None
                else end.violation - result.violation
                if end.violation > ALLOWED_EXCESS
                else end.aim - result.aim
            )
            if result is not None and result.rank < end.rank:
                end = result
            if gain < SETTLED:
                radius *= 0.1
            done = self.residual(end.place) < STATIONARY if end.is_feasible else gain < SETTLED
            if done or radius < SMALLEST:
                break
        return end

    def residual(self, place: Array) -> float:
        """The largest slope that still leads down within the constraints, as a share of the aim: 0 at an optimum.

        It is the change of the aim, as a share of it, over the whole of the bounds: the shortest combination of the
        gradients of the highest local maxima with those of the constraints and of the active bounds (Karush, Kuhn,
        Tucker). Raises AssemblyError where the design cannot be assembled.
        """
        from scipy.optimize import nnls  # noqa: PLC0415

        here = self.linearise(place, self.problem.windows(place))
        aims = here.aim[here.aim[:, 0] > np.max(here.aim[:, 0]) - ACTIVE, 1:]
        eye, equal = np.eye(len(place)), here.equal[:, 1:]
        walls = [here.inside[here.inside[:, 0] < ACTIVE, 1:], equal, -equal, eye[place < ACTIVE],
                 -eye[place > 1.0 - ACTIVE]]  # fmt: skip
        normals = np.vstack(walls)
        matrix = np.vstack([np.vstack([aims, -normals]).T, np.append(np.ones(len(aims)), np.zeros(len(normals)))])
        shares, _ = nnls(matrix, np.append(np.zeros(len(place)), 1.0))
        shares /= np.sum(shares[: len(aims)]) or 1.0
        return float(np.linalg.norm(matrix[:-1] @ shares))

    def end(self, place: Array) -> End:
        """The design at a place (variables,) as the end of a search; raises AssemblyError if it does not assemble."""
        here = self.linearise(place, self.problem.windows(place))
        return End(place, float(np.max(here.aim[:, 0])), here.violation)

    def linearise(self, place: Array, windows: tuple[SampleWindow, ...]) -> Linearised:
        """The design at a place (variables,), linearised and counted; raises AssemblyError if it does not assemble."""
        self.gradients += 1
        return self.problem.linearise(place, windows)

    def _search_round(self, end: End, radius: float) -> End | None:
        """The end of an SLSQP search within a radius, a share of the bounds; None if it is not finite or assembled.

        It lowers the aim or, if a constraint is violated, the violation. Either is a variable of its own, above all
        local maxima or all violations.
        """
        from scipy.optimize import minimize  # noqa: PLC0415

        designs = _CachedDesigns(self, end.place)
        column = np.append(np.zeros(len(end.place)), 1.0)

        def limits(z: Array) -> Array:
            """The rows (n, 2 + variables) of ``_limits`` at the place in ``z``, which is a place and then the bound."""
            return _limits(designs(z[:-1]), is_feasible=end.is_feasible)

        held: list[dict[str, Any]] = [{
            "type": "ineq",
            "fun": lambda z: (rows := limits(z))[:, 0] + z[-1] * rows[:, -1],
            "jac": lambda z: limits(z)[:, 1:],
        }]  # fmt: skip
        free = independent(designs(end.place).equal[:, 1:]) if end.is_feasible else []
        if free:
            held.append({
                "type": "eq",
                "fun": lambda z: designs(z[:-1]).equal[free, 0],
                "jac": lambda z: np.column_stack([designs(z[:-1]).equal[free, 1:], np.zeros(len(free))]),
            })  # fmt: skip
        box = [(max(0.0, x - radius), min(1.0, x + radius)) for x in end.place]
        first, least, exactness = (end.aim, None, 1e-15) if end.is_feasible else (end.violation, 0.0, ENOUGH)
        result = minimize(
            lambda z: z[-1], np.append(end.place, first), jac=lambda _: column, bounds=[*box, (least, None)],
            constraints=held, method="SLSQP", options={"maxiter": STEPS, "ftol": exactness},
        )  # fmt: skip
        place = np.asarray(result.x[:-1])
        try:
            return self.end(np.clip(place, 0.0, 1.0)) if np.all(np.isfinite(place)) else None
        except AssemblyError:
            return None


def _limits(design: Linearised, *, is_feasible: bool) -> Array:
    """Rows that, with z by their last factor, are positive if a design's aim is at most z and it is feasible.

    Of a design that is not feasible they are positive if no constraint is violated by more than z. A row has a value,
    its derivatives by place, and the factor: (n, 2 + variables).
    """
    parts = [(-design.aim, 1.0), (design.inside, 0.0)]
    if not is_feasible:
        parts = [(design.inside, 1.0), (design.equal, 1.0), (-design.equal, 1.0)]
    return np.vstack([np.column_stack([rows, np.full(len(rows), factor)]) for rows, factor in parts])


def independent(slopes: Array) -> list[int]:
    """Indices of a largest set of linearly independent rows of slopes (n, variables), ascending.

    A row without a slope of INDEPENDENT or more is left out.
    """
    rows: list[int] = []
    for row in range(len(slopes)):
        if np.linalg.matrix_rank(slopes[[*rows, row]], tol=INDEPENDENT) > len(rows):
            rows.append(row)
    return rows


class _CachedDesigns:
    """Designs of one round by their place, the last one kept; one that cannot be assembled gets a large penalty."""

    def __init__(self, descent: Descent, start: Array) -> None:
        """Linearise designs in the windows of the design ``start``; raises AssemblyError if that does not assemble."""
        self.descent, self.windows = descent, descent.problem.windows(start)
        self.last, self.designs = start, descent.linearise(start, self.windows)
        self.good = self.designs

    def __call__(self, place: Array) -> Linearised:
        """The design at a place (variables,), linearised and kept until another place is asked for.

        Where it cannot be assembled it is a stand-in worse than the last good one, counted as ``beyond``.
        """
        if not np.array_equal(place, self.last):
            self.last = place.copy()
            try:
                self.designs = self.good = self.descent.linearise(place, self.windows)
            except AssemblyError:
                self.descent.beyond += 1
                far = self.good
                away = (OUT_OF_REACH, -OUT_OF_REACH, OUT_OF_REACH)
                self.designs = Linearised(*(shifted(rows, by) for rows, by in zip(far, away, strict=True)))
        return self.designs


# Searches for the least of a problem: downhill from one design or several, or over all of the bounds.

ANGLES: Final = 90  # crank angles at which designs are sampled, before the best are searched from
SAMPLES: Final = 4096  # designs sampled over all of the bounds, times a power of two for each variable beyond two
MOST_SAMPLES: Final = 65_536
PICKED: Final = 12  # of them, from which is searched downhill
AGREEING: Final = 6  # where so many searches, the first ones, all end at the same, that is taken for the least
RESTARTS: Final = 8  # designs to start from where the search from the file's design ends at none that is allowed
DRAWN: Final = 128  # designs sampled for these
OUT_OF_REACH_ENDS: Final = 3  # where so many searches miss the constraints by the same, no design is looked for on
SPACED: Final = 0.1  # share of the bounds by which two of these differ in one variable or more
GOLDEN: Final = 60  # iterations until a golden ratio has all digits
PENALTY: Final = 3.0  # weight of a violated constraint beside the aim
Announce = Callable[[str, int, int], None]


@dataclass
class Search:
    """The ends of searches from several designs, the first from the file's; None where one cannot be assembled.

    ``everywhere`` tells whether others than the file's were to be searched from. ``sampled`` counts the designs without
    gradients; ``residual`` is that of the best end, nan without.
    """

    descent: Descent
    everywhere: bool
    ends: list[End | None] = field(default_factory=list)
    sampled: int = 0
    residual: float = np.nan

    @property
    def method(self) -> str:
        """The search method in words: "SLSQP", and ", from the best of an even sample" if ``everywhere``."""
        return "SLSQP" + (", from the best of an even sample" if self.everywhere else "")

    @property
    def best(self) -> End | None:
        """The lowest end that meets the constraints; else the end with the least violation; None without an end."""
        return min((end for end in self.ends if end is not None), key=lambda end: end.rank, default=None)

    @property
    def elsewhere(self) -> tuple[End, ...]:
        """Ends that are worse than the best: higher by more than APART, or with a constraint violated; () without any.

        Where no end meets the constraints, these are all ends.
        """
        best = self.best
        return tuple(
            end for end in self.ends if best is not None and end is not None
            and (not end.is_feasible or end.aim > best.aim + APART * max(1.0, abs(best.aim)))
        )  # fmt: skip

    @property
    def misses_alike(self) -> bool:
        """Whether OUT_OF_REACH_ENDS ends violate the constraints as little as the best, so that none comes nearer."""
        found = [end.violation for end in self.ends if end is not None]
        return sum(violation <= min(found) + APART for violation in found) >= OUT_OF_REACH_ENDS

    def starts(self, count: int, most: int) -> list[Array]:
        """Places (variables,) to start from: at most ``most``, the best of an even sample of ``count``, spaced apart.

        The sample is added to ``sampled``; [] where none of it can be assembled.
        """
        problem = self.descent.problem
        places = _even_places(count, len(problem.variables))
        self.sampled += count
        angles = problem.maxima.grid[:: max(1, len(problem.maxima.grid) // ANGLES)]
        aim, violation = problem.sample_designs(places, angles)
        merits, picked = aim + PENALTY * violation, list[Array]()
        for number in np.argsort(merits):
            if len(picked) == most or not np.isfinite(merits[number]):
                break
            if all(np.max(np.abs(places[number] - values)) > SPACED for values in picked):
                picked.append(places[number])
        return picked


def search(problem: DesignProblem, start: Array, announce: Announce, *, everywhere: bool = False) -> Search:
    """Search from the file's design ``start`` and, if ``everywhere``, from the best designs of an even sample.

    ``announce`` is called with words, number from 0 and count before each of these. Once the first few searches end at
    the same design, no others are made. Where the search from the file's design is the only one and ends without
    meeting the constraints, a few sampled designs are tried, until one meets them or several miss them alike.
    """
    result = Search(Descent(problem), everywhere)
    ends, run = result.ends, result.descent.run
    samples = min(SAMPLES * 2 ** max(0, len(problem.variables) - 2), MOST_SAMPLES)
    others = result.starts(samples, PICKED) if everywhere else []
    for number, place in enumerate([start, *others]):
        announce(f"search {number + 1}", number, 1 + len(others))
        ends.append(run(place))
        if everywhere and len(ends) == AGREEING and None not in ends and not result.elsewhere:
            break
    if len(ends) == 1 and (ends[0] is None or not ends[0].is_feasible):
        for place in result.starts(DRAWN, RESTARTS):
            ends.append(end := run(place))
            if (end is not None and end.is_feasible) or result.misses_alike:
                break
    if result.best is not None:
        result.residual = result.descent.residual(result.best.place)
    return result


def _even_places(count: int, dimensions: int) -> Array:
    """Places of the unit cube (count, dimensions), evenly spread; computed here, as an import would cost more.

    Multiples of 1/g, 1/g², ..., less their whole parts, with g^(d + 1) = g + 1: the golden ratio's sequence in d
    dimensions (M. Roberts, The Unreasonable Effectiveness of Quasirandom Sequences, 2018).
    """
    ratio = 1.0
    for _ in range(GOLDEN):
        ratio = (1.0 + ratio) ** (1.0 / (dimensions + 1))
    steps = ratio ** -np.arange(1.0, dimensions + 1.0)
    return np.mod(0.5 + np.outer(np.arange(1.0, count + 1.0), steps), 1.0)
