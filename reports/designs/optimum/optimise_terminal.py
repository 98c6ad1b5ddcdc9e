"""An optimum for a terminal and as JSON: numbers and figures before and after, and what the search cost."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, Final

import numpy as np

from analytic.designs.derivatives import is_exact
from analytic.written import change, finite
from comparisons.designs.optimum.optimisation import Optimum
from comparisons.designs.optimum.problem import KeptFigure
from comparisons.designs.optimum.searches import Search
from reports.document.numbers import figure, steady_error
from reports.document.parts import Paragraph, Table
from reports.document.terminal import Printed

DIGITS: Final = 6
ROUNDED: Final = 1e-8  # share of its size by which a kept figure may be off
SETTLED: Final = 1e-4  # a residual that a local optimum stays below


def printed(found: Optimum, conditions: str) -> list[Printed]:
    """The tables and the lines beneath."""
    return [
        Paragraph(f"{aim(found)}; {conditions}", colour="bold"),
        "",
        _numbers(found),
        "",
        _figures(found),
        "",
        *_remarks(found),
    ]


def aim(found: Optimum) -> str:
    """What was looked for, in words."""
    names, least = ", ".join(one.name for one in found.problem.aims), found.problem.sign > 0.0
    of_many = f"{'largest' if least else 'least'} of " if len(found.problem.aims) > 1 else ""
    return f"{'least' if least else 'largest'} {of_many}{names}"


def _numbers(found: Optimum) -> Table:
    rows = []
    for one in found.problem.variables:
        name, size = one.parameter.name, one.parameter.unit.size
        at = found.bound(one)
        outside = "" if one.low <= found.before[name] <= one.high else "the file's value is out of the bounds"
        told = "; ".join(filter(None, (f"at its {at} bound" if at else "", outside)))
        values = (one.low, one.high, found.before[name], found.after[name])
        cells = [figure(value / size, DIGITS) for value in values]
        rows.append((name, one.parameter.unit.name, *cells, _percent(_relative(*values[2:])), told))
    return Table("", ("number", "unit", "low", "high", "before", "after", "change", ""), rows, "llrrrrrl")


def _figures(found: Optimum) -> Table:
    kept = {one.figure.name: one for one in found.problem.kept}
    aims = {one.name for one in found.problem.aims}
    rows = []
    for one, before, after, share in zip(found.figures, *found.values, found.change, strict=True):
        told = [aim_word(found)] if one.name in aims else []
        told += [f"kept {_range(kept[one.name])}"] if one.name in kept else []
        cells = (figure(value / one.unit.size, DIGITS) for value in (before, after))
        rows.append((one.name, one.unit.name, *cells, _percent(float(share)), "; ".join(told)))
    return Table("", ("figure", "unit", "before", "after", "change", ""), rows, "llrrrl")


def closing(found: Optimum) -> str:
    """The outcome in one sentence: the aim before and after, and the numbers that give it."""
    sign, many = found.problem.sign, len(found.problem.aims)
    before, after = (sign * max((sign * values[:many]).tolist()) for values in found.values)
    unit = found.problem.aims[0].unit
    numbers = (
        f"{one.parameter.name} {figure(found.after[one.parameter.name] / one.parameter.unit.size, DIGITS)} "
        f"{one.parameter.unit.name}".rstrip()
        for one in found.problem.variables
    )
    ends = " to ".join(figure(value / unit.size, DIGITS) for value in (before, after))
    return f"{aim(found)}: from {ends} {unit.name} at {', '.join(numbers)}".replace("  ", " ")


def aim_word(found: Optimum) -> str:
    """What was done with the aim."""
    return "minimised" if found.problem.sign > 0.0 else "maximised"


def _range(one: KeptFigure) -> str:
    low, high = (figure(end / one.figure.unit.size, DIGITS) for end in (one.low, one.high))
    if one.is_equal:
        return f"at {low}"
    return " ".join([*([f"from {low}"] if math.isfinite(one.low) else []),
                     *([f"to {high}"] if math.isfinite(one.high) else [])])  # fmt: skip


def _relative(before: float, after: float) -> float:
    return (after - before) / abs(before) if before else math.nan


def _percent(share: float) -> str:
    return change(share) if math.isfinite(share) else ""


def _remarks(found: Optimum) -> Iterator[Printed]:
    """How the search went."""
    search, problem = found.search, found.problem
    way = "exact derivatives" if is_exact(problem.mechanism) else "differences"
    grid = len(problem.tops.grid)
    sampled = f", {search.counter.sampled} sampled designs" if search.counter.sampled else ""
    yield (
        f"Method: {search.method}, {way}, extremes refined. Evaluated: {search.counter.gradients} designs with "
        f"derivatives at {grid} angles each{sampled}."
    )
    if found.is_fixed:
        names = ", ".join(one.parameter.name for one in problem.variables)
        kept = ", ".join(one.figure.name for one in problem.kept if one.is_equal)
        yield f"Nothing is left to vary: {kept} alone determines {names}. Vary more numbers, or hold a range, LOW:HIGH."
    else:
        yield from _optimality(search)
    if len(search.ends) > 1:
        yield _starts(found)
    if found.step:
        yield _rounding(found)


def _optimality(search: Search) -> Iterator[str]:
    """How near to an optimum the search came."""
    yield (
        f"Remaining possible improvement (KKT residual): {steady_error(search.residual)}, as a share of the aim over "
        "the whole of the bounds."
    )
    if search.residual > SETTLED:
        why = "beyond it designs cannot be assembled" if search.counter.beyond else "a figure may have a kink there"
        yield f"This is no smooth local optimum: the search could go no further, {why}."


def _rounding(found: Optimum) -> str:
    """What whole steps cost: the aim, and what is not kept for them."""
    many = len(found.problem.aims)
    before, after = (max((found.problem.sign * values[:many]).tolist()) for values in (found.exact, found.values[1]))
    cost = change((after - before) / abs(before)) if before else ""
    after_of = dict(zip((one.name for one in found.figures), found.values[1].tolist(), strict=True))
    missed = [
        f"{one.figure.name} by {figure(by / one.figure.unit.size)} {one.figure.unit.name}".rstrip()
        for one, size in zip(found.problem.kept, found.problem.kept_sizes, strict=True)
        if (by := float(one.missed(np.asarray(after_of[one.figure.name])))) > ROUNDED * size
    ]
    kept = (
        f"; it misses {', '.join(missed)}"
        if missed
        else ", and the held figures stay within their ranges" * bool(found.problem.kept)
    )
    return f"Rounded: lengths are multiples of {found.step}, which costs {cost} of the aim{kept}."


def _starts(found: Optimum) -> str:
    """Where the searches ended."""
    ends = [one for one in found.search.ends if one is not None]
    elsewhere = found.search.elsewhere
    feasible = [one for one in elsewhere if one.is_feasible]
    sentence = f"Starts: {len(found.search.ends)}; {len(ends) - len(elsewhere)} ended at this optimum"
    if feasible:
        worse = [(one.aim - found.end.aim) / abs(found.end.aim or 1.0) for one in feasible]
        sentence += f", {len(feasible)} at others, worse by {_percent(min(worse))} to {_percent(max(worse))}"
    if len(elsewhere) > len(feasible):
        sentence += f", {len(elsewhere) - len(feasible)} where a held figure is outside its range"
    if len(ends) < len(found.search.ends):
        sentence += f", {len(found.search.ends) - len(ends)} could not be assembled"
    return f"{sentence}."


def document(found: Optimum, command: str, conditions: str) -> dict[str, Any]:
    """The same as plain data; SI, angles in rad, nothing in place of what is not finite."""
    problem, search = found.problem, found.search
    numbers = [
        {"name": one.parameter.name, "low": one.low, "high": one.high, "before": found.before[one.parameter.name],
         "after": found.after[one.parameter.name], "bound": found.bound(one) or None}
        for one in problem.variables
    ]  # fmt: skip
    figures = [
        {"name": one.name, "before": finite(before), "after": finite(after), "change": finite(share)}
        for one, before, after, share in zip(found.figures, *found.values.tolist(), found.change.tolist(), strict=True)
    ]
    kept = [{"name": one.figure.name, "low": finite(one.low), "high": finite(one.high)} for one in problem.kept]
    ends = [
        one and {"numbers": problem.numbers(one.place), "aim": problem.sign * one.aim * problem.aim_size,
                 "is_kept": one.is_feasible}
        for one in search.ends
    ]  # fmt: skip
    return {
        "command": command,
        "mechanism": problem.mechanism.linkage.name,
        "variant": problem.mechanism.linkage.variant,
        "conditions": conditions,
        "aim": {aim_word(found): [one.name for one in problem.aims]},
        "kept": kept,
        "numbers": numbers,
        "rounded_to": found.step or None,
        "figures": figures,
        "search": {
            "method": search.method,
            "derivatives": "exact" if is_exact(problem.mechanism) else "differences",
            "angles": len(problem.tops.grid),
            "designs_with_derivatives": search.counter.gradients,
            "designs_sampled": search.counter.sampled,
            "residual": search.residual,
            "nothing_to_vary": found.is_fixed,
            "ends": ends,
        },
    }
