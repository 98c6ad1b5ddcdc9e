"""The best design of a linkage for a request, with further results for its designer."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from analytic.designs.derivatives import signal_values
from analytic.designs.figures import Reduction
from analytic.errors import AssemblyError, LinkproofError
from analytic.numerics.arrays import Array
from comparisons.designer.parameters import (
    NamedFigure,
    OpenEndFigures,
    SteadyCase,
    known_figures,
    named_figures,
)
from comparisons.designer.problem import (
    ALLOWED_EXCESS,
    DesignProblem,
    Variable,
    constraint,
    constraint_texts,
    variables,
)
from comparisons.designer.searches import ACTIVE, Announce, Descent, End, Search, independent, search

# An optimum whose lengths can be made: whole steps between their bounds, the other numbers searched for again.


STEP_ROUNDING = 1e-9  # of a step: a bound that is a multiple but for rounding


def step_size(variables: Sequence[Variable], text: str) -> float:
    """The step of ``--round``, m, typed as ``0.1mm`` or in the file's unit.

    Raises LinkproofError for a text that is no positive length, and where no length is varied.
    """
    lengths = [variable.parameter for variable in variables if variable.parameter.kind == "length"]
    if not lengths:
        raise LinkproofError("--round: expected a length among the numbers of --over, got none; leave it out")
    step = replace(lengths[0], name="--round").si(text)
    if not step > 0.0:
        raise LinkproofError(f"--round: expected a positive length, got '{text}'; correct it")
    return step


def round_lengths(problem: DesignProblem, place: Array, step: float) -> dict[str, float]:
    """Numbers, SI, by name, of the best design near a place, the optimum's, whose lengths are multiples of ``step``, m.

    One length after the other takes the better of its two neighbouring multiples, which are then its bounds; all others
    are searched for anew, so that the constraints hold as long as numbers are left. Raises LinkproofError where no
    multiple beside a length is within its bounds or assembles.
    """
    for number, variable in enumerate(problem.variables):
        if variable.parameter.kind != "length":
            continue
        value, slack = problem.low[number] + problem.width[number] * place[number], STEP_ROUNDING * step
        below, start, tried = math.floor(value / step + STEP_ROUNDING), place.copy(), []
        start[number] = 0.0
        for multiple in (below * step, (below + 1) * step):
            fixed = [*problem.variables]
            fixed[number] = variable._replace(low=multiple, high=multiple)
            rounded = replace(problem, variables=tuple(fixed))
            is_within = variable.low - slack <= multiple <= variable.high + slack
            end = Descent(rounded).run(start) if is_within else None
            if end is not None:
                tried.append((end.rank, multiple, rounded, end.place))
        if not tried:
            unit = variable.parameter.unit
            raise LinkproofError(
                f"--round: expected designs at multiples of {step / unit.size:g} {unit.name} beside "
                f"{variable.parameter.name} {value / unit.size:g}, within the bounds, got none; give a finer step or "
                "wider bounds"
            )
        _, _, problem, place = min(tried)
    return problem.numbers(place)


# The best design of a linkage for a request, with further results for its designer.


REPORTED: Final = ("stroke", "Mkr.peak", "Jeq.mean", "joint_force.peak", "transmission_angle.min")
KINKED: Final = (Reduction.MAX, Reduction.RANGE)
DIGITS: Final = (6, 9, 12)  # of a number that a new file has
AS_GOOD: Final = 1e-6  # share of the aim that fewer digits may cost
OF_HIGHEST: Final = (Reduction.PEAK, Reduction.MAX)  # of which the highest of several figures can be minimised


@dataclass(frozen=True)
class Optimum:
    """The best design: its numbers and figures, before and after; SI.

    ``before`` and ``after`` are the varied numbers by name, ``values`` (2, figures) the ``figures``, those of the aims
    first. ``search`` holds all searches, ``end`` the end of the best. Lengths are multiples of a ``step``, as typed, ""
    without; ``exact`` (figures,) are the values before they were rounded.
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
        """The bound at which a number ended: "lower", "upper", or "" for neither."""
        here = (self.after[variable.parameter.name] - variable.low) / (variable.high - variable.low)
        return "lower" if here < ACTIVE else "upper" if here > 1.0 - ACTIVE else ""

    @cached_property
    def warnings(self) -> list[str]:
        """Sentences that warn a reader of the best design; [] without.

        They are on open ends, and on loads over φ that keep their angles while its top dead centre moves.
        """
        loads = self.problem.case.loads_that_stay([self.after])
        return [*filter(None, (self.at_open_end.sentence, loads))]

    @cached_property
    def written(self) -> dict[str, float]:
        """The numbers, SI, by name as the new file has them: at a bound this bound, else with few digits.

        They have the fewest of DIGITS with which the design serves as well, or all of theirs.
        """
        for digits in DIGITS:
            numbers = {entry.parameter.name: self._short(entry, digits) for entry in self.problem.variables}
            if self._serves(numbers):
                return numbers
        return dict(self.after)

    def _short(self, variable: Variable, digits: int) -> float:
        """The best design's value of a variable, SI, rounded to so many digits of the file's unit, within its bounds.

        At a bound it is the bound itself.
        """
        at = self.bound(variable)
        if at:
            return variable.low if at == "lower" else variable.high
        size = variable.parameter.unit.size
        value = float(f"{self.after[variable.parameter.name] / size:.{digits}g}") * size
        return min(max(value, variable.low), variable.high)

    def _serves(self, numbers: Mapping[str, float]) -> bool:
        """Whether a design of these numbers, SI, by name, is nearly as good as the best one and keeps the constraints.

        Its aim may differ by AS_GOOD of the aim's size; no constraint may be violated more than in the best design, or
        than by ALLOWED_EXCESS of its size.
        """
        problem, count = self.problem, len(self.problem.aims)
        values = problem.case.figures_of(numbers, problem.figures)
        held = zip(problem.constraints, values[count:], self.values[1, count:], problem.constraint_sizes, strict=False)
        is_held = all(
            float(part.violation(value)) <= max(float(part.violation(known)), ALLOWED_EXCESS * size)
            for part, value, known, size in held
        )
        return bool(abs(self.aim(values) - self.aim(self.values[1])) <= AS_GOOD * problem.aim_size) and is_held

    def curves(self) -> dict[str, Array]:
        """The signals of aims and constraints, and Mkr if there is one, before and after, by name: (2, angles), SI.

        The angles are those of ``problem.maxima.grid``. Raises AssemblyError where either design cannot be assembled.
        """
        case, grid = self.problem.case, self.problem.maxima.grid
        figures = (*self.problem.figures, *known_figures(case.mechanism, ["Mkr.peak"]))
        signals = tuple(dict.fromkeys(figure.figure.signal for figure in figures))
        rows = [
            signal_values(case.mechanism, numbers, signals, grid, speed=case.speed)
            for numbers in (self.before, self.after)
        ]
        return dict(zip(signals, np.stack(rows, axis=1), strict=True))

    @cached_property
    def at_open_end(self) -> OpenEndFigures:
        """The figures whose extremes lie at an open end, of the best design or, if none there, of the file's."""
        of_best = self.problem.case.redesigned(self.after).open_ends(self.figures)
        return of_best if of_best.names else self.problem.case.open_ends(self.figures)

    def aim(self, values: Array) -> float:
        """The aim's value, SI, among the values of figures (figures,), aims first: of several aims the worst one's."""
        sign = self.problem.sign
        return float(sign * np.max(sign * values[: len(self.problem.aims)]))

    @property
    def is_fixed(self) -> bool:
        """Whether the constraints to a single value leave nothing to vary at the best design."""
        slopes = self.problem.linearise(self.end.place, self.problem.windows(self.end.place)).equal[:, 1:]
        return len(independent(slopes)) == len(self.problem.variables)

    @property
    def change(self) -> Array:
        """Changes of the figures (figures,) over their magnitudes before; nan from zero."""
        before, after = self.values
        return np.asarray((after - before) / np.where(before == 0.0, np.nan, np.abs(before)))


