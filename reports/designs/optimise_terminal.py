"""An optimum for a terminal and as JSON: numbers and figures before and after, and what the search cost."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic import signals
from analytic.description.written import change, file_unit, finite
from analytic.designs.derivatives import is_exact
from analytic.errors import printable
from analytic.signals import MAGNITUDE
from comparisons.designer.optimisation import Optimum
from comparisons.designer.problem import Constraint
from comparisons.designer.searches import Search
from reports.document.numbers import figure, steady_error
from reports.document.parts import Paragraph, Table
from reports.document.terminal import Printed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DIGITS: Final = 6
ROUNDED: Final = 1e-8  # share of its size by which a constrained figure may be off
SETTLED: Final = 1e-4  # a residual that a local optimum stays below


def printed(optimum: Optimum, conditions: str) -> list[Printed]:
    """The tables of numbers and figures and the remarks below."""
    return [
        Paragraph(f"{aim(optimum)}; {conditions}", colour="bold"),
        "",
        _numbers(optimum),
        "",
        _figures(optimum),
        "",
        *_remarks(optimum),
    ]


def aim(optimum: Optimum) -> str:
    """The aim of the search in words."""
    names, least = ", ".join(named_figure.name for named_figure in optimum.problem.aims), optimum.problem.sign > 0.0
    of_many = f"{'largest' if least else 'least'} of " if len(optimum.problem.aims) > 1 else ""
    return f"{'least' if least else 'largest'} {of_many}{names}"


def _numbers(optimum: Optimum) -> Table:
    """The table of varied numbers: bounds, values before and after in the file's unit, change."""
    rows = []
    for variable in optimum.problem.variables:
        name, size = variable.parameter.name, variable.parameter.unit.size
        at = optimum.bound(variable)
        outside = (
            "" if variable.low <= optimum.before[name] <= variable.high else "the file's value is out of the bounds"
        )
        words = "; ".join(filter(None, (f"at its {at} bound" if at else "", outside)))
        values = (variable.low, variable.high, optimum.before[name], optimum.after[name])
        cells = [figure(value / size, DIGITS) for value in values]
        rows.append((name, variable.parameter.unit.name, *cells, _percent(_relative(*values[2:])), words))
    return Table("", ("number", "unit", "low", "high", "before", "after", "change", ""), rows, "llrrrrrl")


def _figures(optimum: Optimum) -> Table:
    """The table of figures: values before and after in the file's unit, change, aim or constraint."""
    figures = {constraint.figure.name: constraint for constraint in optimum.problem.constraints}
    aims = {named_figure.name for named_figure in optimum.problem.aims}
    rows = []
    for entry, before, after, share in zip(optimum.figures, *optimum.values, optimum.change, strict=True):
        sentences = [aim_word(optimum)] if entry.name in aims else []
        sentences += [f"kept {_range(figures[entry.name])}"] if entry.name in figures else []
        cells = (figure(value / entry.unit.size, DIGITS) for value in (before, after))
        rows.append((entry.name, entry.unit.name, *cells, _percent(float(share)), "; ".join(sentences)))
    return Table("", ("figure", "unit", "before", "after", "change", ""), rows, "llrrrl")


def closing(optimum: Optimum) -> str:
    """The outcome in one sentence: the aim before and after, and the numbers that give it."""
    before, after = (_aim_value(optimum, values) for values in optimum.values)
    unit = optimum.problem.aims[0].unit
    numbers = (
        f"{part.name} {figure(optimum.after[part.name] / part.unit.size, DIGITS)} {part.unit.name}".rstrip()
        for part in (variable.parameter for variable in optimum.problem.variables)
    )
    ends = " to ".join(figure(value / unit.size, DIGITS) for value in (before, after))
    return f"{aim(optimum)}: from {ends} {unit.name} at {', '.join(numbers)}".replace("  ", " ")


def _aim_value(optimum: Optimum, values: NDArray[np.float64]) -> float:
    """The value of the aim, SI, among figures (figures,); of several aims the worst one's."""
    sign, many = optimum.problem.sign, len(optimum.problem.aims)
    return float(sign * np.max(sign * values[:many]))


def aim_word(optimum: Optimum) -> str:
    """The participle for the aim: "minimised" or "maximised"."""
    return "minimised" if optimum.problem.sign > 0.0 else "maximised"


