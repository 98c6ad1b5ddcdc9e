"""An optimum whose lengths can be made: whole steps between their bounds, the other numbers searched for again."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from analytic.description.changes import with_numbers
from analytic.errors import AssemblyError, LinkproofError
from comparisons.designs.optimum.descent import Descent
from comparisons.designs.optimum.problem import DesignProblem, Variable

NEAR = 1e-9  # of a step: a bound that is a multiple but for rounding


def step_size(variables: Sequence[Variable], text: str) -> float:
    """The step, m, that is typed as ``0.1mm`` or in the file's unit; raises LinkproofError for none."""
    lengths = [variable.parameter for variable in variables if variable.parameter.kind == "length"]
    if not lengths:
        raise LinkproofError("--round: expected a length among the numbers of --over, got none; leave it out")
    step = replace(lengths[0], name="--round").si(text)
    if not step > 0.0:
        raise LinkproofError(f"--round: expected a positive length, got '{text}'; correct it")
    return step


def rounded(problem: DesignProblem, numbers: Mapping[str, float], step: float) -> dict[str, float]:
    """Numbers, SI, of the best design near an optimum's whose lengths are multiples of a step, m.

    One length after the other takes the better of its two neighbours, and the numbers that are left are searched for
    anew, so that the constraints hold as long as numbers are left. Raises LinkproofError for bounds without a multiple.
    """
    best, left = dict(numbers), list(problem.variables)
    for variable in [entry for entry in problem.variables if entry.parameter.kind == "length"]:
        left.remove(variable)
        name, unit = variable.parameter.name, variable.parameter.unit
        below = math.floor(best[name] / step + NEAR)
        near = [
            n * step
            for n in (below, below + 1)
            if variable.low - NEAR * step <= n * step <= variable.high + NEAR * step
        ]
        tried = [_solved(problem, {**best, name: value}, left) for value in near]
        ranked = [(rank, number) for number, (rank, _) in enumerate(tried) if rank is not None]
        if not ranked:
            raise LinkproofError(
                f"--round: expected designs at multiples of {step / unit.size:g} {unit.name} beside {name} "
                f"{best[name] / unit.size:g}, within the bounds, got none; give a finer step or wider bounds"
            )
        best = tried[min(ranked)[1]][1]
    return best


def _solved(
    problem: DesignProblem, numbers: dict[str, float], left: Sequence[Variable]
) -> tuple[tuple[float, float] | None, dict[str, float]]:
    """Numbers with those that are ``left`` searched for anew, and their rank; None where there is no such design."""
    fixed = {
        name: value for name, value in numbers.items() if name not in {variable.parameter.name for variable in left}
    }
    if left:
        mechanism = problem.mechanism.redesigned(with_numbers(problem.mechanism.linkage, fixed))
        rest = replace(problem, mechanism=mechanism, variables=tuple(left))
        start = np.array([numbers[variable.parameter.name] for variable in left])
        end = Descent(rest).run(np.clip((start - rest.low) / rest.width, 0.0, 1.0))
        numbers = numbers if end is None else {**fixed, **rest.numbers(end.place)}
    values = np.array([numbers[variable.parameter.name] for variable in problem.variables])
    try:
        return Descent(problem).end((values - problem.low) / problem.width).rank, numbers
    except AssemblyError:
        return None, numbers
