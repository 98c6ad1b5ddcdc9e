"""The best design of a linkage for a request, with further results for its designer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.designs.derivatives import signal_gradients
from analytic.designs.figures import Reduction
from analytic.errors import AssemblyError, LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.designs.named_figures import NamedFigure, named_figures
from comparisons.designs.optimum.descent import ACTIVE, End, independent
from comparisons.designs.optimum.problem import HELD, DesignProblem, KeptFigure, Variable
from comparisons.designs.optimum.rounding import rounded, step_size
from comparisons.designs.optimum.searches import Announce, Search, search
from comparisons.designs.optimum.wishes import kept, kept_figures, variables
from comparisons.designs.steady_motion import SteadyMotion

Array = NDArray[np.float64]

TOLD: Final = ("stroke", "Mkr.peak", "Jeq.mean", "joint_force.peak", "transmission_angle.min")
KINKED: Final = (Reduction.MAX, Reduction.RANGE)
OF_MANY: Final = (Reduction.PEAK, Reduction.MAX)  # of which the highest of several figures can be minimised


@dataclass(frozen=True)
class Wish:
    """An optimisation as typed: a figure, numbers to vary, figures to hold, and search options.

    Lengths are rounded to a ``step``, if there is one.
    """

    figure: str
    over: Sequence[str]
    keep: Sequence[str] = ()
    is_least: bool = True
    starts: int = 1
    seed: int = 0
    everywhere: bool = False
    step: str = ""

    def check(self) -> None:
        """Raise LinkproofError for what cannot be."""
        if self.starts < 1:
            raise LinkproofError(f"--starts: expected 1 or more designs, got {self.starts}; correct it")
        if self.seed < 0:
            raise LinkproofError(f"--seed: expected a number that is not negative, got {self.seed}; correct it")
        if self.everywhere and self.starts > 1:
            raise LinkproofError("--global chooses its starts itself, and --starts says how many: leave one out")


@dataclass(frozen=True)
class Optimum:
    """The best design found: numbers and ``values`` (2, figures), SI, before and after; the aims come first.

    Lengths are multiples of a ``step``, if one was typed; ``exact`` (figures,) are the values before they were rounded.
    """

    problem: DesignProblem
    search: Search
    end: End
    before: Mapping[str, float]
    after: Mapping[str, float]
    figures: tuple[NamedFigure, ...]
    values: Array
    step: str
    exact: Array

    def bound(self, variable: Variable) -> str:
        """At which of its bounds a number ended: lower, upper, or neither."""
        here = (self.after[variable.parameter.name] - variable.low) / (variable.high - variable.low)
        return "lower" if here < ACTIVE else "upper" if here > 1.0 - ACTIVE else ""

    def curves(self) -> dict[str, Array]:
        """The signals of the aims and of what is kept, and Mkr, over the grid of the tops: (2, angles), SI."""
        known = self.problem.mechanism
        names = [one.figure.signal for one in (*self.problem.figures, *_told(known, ["Mkr.peak"]))]
        wanted, tops = tuple(dict.fromkeys(names)), self.problem.tops
        rows = [
            signal_gradients(known, numbers, wanted, tops.grid, speed=tops.motion.speed)[0]
            for numbers in (self.before, self.after)
        ]
        return dict(zip(wanted, np.stack(rows, axis=1), strict=True))

    @property
    def is_fixed(self) -> bool:
        """Whether the kept figures leave nothing to vary."""
        slopes = self.problem.at(self.end.place, self.problem.windows(self.end.place)).equal_slopes
        return len(independent(slopes)) == len(self.problem.variables)

    @property
    def change(self) -> Array:
        """Relative changes of the figures (figures,); nan from zero."""
        before, after = self.values
        return np.asarray((after - before) / np.where(before == 0.0, np.nan, np.abs(before)))


def optimise(mechanism: Mechanism, motion: SteadyMotion, wish: Wish, announce: Announce) -> Optimum:
    """The best design between the bounds; raises LinkproofError for bad input and where there is none."""
    wish.check()
    varied = variables(mechanism.linkage, wish.over, motion.speed)
    step = step_size(varied, wish.step) if wish.step else None
    aims = named_figures(mechanism, [wish.figure])
    sign = 1.0 if wish.is_least else -1.0
    texts = kept_figures(mechanism, wish.keep)
    _check_figures(aims, tuple(texts), wish)
    told = named_figures(mechanism, [*dict.fromkeys(one.name for one in (*aims, *texts))])
    others = [one for one in _told(mechanism, TOLD) if one.name not in {one.name for one in told}]
    figures = (*told, *others)
    before = {one.parameter.name: one.parameter.value for one in varied}
    own = _figures(mechanism, motion, figures, before)
    sizes = dict(zip((one.name for one in figures), own, strict=True))
    held = tuple(kept(one, text, float(sizes[one.name])) for one, text in texts.items())
    problem = DesignProblem(
        mechanism, motion, aims, sign, varied, held,
        max(float(np.max([np.abs(sizes[one.name]) for one in aims])), _least(aims[0])),
        tuple(max(_size(one), abs(float(sizes[one.figure.name])), _least(one.figure)) for one in held),
    )  # fmt: skip
    start = np.clip((np.array(list(before.values())) - problem.low) / problem.width, 0.0, 1.0)
    _check_depends(problem, start)
    found = search(problem, start, announce, starts=wish.starts, seed=wish.seed, everywhere=wish.everywhere)
    end = _checked(problem, found, motion)
    exact = problem.numbers(end.place)
    after = exact if step is None else rounded(problem, exact, step)
    values = np.array([own, *(_figures(mechanism, motion, figures, one) for one in (after, exact))])
    return Optimum(problem, found, end, before, after, figures, values[:2], wish.step, values[2])


def _check_figures(aims: Sequence[NamedFigure], keep: Sequence[NamedFigure], wish: Wish) -> None:
    """Raise LinkproofError for figures that cannot be optimised or kept."""
    for one in (*aims, *keep):
        if one.figure.signal.startswith("transmission_angle:") and one.figure.reduction in KINKED:
            raise LinkproofError(f"{one.name}: expected .min, the least transmission angle, which can be optimised and "
                                 "kept; its largest is mostly 90°, in a kink")  # fmt: skip
    if len(aims) > 1 and aims[0].figure.reduction not in (OF_MANY if wish.is_least else (Reduction.MIN,)):
        names = ", ".join(one.name for one in aims)
        raise LinkproofError(f"expected one figure, got {wish.figure}, which stands for {names}; choose one of them")


def _told(mechanism: Mechanism, names: Sequence[str]) -> list[NamedFigure]:
    """Those of the figures that the linkage has."""
    found: list[NamedFigure] = []
    for name in names:
        try:
            found += named_figures(mechanism, [name])
        except LinkproofError:
            continue
    return found


def _figures(
    mechanism: Mechanism, motion: SteadyMotion, figures: Sequence[NamedFigure], design: Mapping[str, float]
) -> Array:
    """Figures (figures,) of a design, refined, SI."""
    numbers = {name: np.array([value]) for name, value in design.items()}
    return motion.figures(mechanism, numbers, [one.figure for one in figures])[:, 0]


def _size(one: KeptFigure) -> float:
    return max((abs(end) for end in (one.low, one.high) if np.isfinite(end)), default=0.0)


def _least(one: NamedFigure) -> float:
    """A size for a figure that is zero: a millionth of the file's unit."""
    return 1e-6 * one.unit.size