def _range(constraint: Constraint) -> str:
    """A constraint in words: at a value, or from and to its bounds, in the file's unit."""
    low, high = (figure(end / constraint.figure.unit.size, DIGITS) for end in (constraint.low, constraint.high))
    if constraint.is_equal:
        return f"at {low}"
    return " ".join([*([f"from {low}"] if math.isfinite(constraint.low) else []),
                     *([f"to {high}"] if math.isfinite(constraint.high) else [])])  # fmt: skip


def _relative(before: float, after: float) -> float:
    """The change over the size of the value before; NaN from zero."""
    return (after - before) / abs(before) if before else math.nan


def _percent(share: float) -> str:
    """A share in per cent; "" if it is not finite."""
    return change(share) if math.isfinite(share) else ""


def _remarks(optimum: Optimum) -> Iterator[Printed]:
    """Remarks on how the search went: method, optimality, rounding, other ends."""
    search, problem = optimum.search, optimum.problem
    way = "exact derivatives" if is_exact(problem.case.mechanism) else "differences"
    grid = len(problem.maxima.grid)
    sampled = f", {search.sampled} sampled designs" if search.sampled else ""
    yield (
        f"Method: {search.method}, {way}, extremes refined. Evaluated: {search.descent.gradients} designs with "
        f"derivatives at {grid} angles each{sampled}."
    )
    if optimum.is_fixed:
        names = ", ".join(variable.parameter.name for variable in problem.variables)
        name = ", ".join(constraint.figure.name for constraint in problem.constraints if constraint.is_equal)
        yield f"Nothing is left to vary: {name} alone determines {names}. Vary more numbers, or hold a range, LOW:HIGH."
    else:
        yield from _optimality(search)
    if len(search.ends) > 1:
        yield _starts(optimum)
    if optimum.step:
        yield _rounding(optimum)


def _optimality(search: Search) -> Iterator[str]:
    """Sentences on how near to an optimum the search came."""
    yield (
        f"Optimality (KKT residual, a share of the aim over the whole of the bounds): {steady_error(search.residual)}; "
        "0 is an exact optimum."
    )
    if search.residual > SETTLED:
        why = "beyond it designs cannot be assembled" if search.descent.beyond else "a figure may have a kink there"
        yield f"The search stopped before reaching a smooth optimum: {why}."


def _rounding(optimum: Optimum) -> str:
    """A sentence on the loss by whole steps and the constraints they violate."""
    sign = optimum.problem.sign
    before, after = (sign * _aim_value(optimum, values) for values in (optimum.exact, optimum.values[1]))
    cost = _percent(_relative(before, after))
    after_of = dict(
        zip((named_figure.name for named_figure in optimum.figures), optimum.values[1].tolist(), strict=True)
    )
    missed = [
        f"{constraint.figure.name} by {figure(by / constraint.figure.unit.size)} {constraint.figure.unit.name}".rstrip()
        for constraint, size in zip(optimum.problem.constraints, optimum.problem.constraint_sizes, strict=True)
        if (by := float(constraint.violation(np.asarray(after_of[constraint.figure.name])))) > ROUNDED * size
    ]
    name = (
        f"; it misses {', '.join(missed)}"
        if missed
        else ", and the held figures stay within their ranges" * bool(optimum.problem.constraints)
    )
    return f"Rounded: lengths are multiples of {optimum.step}, which costs {cost} of the aim{name}."


def _starts(optimum: Optimum) -> str:
    """A sentence on where the searches ended."""
    ends = [end for end in optimum.search.ends if end is not None]
    elsewhere = optimum.search.elsewhere
    feasible = [end for end in elsewhere if end.is_feasible]
    sentence = f"Starts: {len(optimum.search.ends)}; {len(ends) - len(elsewhere)} ended at this optimum"
    if feasible:
        worse = [(end.aim - optimum.end.aim) / abs(optimum.end.aim or 1.0) for end in feasible]
        sentence += f", {len(feasible)} at others, worse by {_percent(min(worse))} to {_percent(max(worse))}"
    if len(elsewhere) > len(feasible):
        sentence += f", {len(elsewhere) - len(feasible)} where a held figure is outside its range"
    if len(ends) < len(optimum.search.ends):
        sentence += f", {len(optimum.search.ends) - len(ends)} could not be assembled"
    return f"{sentence}."


