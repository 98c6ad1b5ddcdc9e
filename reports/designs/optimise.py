"""An optimum in the units of the linkage's file: tables and remarks, JSON, labelled arrays, the new file, a picture."""

from __future__ import annotations

import math
import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from analytic import signals
from analytic.description.changes import SPEED
from analytic.description.written import change, file_unit, finite
from analytic.designs.derivatives import is_exact
from analytic.errors import printable
from analytic.signals import MAGNITUDE
from comparisons.designer.linkage_check import warnings
from comparisons.designer.optimisation import Optimum
from comparisons.designer.parameters import design_file
from comparisons.designer.searches import Search
from reports.document.numbers import figure, steady_error
from reports.document.parts import Paragraph, Table
from reports.document.study import PICTURES, Content, Study
from reports.document.terminal import Printed, Printout

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

DIGITS: Final = 6
ROUNDED: Final = 1e-8  # share of its size by which a constrained figure may be off
SETTLED: Final = 1e-4  # a residual that a local optimum stays below


@dataclass(frozen=True, repr=False)
class Optimisation(Study):
    """The best design of a linkage, in the units of its file.

    ``conditions`` are those of the motion in words, ``command`` repeats the search.
    """

    suffixes: ClassVar = (".toml", ".json", *PICTURES)
    best: Optimum
    conditions: str
    command: str
    check_options: tuple[str, ...] = ()
    """The words by which ``compare`` checks the new file under the same motion."""

    @property
    def warnings(self) -> Sequence[str]:
        """Warnings about the best design and about the file; [] without any."""
        return [*self.best.warnings, *warnings(self.best.problem.case.linkage)]

    @property
    def toml(self) -> str:
        """The text of the linkage file of the new design; raises AssemblyError for one without a sketch."""
        return design_file(self.best.problem.case.mechanism, self.best.written)

    @cached_property
    def dataset(self) -> xarray.Dataset:
        """Numbers and figures over ``design``, before and after, with their units.

        The attributes have the ``toml`` of the new design's file, the ``method`` and its cost, and the ``residual``, 0
        at a local optimum. Raises AssemblyError as ``toml`` does.
        """
        import xarray as xr  # noqa: PLC0415 - half a second that tables save

        best, saved = self.best, self.to_dict()
        numbers = {}
        for variable in best.problem.variables:
            name, unit = variable.parameter.name, variable.parameter.unit
            ends = {"units": unit.name, "low": variable.low / unit.size, "high": variable.high / unit.size}
            numbers[name] = ("design", [side[name] / unit.size for side in (best.before, best.after)], ends)
        figures = {
            figure.name: ("design", best.values[:, column] / figure.unit.size, {"units": figure.unit.name})
            for column, figure in enumerate(best.figures)
        }
        about = {name: saved[name] for name in ("mechanism", "variant", "conditions", "command")}
        cost = {name: value for name, value in saved["search"].items() if name != "ends"}
        attributes = {**about, **cost, "toml": self.toml}
        return xr.Dataset({**numbers, **figures}, {"design": ["before", "after"]}, attributes)

    def printout(self) -> Printout:
        """The printed optimum: numbers and figures before and after, and how the search went."""
        heading = Paragraph(f"{_aim(self.best)}; {self.conditions}", colour="bold")
        tables: list[Printed] = [heading, "", _numbers(self.best), "", _figures(self.best), "", *_remarks(self.best)]
        return Printout(tables, self._speed_note())

    def brief(self) -> Sequence[Printed]:
        """The outcome in one sentence, as the only member: the aim before and after, and the numbers that give it."""
        best, unit = self.best, self.best.problem.aims[0].unit
        numbers = (
            f"{part.name} {figure(best.after[part.name] / part.unit.size, DIGITS)} {part.unit.name}".rstrip()
            for part in (variable.parameter for variable in best.problem.variables)
        )
        ends = " to ".join(figure(best.aim(values) / unit.size, DIGITS) for values in best.values)
        return [f"{_aim(best)}: from {ends} {unit.name} at {', '.join(numbers)}".replace("  ", " ")]

    def _speed_note(self) -> Sequence[str]:
        """A remark on the best speed, which the new file cannot hold, as the only member.

        () if the speed is not varied.
        """
        if SPEED not in self.best.after:
            return ()
        unit = self.best.problem.case.linkage.phi.speed_unit
        speed = float(f"{self.best.after[SPEED] / unit.size:.15g}")
        return [f"It is the best design at {abs(speed):.6g} {unit.name}: a linkage file has no speed."]

    def to_dict(self) -> Mapping[str, Any]:
        """Numbers, figures and search, JSON-ready: SI, angles in rad, None for numbers that are not finite."""
        best, problem = self.best, self.best.problem
        numbers = [
            {"name": name, "low": variable.low, "high": variable.high, "before": best.before[name],
             "after": best.after[name], "written": best.written[name], "bound": best.bound(variable) or None}
            for variable, name in ((variable, variable.parameter.name) for variable in problem.variables)
        ]  # fmt: skip
        figures = [
            {"name": entry.name, "before": finite(before), "after": finite(after), "change": finite(share),
             "at_open_end": entry.name in best.at_open_end.names}
            for entry, before, after, share in zip(
                best.figures, *best.values.tolist(), best.change.tolist(), strict=True
            )
        ]  # fmt: skip
        kept = [
            {"name": constraint.figure.name, "low": finite(constraint.low), "high": finite(constraint.high)}
            for constraint in problem.constraints
        ]
        return {
            "command": self.command,
            "mechanism": problem.case.linkage.name,
            "variant": problem.case.linkage.variant,
            "conditions": self.conditions,
            "aim": {_aim_word(best): [named_figure.name for named_figure in problem.aims]},
            "kept": kept,
            "numbers": numbers,
            "rounded_to": best.step or None,
            "figures": figures,
            "search": self._search(),
            "warnings": best.warnings,
        }

    def _search(self) -> dict[str, Any]:
        """The method, its cost and the ends of the search, each None where a start led nowhere; JSON-ready, SI."""
        best, problem, search = self.best, self.best.problem, self.best.search
        ends = [
            end and {"numbers": problem.numbers(end.place), "aim": problem.sign * end.aim * problem.aim_size,
                     "is_kept": end.is_feasible}
            for end in search.ends
        ]  # fmt: skip
        return {
            "method": search.method,
            "derivatives": "exact" if is_exact(problem.case.mechanism) else "differences",
            "angles": len(problem.maxima.grid),
            "designs_with_derivatives": search.descent.gradients,
            "designs_sampled": search.sampled,
            "residual": search.residual,
            "nothing_to_vary": best.is_fixed,
            "ends": ends,
        }

    def to_pandas(self) -> Any:  # noqa: ANN401 - a DataFrame
        """A DataFrame of numbers and figures in the file's units, with a row before and a row after.

        Raises AssemblyError as ``toml`` does.
        """
        return self.dataset.to_dataframe().reset_index()

    def plot(self) -> Figure:
        """A figure of the signals before and after, nine at most."""
        return _before_after_figure(self.best, self.conditions)

    def content(self, suffix: str, **form: Any) -> Content:  # noqa: ANN401
        """The content of a file with this suffix: for .toml the text of the new linkage file, else picture or JSON.

        Raises AssemblyError as ``toml`` does.
        """
        return self.toml if suffix == ".toml" else super().content(suffix, **form)

    def hint(self, saved: Sequence[Path]) -> str:
        """A sentence with the command by which an engine checks the new design.

        How to write its file comes first if no .toml is among the files ``saved``.
        """
        file = next((str(file) for file in saved if file.suffix.lower() == ".toml"), None)
        first = "" if file else "--save best.toml writes the new file; "
        command = shlex.join(["linkproof", "compare", file or "best.toml", *self.check_options])
        return f"To check it in an engine: {first}{command}"


