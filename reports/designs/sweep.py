"""A sweep in the units of the linkage's file: its summary for a terminal and as JSON; every design as CSV or netCDF."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from analytic.description.written import csv_text, finite
from analytic.errors import LinkproofError
from comparisons.designer.linkage_check import warnings
from comparisons.designer.sweep import SweepStudy, reason_not_assembled
from reports.document.numbers import figure, grouped, printed
from reports.document.parts import Paragraph, Table
from reports.document.study import PICTURES, Content, Study
from reports.document.terminal import Printed, Printout

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

LEAST: Final = "least"
ROWS: Final = 10_000  # of a CSV file, made into text at once
SLASH: Final = "∕"  # in a netCDF file instead of "/", which parts its groups


@dataclass(frozen=True, repr=False)
class DesignSweep(Study):
    """The figures of many designs, in the units of the file; ``command`` repeats the sweep, "" if none can."""

    suffixes: ClassVar = (".csv", ".json", ".nc", *PICTURES)
    study: SweepStudy
    command: str

    @cached_property
    def dataset(self) -> xarray.Dataset:
        """A variable per figure over the parameters, or over ``design``, in the file's units; NaN if not assembled."""
        return self.study.dataset.assign_attrs(command=self.command)

    @property
    def warnings(self) -> Sequence[str]:
        """Warnings about the request and about the file; [] without any."""
        return [*self.study.request.warnings, *warnings(self.study.request.case.linkage)]

    def check_content(self) -> None:
        """Raise LinkproofError if no design assembles, with the reason for the first."""
        request = self.study.request
        if not np.any(self.study.assembles):
            raise LinkproofError(
                f"expected designs that assemble, got none of {request.space.count}, for "
                f"{reason_not_assembled(request)}; vary other ranges"
            )

    def printout(self) -> Printout:
        """The printed sweep: conditions, number of designs, a table of the figures."""
        request = self.study.request
        shown = [parameter.shown.replace(" [", " ").removesuffix("]") for parameter in request.space.parameters]
        rows = [
            (named_figure.shown if what == LEAST else "", what, figure(value, 6), *map(printed, where))
            for number, named_figure in enumerate(request.figures)
            for what, value, where in _ends(self.study, number)
        ]
        table = Table("", ["figure", "design", "value", *shown], rows, "llr")
        return Printout([Paragraph(request.case.conditions, colour="bold"), self.sentence(), "", table], ())

    def brief(self) -> Sequence[Printed]:
        """The sentence on the number of designs, as the only member."""
        return [self.sentence()]

    def sentence(self) -> Printed:
        """A sentence on the number of designs, how many assemble and, if not all, between which parameters."""
        space, assembled = self.study.request.space, int(np.count_nonzero(self.study.assembles))
        count = grouped(space.count)
        if not space.is_list and len(space.shape) > 1:
            count = f"{count} ({' × '.join(map(grouped, space.shape))})"
        if assembled == space.count:
            all_of_them = "designs, all of which assemble" if space.count > 1 else "design, which assembles"
            return f"{count} {all_of_them} at every angle"
        share = math.floor(1e3 * assembled / space.count) / 10.0
        where = ", ".join(
            f"{parameter.name} from {printed(least)} to {printed(most)} {parameter.unit.name}".strip()
            for parameter, (least, most) in zip(space.parameters, self.study.reach.tolist(), strict=True)
        )
        return f"{count} designs, of which {grouped(assembled)} ({share:g} %) assemble at every angle: {where}"

    def to_dict(self) -> Mapping[str, Any]:
        """The summary, without single designs, JSON-ready, in the file's units; None for what is not finite."""
        request, space = self.study.request, self.study.request.space
        open_ends, names = request.at_open_end, [parameter.name for parameter in space.parameters]
        ends = zip(space.parameters, space.ends.tolist(), self.study.reach.tolist(), strict=True)
        return {
            "mechanism": request.case.linkage.name,
            "variant": request.case.linkage.variant,
            "conditions": request.case.conditions,
            "designs": space.count,
            "assembled": int(np.count_nonzero(self.study.assembles)),
            "parameters": {
                parameter.name: {"units": parameter.unit.name, "least": low, "largest": high, "assembles": reach}
                for parameter, (low, high), reach in ends
            },
            "figures": {
                named_figure.name: {
                    "units": named_figure.unit.name, "at_open_end": named_figure.name in open_ends.names,
                } | {
                    what.removeprefix("file's "): {"value": finite(value), "at": dict(zip(names, where, strict=False))}
                    for what, value, where in _ends(self.study, number)
                }
                for number, named_figure in enumerate(request.figures)
            },
            "warnings": request.warnings,
        }  # fmt: skip

    def to_pandas(self) -> Any:  # noqa: ANN401 - a DataFrame
        """A DataFrame with a row for every design in the file's units, nan where it does not assemble."""
        return self.dataset.to_dataframe().reset_index()

    def plot(self) -> Figure:
        """A figure: curves over one number, maps over two, dots over each of more; nine figures at most."""
        from reports.designs.sweep_picture import sweep_figure  # noqa: PLC0415 - a second that other calls save

        study = self.study
        ends = [study.extreme(figure, way) for figure in range(len(study.values)) for way in (-1.0, 1.0)]
        return sweep_figure(study.dataset, _own(study), {design for design in ends if design is not None})

    def content(self, suffix: str, **form: Any) -> Content:  # noqa: ANN401
        """The content of a file with this suffix: CSV, a function that writes it to a path, netCDF, picture or JSON.

        In the names of netCDF's variables ∕ replaces "/".
        """
        if suffix == ".csv":
            return partial(_write_csv, self.study)
        if suffix != ".nc":
            return super().content(suffix, **form)
        names = {name: str(name).replace("/", SLASH) for name in self.dataset.variables if "/" in str(name)}
        return bytes(self.dataset.rename(names).to_netcdf(engine="scipy"))