def optimise(
    case: SteadyCase,
    figure: str,
    over: Sequence[str],
    keep: Sequence[str] = (),
    *,
    is_least: bool = True,
    everywhere: bool = False,
    step: str = "",
    announce: Announce = lambda *_: None,
) -> Optimum:
    """The design with the least, else the largest, ``figure`` over numbers within bounds, texts as typed.

    ``over`` are numbers with bounds, ``rod.B.x=170:180``, ``keep`` constrained figures, ``stroke=29.9:30.1`` or
    ``stroke``. The search is ``everywhere`` in the bounds, or from the file's design; lengths are rounded to a
    ``step``, ``0.1mm``, if there is one. ``announce`` is called before each search with words, its number from 0, and
    their count. Raises LinkproofError for bad input and if no design is feasible.
    """
    varied = variables(case, over)
    multiple = step_size(varied, step) if step else 0.0
    aims, texts = named_figures(case.mechanism, [figure]), constraint_texts(case.mechanism, keep)
    _check_figures(aims, tuple(texts), figure, is_least=is_least)
    names = dict.fromkeys(each.name for each in (*aims, *texts, *known_figures(case.mechanism, REPORTED)))
    figures = named_figures(case.mechanism, names)
    before = {variable.parameter.name: variable.parameter.value for variable in varied}
    own = case.figures_of(before, figures)
    sizes = dict(zip(names, own.tolist(), strict=True))
    constraints = tuple(constraint(each, text, sizes[each.name]) for each, text in texts.items())
    problem = DesignProblem(
        case, aims, 1.0 if is_least else -1.0, varied, constraints, _size(aims[0], *(sizes[aim.name] for aim in aims)),
        tuple(_size(part.figure, part.low, part.high, sizes[part.figure.name]) for part in constraints),
    )  # fmt: skip
    start = np.clip((np.array(list(before.values())) - problem.low) / problem.width, 0.0, 1.0)
    _check_depends(problem, start)
    result = search(problem, start, announce, everywhere=everywhere)
    end = _feasible_end(problem, result)
    exact = problem.numbers(end.place)
    after = round_lengths(problem, end.place, multiple) if multiple else exact
    values = np.array([own, *(case.figures_of(numbers, figures) for numbers in (after, exact))])
    return Optimum(problem, result, end, before, after, figures, values[:2], step, values[2])


