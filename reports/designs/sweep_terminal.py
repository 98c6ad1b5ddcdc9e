"""A sweep in the file's units: its summary for a terminal and as JSON, and all of its designs as CSV and netCDF."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from analytic.description.written import csv_text, finite
from comparisons.designer.sweep import SweepRequest, SweepStudy
from reports.document.numbers import figure, grouped, printed
from reports.document.parts import Paragraph, Table
from reports.document.terminal import Printed

if TYPE_CHECKING:
    import xarray

LEAST: Final = "least"
ROWS: Final = 10_000  # of a CSV file, made into text at once
SLASH: Final = "∕"  # in a netCDF file instead of "/", which parts its groups


def parts(study: SweepStudy) -> list[Printed]:
    """The printed parts: conditions, number of designs, a table of the figures."""
    request = study.request
    shown = [parameter.shown.replace(" [", " ").removesuffix("]") for parameter in request.space.parameters]
    rows = [
        (named_figure.shown if what == LEAST else "", what, figure(value, 6), *map(printed, where))
        for number, named_figure in enumerate(request.figures)
        for what, value, where in _ends(study, number)
    ]
    table = Table("", ["figure", "design", "value", *shown], rows, "llr")
    return [Paragraph(request.case.conditions, colour="bold"), sentence(study), "", table]


def sentence(study: SweepStudy) -> str:
    """A sentence on the number of designs, how many assemble, and their range."""
    space, assembled = study.request.space, int(np.count_nonzero(study.assembles))
    count = grouped(space.count)
    if not space.is_list and len(space.shape) > 1:
        count = f"{count} ({' × '.join(map(grouped, space.shape))})"
    if assembled == space.count:
        return (
            f"{count} designs, all of which assemble at every angle"
            if space.count > 1
            else ("1 design, which assembles at every angle")
        )
    share = math.floor(1e3 * assembled / space.count) / 10.0
    where = ", ".join(
        f"{parameter.name} from {printed(least)} to {printed(most)} {parameter.unit.name}".strip()
        for parameter, (least, most) in zip(space.parameters, study.reach.tolist(), strict=True)
    )
    return f"{count} designs, of which {grouped(assembled)} ({share:g} %) assemble at every angle: {where}"


def document(study: SweepStudy) -> dict[str, Any]:
    """The JSON document of a sweep's summary; what is not finite is null."""
    request, space = study.request, study.request.space
    open_ends = request.at_open_end
    names = [parameter.name for parameter in space.parameters]
    return {
        "mechanism": request.case.linkage.name,
        "variant": request.case.linkage.variant,
        "conditions": request.case.conditions,
        "designs": space.count,
        "assembled": int(np.count_nonzero(study.assembles)),
        "parameters": {
            parameter.name: {"units": parameter.unit.name, "least": low, "largest": high, "assembles": reach}
            for parameter, (low, high), reach in zip(
                space.parameters, space.ends.tolist(), study.reach.tolist(), strict=True
            )
        },
        "figures": {
            named_figure.name: {
                "units": named_figure.unit.name, "at_open_end": named_figure.name in open_ends.names,
            } | {
                what.removeprefix("file's "): {"value": finite(value), "at": dict(zip(names, where, strict=False))}
                for what, value, where in _ends(study, number)
            }
            for number, named_figure in enumerate(request.figures)
        },
        "warnings": request.warnings,
    }  # fmt: skip


def own_parameters(request: SweepRequest) -> dict[str, float]:
    """The parameters of the file's own design, in its units."""
    return {
        parameter.name: request.numbers_of_file[parameter.name] / parameter.unit.size
        for parameter in request.space.parameters
    }


def _ends(study: SweepStudy, figure: int) -> Iterator[tuple[str, float, list[float]]]:
    """The least value of a figure, the file's own and the largest, each with its design's parameters."""
    yield LEAST, *_extreme(study, figure, -1.0)
    yield "file's own", float(study.own[figure]), [*own_parameters(study.request).values()]
    yield "largest", *_extreme(study, figure, 1.0)


def _extreme(study: SweepStudy, figure: int, way: float) -> tuple[float, list[float]]:
    """Value and parameters of the design with the largest (``way`` 1) or least (-1) figure; nan without one."""
    design = study.extreme(figure, way)
    if design is None:
        return math.nan, []
    return float(study.values[figure, design]), study.request.space.file_values(design, design + 1)[:, 0].tolist()


def write_csv(study: SweepStudy, path: Path) -> None:
    """Write the study as CSV: a line per design, a column per parameter and figure, headed by name and unit.

    By hand, for ``to_csv`` of pandas takes three times as long, which is longer than the sweep itself.
    """
    space = study.request.space
    head = [parameter.shown for parameter in space.parameters] + [figure.shown for figure in study.request.figures]
    table = np.concatenate([space.file_values(0, space.count), study.values]).T + 0.0  # no -0
    row = ",".join(["%.15g"] * len(head)) + "\n"
    with path.open("w", encoding="utf-8", newline="") as stream:
        csv.writer(stream, lineterminator="\n").writerow(map(csv_text, head))
        for start in range(0, len(table), ROWS):
            rows = table[start : start + ROWS]
            stream.write(row * len(rows) % tuple(rows.ravel().tolist()))


def netcdf(dataset: xarray.Dataset) -> bytes:
    """The dataset as a netCDF file."""
    names = {name: str(name).replace("/", SLASH) for name in dataset.variables if "/" in str(name)}
    return bytes(dataset.rename(names).to_netcdf(engine="scipy"))