def _aim(optimum: Optimum) -> str:
    """The aim of the search in words: "least" or "largest", and the figure's name.

    Of several figures it is "least largest of" them, or "largest least of".
    """
    names, least = ", ".join(named_figure.name for named_figure in optimum.problem.aims), optimum.problem.sign > 0.0
    of_many = f"{'largest' if least else 'least'} of " if len(optimum.problem.aims) > 1 else ""
    return f"{'least' if least else 'largest'} {of_many}{names}"


def _aim_word(optimum: Optimum) -> str:
    """The participle for the aim: "minimised" or "maximised"."""
    return "minimised" if optimum.problem.sign > 0.0 else "maximised"


def _numbers(optimum: Optimum) -> Table:
    """The table of varied numbers: bounds, values before and after in the file's unit, change, a remark."""
    rows = []
    for variable in optimum.problem.variables:
        name, unit = variable.parameter.name, variable.parameter.unit
        before, after = optimum.before[name], optimum.after[name]
        words = [f"at its {at} bound"] if (at := optimum.bound(variable)) else []
        words += [] if variable.low <= before <= variable.high else ["the file's value is out of the bounds"]
        cells = [figure(value / unit.size, DIGITS) for value in (variable.low, variable.high, before, after)]
        rows.append((name, unit.name, *cells, _percent(_relative(before, after)), "; ".join(words)))
    return Table("", ("number", "unit", "low", "high", "before", "after", "change", ""), rows, "llrrrrrl")


