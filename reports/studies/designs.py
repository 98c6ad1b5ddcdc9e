"""Many designs of a linkage: what is printed, drawn, saved, and labelled arrays."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from analytic.description.changes import SPEED
from analytic.errors import LinkproofError
from comparisons.designer.linkage_check import warnings
from comparisons.designer.optimisation import Optimum
from comparisons.designer.parameters import design_file
from comparisons.designer.sweep import SweepStudy, reason_not_assembled
from reports.designs import optimise_terminal, sweep_terminal
from reports.document.study import PICTURES, Content, Study
from reports.document.terminal import Printed, Printout

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class Sweep(Study):
    """The figures of many designs, in the units of the file."""

    suffixes: ClassVar = (".csv", ".json", ".nc", *PICTURES)
    study: SweepStudy
    command: str

    @cached_property
    def dataset(self) -> xarray.Dataset:
        """A variable per figure over the parameters, or over ``design``, in the file's units; NaN if not assembled."""
        return self.study.dataset.assign_attrs(command=self.command)

    @property
    def warnings(self) -> Sequence[str]:
        """Warnings about the request and about the file."""
        return [*self.study.request.warnings, *warnings(self.study.request.case.linkage)]

    def printout(self) -> Printout:
        """The printed sweep: conditions, number of designs, a table of the figures."""
        return Printout(sweep_terminal.parts(self.study), ())

    def check_content(self) -> None:
        """Raise LinkproofError if no design assembles."""
        request = self.study.request
        if not np.any(self.study.assembles):
            raise LinkproofError(
                f"expected designs that assemble, got none of {request.space.count}, for "
                f"{reason_not_assembled(request)}; vary other ranges"
            )

    def brief(self) -> Sequence[Printed]:
        """The parts of a quiet run: how many designs there are, and how many assemble."""
        return [sweep_terminal.sentence(self.study)]

    def to_dict(self) -> Mapping[str, Any]:
        """The summary, JSON-ready; None for a number that is not finite."""
        return sweep_terminal.document(self.study)

    def to_pandas(self) -> Any:  # noqa: ANN401 - a DataFrame
        """A DataFrame with a row for every design."""
        return self.dataset.to_dataframe().reset_index()

    def plot(self) -> Figure:
        """A figure: curves over one number, maps over two, dots over each of more."""
        from reports.designs.sweep_picture import sweep_figure  # noqa: PLC0415 - a second that other calls save

        study = self.study
        ends = [study.extreme(figure, way) for figure in range(len(study.values)) for way in (-1.0, 1.0)]
        always = {design for design in ends if design is not None}
        return sweep_figure(study.dataset, sweep_terminal.own_parameters(study.request), always)

    def content(self, suffix: str, **form: Any) -> Content:  # noqa: ANN401
        """The content of a file with this suffix: CSV, netCDF, a picture or JSON."""
        if suffix == ".csv":
            return partial(sweep_terminal.write_csv, self.study)
        return sweep_terminal.netcdf(self.dataset) if suffix == ".nc" else super().content(suffix, **form)


@dataclass(frozen=True, repr=False)
class LazySweep:
    """A sweep of Dask arrays: its ``dataset`` is computed chunk by chunk when it is asked for."""

    dataset: xarray.Dataset

    def __repr__(self) -> str:
        """One line with the kind of study and the size."""
        return f"<LazySweep: {dict(self.dataset.sizes)}>"


@dataclass(frozen=True, repr=False)
class Optimisation(Study):
    """The best design of a linkage, in the units of its file; ``rpm`` is the speed of the motion."""

    suffixes: ClassVar = (".toml", ".json", *PICTURES)
    best: Optimum
    conditions: str
    command: str
    check_options: tuple[str, ...] = ()
    """The words by which ``compare`` checks the new file under the same motion."""

    @property
    def warnings(self) -> Sequence[str]:
        """Warnings about the search and about the file."""
        return [*self.best.warnings, *warnings(self.best.problem.case.linkage)]

    @property
    def toml(self) -> str:
        """The text of the linkage file of the new design."""
        return design_file(self.best.problem.case.mechanism, self.best.written)

    @cached_property
    def dataset(self) -> xarray.Dataset:
        """Numbers and figures over ``design``, before and after, with their units.

        The attributes have the ``toml`` of the new design's file, the ``method`` and its cost, and the ``residual``, 0
        at a local optimum.
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
        return Printout(optimise_terminal.printed(self.best, self.conditions), self._speed_note())

    def brief(self) -> Sequence[Printed]:
        """The parts of a quiet run: the outcome of the search."""
        return [optimise_terminal.closing(self.best)]

    def _speed_note(self) -> Sequence[str]:
        """A remark on the best speed, which the new file cannot hold; nothing if the speed is not varied."""
        if SPEED not in self.best.after:
            return ()
        unit = self.best.problem.case.linkage.phi.speed_unit
        speed = float(f"{self.best.after[SPEED] / unit.size:.15g}")
        return [f"It is the best design at {abs(speed):.6g} {unit.name}: a linkage file has no speed."]

    def to_dict(self) -> Mapping[str, Any]:
        """Numbers, figures and search, JSON-ready."""
        return optimise_terminal.document(self.best, self.command, self.conditions)

    def to_pandas(self) -> Any:  # noqa: ANN401 - a DataFrame
        """A table of numbers and figures with a row before and a row after."""
        return self.dataset.to_dataframe().reset_index()

    def plot(self) -> Figure:
        """A figure of the signals before and after."""
        return optimise_terminal.before_after_figure(self.best, self.conditions)

    def content(self, suffix: str, **form: Any) -> Content:  # noqa: ANN401
        """The content of a file with this suffix."""
        return self.toml if suffix == ".toml" else super().content(suffix, **form)

    def hint(self, saved: Sequence[Path]) -> str:
        """A sentence with the command by which an engine checks the new design."""
        file = next((str(file) for file in saved if file.suffix.lower() == ".toml"), None)
        first = "" if file else "--save best.toml writes the new file; "
        command = shlex.join(["linkproof", "compare", file or "best.toml", *self.check_options])
        return f"To check it in an engine: {first}{command}"