def document(optimum: Optimum, command: str, conditions: str) -> dict[str, Any]:
    """The optimum as JSON-ready data: SI, angles in rad, None for numbers that are not finite."""
    problem, search = optimum.problem, optimum.search
    numbers = [
        {"name": variable.parameter.name, "low": variable.low, "high": variable.high,
         "before": optimum.before[variable.parameter.name], "after": optimum.after[variable.parameter.name],
         "written": optimum.written[variable.parameter.name],
         "bound": optimum.bound(variable) or None}
        for variable in problem.variables
    ]  # fmt: skip
    figures = [
        {"name": entry.name, "before": finite(before), "after": finite(after), "change": finite(share),
         "at_open_end": entry.name in optimum.at_open_end.names}
        for entry, before, after, share in zip(
            optimum.figures, *optimum.values.tolist(), optimum.change.tolist(), strict=True
        )
    ]  # fmt: skip
    tables = [
        {"name": constraint.figure.name, "low": finite(constraint.low), "high": finite(constraint.high)}
        for constraint in problem.constraints
    ]
    ends = [
        end and {"numbers": problem.numbers(end.place), "aim": problem.sign * end.aim * problem.aim_size,
                 "is_kept": end.is_feasible}
        for end in search.ends
    ]  # fmt: skip
    return {
        "command": command,
        "mechanism": problem.case.linkage.name,
        "variant": problem.case.linkage.variant,
        "conditions": conditions,
        "aim": {aim_word(optimum): [named_figure.name for named_figure in problem.aims]},
        "kept": tables,
        "numbers": numbers,
        "rounded_to": optimum.step or None,
        "figures": figures,
        "search": {
            "method": search.method,
            "derivatives": "exact" if is_exact(problem.case.mechanism) else "differences",
            "angles": len(problem.maxima.grid),
            "designs_with_derivatives": search.descent.gradients,
            "designs_sampled": search.sampled,
            "residual": search.residual,
            "nothing_to_vary": optimum.is_fixed,
            "ends": ends,
        },
        "warnings": optimum.warnings,
    }


# Curves of a linkage before and after its numbers were changed, with their peaks.


MOST: Final = 9  # panels of the picture
PANEL, FRAME = 1.9, 1.2  # in, height of a panel, of the words above and below


def before_after_figure(optimum: Optimum, conditions: str) -> Figure:
    """A figure with a panel per signal, the drive's torque first, and its peaks before and after marked."""
    from reports.charts import draw  # noqa: PLC0415 - a table needs no matplotlib

    curves = optimum.curves()
    names = sorted(curves, key=lambda name: name != "Mkr")
    more = [f"The first {MOST} of {len(names)} signals are drawn."] if len(names) > MOST else []
    linkage, maxima = optimum.problem.case.linkage, optimum.problem.maxima
    places = maxima.grid / linkage.phi.unit.size
    looks = {"before": (draw.MUTED, "--"), "after": (draw.PALETTE[0], "-")}

    def place(figure_: Figure) -> None:
        """Draw a panel for each signal: its curve before and after, the peaks marked."""
        host = draw.head(figure_, [aim(optimum), conditions, *more])
        grid = host.subplots(min(len(names), MOST), sharex=True, squeeze=False)[:, 0]
        for axes, name in zip(grid, names, strict=False):
            unit, peaks = file_unit(signals.unit(name, linkage), linkage), []
            for values, (word, (colour, line)) in zip(curves[name] / unit.size, looks.items(), strict=True):
                peak = np.argmax(np.where(np.isfinite(values), np.abs(values), -1.0))
                axes.plot(places, values, line, color=colour, label=word)
                axes.plot(places[peak], values[peak], "o", color=colour)
                peaks.append(figure(values[peak]))
            title = f"{name.removesuffix(MAGNITUDE)}: peak {' → '.join(peaks)} {unit.name}".rstrip()
            axes.set_title(printable(title))
            draw.finish(axes, "", printable(unit.name), turn=maxima.case.is_full_turn)
        grid[-1].set_xlabel(linkage.phi.axis)
        host.legend(*grid[0].get_legend_handles_labels(), loc="outside upper left", ncols=2)

    return draw.drawn(draw.FULL_WIDTH, PANEL * min(len(names), MOST) + FRAME, place)