def _check_depends(problem: DesignProblem, start: Array) -> None:
    """Raise LinkproofError where the aim depends on none of the numbers."""
    try:
        found = problem.at(start, problem.windows(start))
    except AssemblyError:
        return
    if not np.any(np.abs(found.aim_slopes) > HELD):
        names = ", ".join(one.parameter.name for one in problem.variables)
        aim = ", ".join(one.name for one in problem.aims)
        raise LinkproofError(f"expected a figure that depends on {names}, got {aim}, which does not; choose others")


def _checked(problem: DesignProblem, found: Search, motion: SteadyMotion) -> End:
    """The best end; raises LinkproofError where nothing can be assembled or what is kept is out of reach."""
    best = found.best
    if best is None:
        raise LinkproofError(
            f"expected designs that can be assembled at every angle, got none of {found.counter.sampled + 1} within "
            "the bounds; choose others"
        )
    if best.is_feasible:
        return best
    values = _figures(problem.mechanism, motion, problem.figures, problem.numbers(best.place))[len(problem.aims) :]
    worst = max(
        zip(problem.kept, values, problem.kept_sizes, strict=True),
        key=lambda row: float(row[0].missed(row[1])) / row[2],
    )
    one, value, size = worst[0].figure, worst[1], worst[0].figure.unit.size
    ends = [f"{word} {end / size:.6g}" for word, end in (("from", worst[0].low), ("to", worst[0].high))
            if np.isfinite(end)]  # fmt: skip
    asked = f"of {worst[0].low / size:.6g}" if worst[0].is_equal else " ".join(ends)
    unit = f" {one.unit.name}" if one.unit.name else ""
    raise LinkproofError(
        f"expected a design with {one.name} {asked}{unit}, got none within the bounds; the nearest found has "
        f"{float(value) / size:.6g}{unit}: widen --over or --keep"
    )