def _figures(optimum: Optimum) -> Table:
    """The table of figures: values before and after in the file's unit, change, and whether aim or constraint."""
    kept = {constraint.figure.name: constraint for constraint in optimum.problem.constraints}
    aims = {named_figure.name for named_figure in optimum.problem.aims}
    rows = []
    for entry, before, after, share in zip(optimum.figures, *optimum.values, optimum.change, strict=True):
        words = [_aim_word(optimum)] if entry.name in aims else []
        words += [f"kept {kept[entry.name].words}"] if entry.name in kept else []
        cells = (figure(value / entry.unit.size, DIGITS) for value in (before, after))
        rows.append((entry.name, entry.unit.name, *cells, _percent(float(share)), "; ".join(words)))
    return Table("", ("figure", "unit", "before", "after", "change", ""), rows, "llrrrl")


def _relative(before: float, after: float) -> float:
    """The change over the size of the value before; NaN from zero."""
    return (after - before) / abs(before) if before else math.nan


def _percent(share: float) -> str:
    """A share in per cent, with its sign, as text; "" if it is not finite."""
    return change(share) if math.isfinite(share) else ""


def _remarks(optimum: Optimum) -> Iterator[Printed]:
    """Yield remarks on how the search went: method, optimality, other ends, rounding."""
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
    """Yield sentences on how near to an optimum the search came, and on why it stopped if that is not near."""
    yield (
        f"Optimality (KKT residual, a share of the aim over the whole of the bounds): {steady_error(search.residual)}; "
        "0 is an exact optimum."
    )
    if search.residual > SETTLED:
        why = "beyond it designs cannot be assembled" if search.descent.beyond else "a figure may have a kink there"
        yield f"The search stopped before reaching a smooth optimum: {why}."


def _rounding(optimum: Optimum) -> str:
    """A sentence on the loss by lengths in whole steps, and on the constraints that they violate; needs a step."""
    problem = optimum.problem
    before, after = (problem.sign * optimum.aim(values) for values in (optimum.exact, optimum.values[1]))
    after_of = dict(zip((each.name for each in optimum.figures), optimum.values[1], strict=True))
    missed = [
        f"{constraint.figure.name} by {figure(by / constraint.figure.unit.size)} {constraint.figure.unit.name}".rstrip()
        for constraint, size in zip(problem.constraints, problem.constraint_sizes, strict=True)
        if (by := float(constraint.violation(after_of[constraint.figure.name]))) > ROUNDED * size
    ]
    kept = ", and the held figures stay within their ranges" if problem.constraints else ""
    words = f"; it misses {', '.join(missed)}" if missed else kept
    cost = _percent(_relative(before, after))
    return f"Rounded: lengths are multiples of {optimum.step}, which costs {cost} of the aim{words}."


def _starts(optimum: Optimum) -> str:
    """A sentence on where the searches ended: how many here, at other optima and at no feasible design."""
    search, feasible = optimum.search, [end for end in optimum.search.elsewhere if end.is_feasible]
    here = sum(end is not None for end in search.ends) - len(search.elsewhere)
    sentence = f"Starts: {len(search.ends)}; {here} ended at this optimum"
    if feasible:
        worse = [(end.aim - optimum.end.aim) / abs(optimum.end.aim or 1.0) for end in feasible]
        sentence += f", {len(feasible)} at others, worse by {_percent(min(worse))} to {_percent(max(worse))}"
    failed = len(search.ends) - here - len(feasible)
    return f"{sentence}{f', {failed} at no design that keeps what is held' if failed else ''}."


# Curves of a linkage before and after its numbers were changed, with their peaks.


MOST: Final = 9  # panels of the picture
PANEL, FRAME = 1.9, 1.2  # in, height of a panel, of the words above and below


def _before_after_figure(optimum: Optimum, conditions: str) -> Figure:
    """A figure with a panel per signal, the drive's torque first, its peaks before and after marked.

    There are nine panels at most; aim and ``conditions`` stand above.
    """
    from reports.charts import draw  # noqa: PLC0415 - a table needs no matplotlib

    curves = optimum.curves()
    names = sorted(curves, key=lambda name: name != "Mkr")
    more = [f"The first {MOST} of {len(names)} signals are drawn."] if len(names) > MOST else []
    linkage, maxima = optimum.problem.case.linkage, optimum.problem.maxima
    places = maxima.grid / linkage.phi.unit.size
    looks = {"before": (draw.MUTED, "--"), "after": (draw.PALETTE[0], "-")}

    def place(figure_: Figure) -> None:
        """Draw a panel for each signal into a figure: its curve before and after, the peaks marked."""
        host = draw.head(figure_, [_aim(optimum), conditions, *more])
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