def _check_figures(aims: Sequence[NamedFigure], keep: Sequence[NamedFigure], typed: str, *, is_least: bool) -> None:
    """Raise LinkproofError for figures, aims or kept, that cannot be optimised or constrained.

    These are the largest and the range of a transmission angle; and several aims, but for peaks or maxima to minimise
    and minima to maximise. ``typed`` is the aim as it was typed.
    """
    for figure in (*aims, *keep):
        if figure.figure.signal.startswith("transmission_angle:") and figure.figure.reduction in KINKED:
            raise LinkproofError(f"{figure.name}: expected .min, the least transmission angle, which can be optimised "
                                 "and kept; its largest is mostly 90°, in a kink")  # fmt: skip
    if len(aims) > 1 and aims[0].figure.reduction not in (OF_HIGHEST if is_least else (Reduction.MIN,)):
        names = ", ".join(aim.name for aim in aims)
        raise LinkproofError(f"expected one figure, got {typed}, which stands for {names}; choose one of them")


def _size(figure: NamedFigure, *values: float) -> float:
    """The scale of a figure, SI: the largest magnitude of its finite ``values``, at least a millionth of its unit."""
    return max(1e-6 * figure.unit.size, *(abs(value) for value in values if math.isfinite(value)), 0.0)


def _check_depends(problem: DesignProblem, start: Array) -> None:
    """Raise LinkproofError where the aim depends on none of the numbers, or hardly, for bounds too close together.

    It is looked at in the design at ``start`` (variables,); one that does not assemble passes.
    """
    try:
        model = problem.linearise(start, problem.windows(start))
    except AssemblyError:
        return
    slopes = np.abs(model.aim[:, 1:])
    if np.any(slopes > ALLOWED_EXCESS):
        return
    names = ", ".join(variable.parameter.name for variable in problem.variables)
    aim = ", ".join(figure.name for figure in problem.aims)
    sizes = np.maximum(np.abs(problem.low), np.abs(problem.low + problem.width))
    if np.any(slopes * sizes / problem.width > ALLOWED_EXCESS):
        raise LinkproofError(
            f"--over {names}: the bounds are so close together that {aim} hardly changes between them; set them "
            "farther apart"
        )
    raise LinkproofError(f"expected a figure that depends on {names}, got {aim}, which does not; choose others")


def _feasible_end(problem: DesignProblem, result: Search) -> End:
    """The best end of a search; raises LinkproofError where no design assembles or meets the constraints."""
    best = result.best
    if best is None:
        raise LinkproofError(
            f"expected designs that can be assembled at every angle, got none of {result.sampled + 1} within "
            "the bounds; choose others"
        )
    if best.is_feasible:
        return best
    values = problem.case.figures_of(problem.numbers(best.place), problem.figures)[len(problem.aims) :]
    worst, value, _ = max(
        zip(problem.constraints, values, problem.constraint_sizes, strict=True),
        key=lambda row: float(row[0].violation(row[1])) / row[2],
    )
    unit = f" {worst.figure.unit.name}".rstrip()
    raise LinkproofError(
        f"expected a design with {worst.figure.name} {worst.words}{unit}, got none within the bounds; the nearest "
        f"found has {float(value) / worst.figure.unit.size:.6g}{unit}: widen --over or --keep"
    )