@dataclass(frozen=True, repr=False)
class LazySweep:
    """A sweep of Dask arrays: its ``dataset`` is computed chunk by chunk when it is asked for."""

    dataset: xarray.Dataset

    def __repr__(self) -> str:
        """One line with the kind of study and the dataset's sizes."""
        return f"<LazySweep: {dict(self.dataset.sizes)}>"


def _own(study: SweepStudy) -> dict[str, float]:
    """The parameters of the file's own design by name, in its units."""
    return {number.name: number.value / number.unit.size for number in study.request.space.parameters}


def _ends(study: SweepStudy, figure: int) -> Iterator[tuple[str, float, list[float]]]:
    """Yield a figure's least value, the file's own and the largest, each as its name, value and design's parameters.

    ``figure`` is its index; values are in the file's units, nan and [] where no design has one.
    """
    yield LEAST, *_extreme(study, figure, -1.0)
    yield "file's own", float(study.own[figure]), [*_own(study).values()]
    yield "largest", *_extreme(study, figure, 1.0)


def _extreme(study: SweepStudy, figure: int, way: float) -> tuple[float, list[float]]:
    """Value and parameters of the design with the largest (``way`` 1) or least (-1) figure; nan and [] without one.

    ``figure`` is its index; both are in the file's units.
    """
    design = study.extreme(figure, way)
    if design is None:
        return math.nan, []
    return float(study.values[figure, design]), study.request.space.file_values(design, design + 1)[:, 0].tolist()


def _write_csv(study: SweepStudy, path: Path) -> None:
    """Write the study to a file as CSV: a line per design, a column per parameter and figure, headed by name and unit.

    Values are in the file's units, nan where a design does not assemble. Raises OSError where it cannot be written. By
    hand, for ``to_csv`` of pandas takes three times as long, which is longer than the sweep itself.
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
