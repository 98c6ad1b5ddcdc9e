"""A sweep in the file's units: its summary for a terminal and as JSON, and all of its designs as CSV."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from analytic.written import csv_text, finite
from comparisons.designs.saved_sweep import SavedSweep
from comparisons.designs.simulated_designs import EngineOverDesigns, TellingNumber
from comparisons.designs.space import Grid
from comparisons.designs.sweep import NO_DESIGN, RankedDesign, Summary, SweepRequest
from comparisons.judging.records import Verdict
from reports.document.chart import Array
from reports.document.numbers import error, figure, grouped, printed
from reports.document.parts import Paragraph, Table
from reports.document.terminal import Printed, Printout
from reports.records.views import share

LEAST: Final = "least"
ROWS: Final = 10_000  # of a CSV file, made into text at once


@dataclass(frozen=True)
class SweepSummary:
    """The result of a request; ``own`` are the figures (figures,) of the file's own design."""

    request: SweepRequest
    own: Array
    summary: Summary
    conditions: str

    @property
    def own_parameters(self) -> dict[str, float]:
        """The parameters of the file's own design."""
        return {
            parameter.name: self.request.numbers_of_file[parameter.name] / parameter.unit.size
            for parameter in self.request.space.parameters
        }

    @property
    def parts(self) -> list[Printed]:
        """Conditions, number of designs, a table of the figures."""
        shown = [parameter.shown.replace(" [", " ").removesuffix("]") for parameter in self.request.space.parameters]
        rows = [
            (named_figure.shown if what == LEAST else "", what, figure(value, 6), *map(printed, where))
            for number, named_figure in enumerate(self.request.figures)
            for what, value, where in self._ends(number)
        ]
        table = Table("", ["figure", "design", "value", *shown], rows, "llr")
        return [Paragraph(self.conditions, colour="bold"), self.sentence, "", table]

    @property
    def sentence(self) -> str:
        """How many designs there are, how many of them assemble, and between which values."""
        space, result = self.request.space, self.summary
        count = grouped(space.count)
        if isinstance(space, Grid) and len(space.shape) > 1:
            count = f"{count} ({' × '.join(map(grouped, space.shape))})"
        if result.assembled == result.designs:
            return (
                f"{count} designs, all of which assemble at every angle"
                if space.count > 1
                else ("1 design, which assembles at every angle")
            )
        share = math.floor(1e3 * result.assembled / result.designs) / 10.0
        where = ", ".join(
            f"{parameter.name} from {printed(least)} to {printed(most)} {parameter.unit.name}".strip()
            for parameter, (least, most) in zip(space.parameters, result.reach.tolist(), strict=True)
        )
        return f"{count} designs, of which {grouped(result.assembled)} ({share:g} %) assemble at every angle: {where}"

    @property
    def document(self) -> dict[str, Any]:
        """The JSON document of a sweep's summary; what is not finite is null."""
        space, result = self.request.space, self.summary
        names = [parameter.name for parameter in space.parameters]
        return {
            "mechanism": self.request.linkage.name,
            "variant": self.request.linkage.variant,
            "conditions": self.conditions,
            "designs": result.designs,
            "assembled": result.assembled,
            "parameters": {
                parameter.name: {"units": parameter.unit.name, "least": low, "largest": high, "assembles": reach}
                for parameter, (low, high), reach in zip(
                    space.parameters, space.ends.tolist(), result.reach.tolist(), strict=True
                )
            },
            "figures": {
                named_figure.name: {"units": named_figure.unit.name} | {
                    what.removeprefix("file's "): {"value": finite(value), "at": dict(zip(names, where, strict=False))}
                    for what, value, where in self._ends(number)
                }
                for number, named_figure in enumerate(self.request.figures)
            },
        }  # fmt: skip

    def _ends(self, number: int) -> Iterator[tuple[str, float, list[float]]]:
        """Of a figure the least value, the file's own and the largest, with the parameters of each design."""
        least, largest = self.summary.least[number], self.summary.largest[number]
        yield LEAST, least.value, self._parameter_values(least)
        yield "file's own", float(self.own[number]), [*self.own_parameters.values()]
        yield "largest", largest.value, self._parameter_values(largest)

    def _parameter_values(self, extreme: RankedDesign) -> list[float]:
        """The parameters of a ranked design in the file's units; empty if no design has been ranked."""
        if extreme.design == NO_DESIGN:
            return []
        values: list[float] = self.request.space.file_values(extreme.design, extreme.design + 1)[:, 0].tolist()
        return values


def csv_rows(saved: SavedSweep) -> Iterator[str]:
    """A line per design, block by block, a column per parameter and figure, headed by name and unit."""
    request, head = saved.request, io.StringIO()
    columns = [
        *(parameter.shown for parameter in request.space.parameters),
        *(figure.shown for figure in request.figures),
    ]
    csv.writer(head, lineterminator="\n").writerow(map(csv_text, columns))
    yield head.getvalue()
    row = ",".join(["%.15g"] * len(columns)) + "\n"
    for number in range(len(request.blocks)):
        values = (
            np.concatenate([request.space.file_values(*request.block(number)), saved.read(number)]).T + 0.0
        )  # no -0
        for start in range(0, len(values), ROWS):
            rows = values[start : start + ROWS]
            yield row * len(rows) % tuple(rows.ravel().tolist())


# How far engines may be trusted over the designs of a sweep, for a terminal.


def printout(engines: Sequence[EngineOverDesigns], seed: int) -> Printout:
    """In sentences: the designs on which each engine is within its limits, and the number that separates the others."""
    count = len(engines[0].designs) if engines else 0
    head = Paragraph(f"Engines over {count} of these designs (seed {seed})", colour="bold")
    return Printout([head], [sentence for engine in engines for sentence in _sentences(engine)])


def _sentences(designs: EngineOverDesigns) -> Iterator[str]:
    """On how many designs an engine is accurate, what separates the others, and its worst design."""
    within = designs.judged - len(designs.failing)
    bound = (
        "" if designs.bound is None else f"; with 95 % certainty fewer than {designs.bound:.0%} of such designs are not"
    )
    yield f"{designs.engine}: within limits on {within} of {designs.judged} designs judged{bound}"
    if designs.not_judged:
        yield f"{designs.engine}: {len(designs.not_judged)} designs were not judged, and have not passed"
    if designs.telling is not None:
        yield f"{designs.engine}: {_where(designs.telling)}"
    elif designs.failing and within:
        yield f"{designs.engine}: no number separates the {len(designs.failing)} failing designs from the others"
    if (worst := designs.worst) is not None:
        lost = worst.error_max is None or worst.outcome not in (Verdict.PASSED, Verdict.OVER_LIMIT)
        words = worst.detail if lost else f"{worst.quantity} has an error of {error(share(worst))} of its limit"
        yield f"{designs.engine}: worst in {worst.mechanism}: {words}"


def _where(number: TellingNumber) -> str:
    """The sentence on the number that separates failing designs from the others."""
    name, _, unit = number.name.removesuffix("]").partition(" [")
    value = f"{figure(number.value)} {unit}".rstrip()
    side = f"{value} or less" if number.below else f"above {value}"
    return (
        f"fails where {name} is {side}: there lie {number.failing[0]} of {number.failing[1]} failing designs and "
        f"{number.others[0]} of {number.others[1]} others (as likely by chance: {number.chance:.1%})"
    )
