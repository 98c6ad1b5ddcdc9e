"""The results of one linkage: what is printed, drawn and saved, and labelled arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from analytic.errors import UnknownNameError, symbol
from comparisons.designer.building import page_sheet, sheet
from comparisons.designer.sheet import Sheet
from comparisons.motion.case import Case
from reports.designs import results_terminal
from reports.document.study import PICTURES, Content, Study
from reports.document.terminal import Printed, Printout
from reports.mechanism.shown import warning_texts

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class Results(Study):
    """Every signal of a linkage over a motion of its crank; ``chosen`` are the instants (n,), s, of the tables.

    ``dataset`` is in SI, what is printed in the units of the file. ``save`` takes the ``decimal`` mark of a .csv, and
    the one ``figure`` of a picture.
    """

    suffixes: ClassVar = (".csv", ".json", ".xlsx", *PICTURES, ".dxf")
    case: Case
    chosen: NDArray[np.float64] | None = None

    @cached_property
    def sheet(self) -> Sheet:
        """The sheet with signals and key figures; raises LinkproofError where the linkage cannot make the motion."""
        return sheet(self.case, self.chosen)

    @cached_property
    def _whole_sheet(self) -> Sheet:
        """The sheet with the peaks of all signals, also of those without a table."""
        return sheet(self.case, self.chosen, every_peak=True)

    @cached_property
    def dataset(self) -> xarray.Dataset:
        """The signals in SI over ``phi``, rad, where the crank turns at one speed, else ``time``, s.

        The other stands beside it. Points, links, joints and groups are dimensions of their own, as are the components
        x and y of a vector.
        """
        from reports.designs.labels import labelled  # noqa: PLC0415 - half a second that tables save

        about = {"regime": self.case.motion.regime, "conditions": self.sheet.conditions}
        if self.sheet.open_end_warning:
            about["open_ends"] = self.sheet.open_end_warning
        return labelled(self.sheet.linkage, self.sheet.axis, self.sheet.table, about)

    def __getitem__(self, name: str) -> xarray.DataArray:
        """A variable of the dataset by symbol or word (``torque`` for ``Mkr``); raises UnknownNameError."""
        known = self.dataset.variables
        if symbol(name) not in known:
            raise UnknownNameError("signal", name, map(str, known))
        return self.dataset[symbol(name)]

    @property
    def warnings(self) -> Sequence[str]:
        """Warnings about extremes at open ends, and about probable slips of the file; [] without any."""
        return warning_texts(self.sheet)

    def printout(self) -> Printout:
        """The printed tables of key figures, or of every signal at the chosen instants."""
        return Printout(results_terminal.printed(self.sheet), ())

    def sentence(self) -> Printed:
        """The conditions of the motion, in a sentence."""
        return self.sheet.conditions

    def to_dict(self) -> Mapping[str, Any]:
        """The sheet as JSON prints it: SI, angles in rad."""
        return results_terminal.document(self._whole_sheet)

    def json(self) -> str:
        """The JSON text in one line, since its lists are long."""
        return results_terminal.json_text(self._whole_sheet)

    def to_pandas(self) -> Any:  # noqa: ANN401 - a DataFrame
        """A DataFrame with a column per signal, by name and unit of the file, and a row per instant."""
        import pandas as pd  # noqa: PLC0415

        return pd.DataFrame(results_terminal.columns(self.sheet))

    def plot(self, figure: str | None = None) -> Figure:
        """A figure of the scheme and the curves, or of one ``figure``, by name, alone.

        Raises LinkproofError for an unknown one.
        """
        from reports.designs.results_drawing import results_figure  # noqa: PLC0415 - a second that other files save

        return results_figure(page_sheet(self.case), figure)

    def content(self, suffix: str, *, decimal: str = ".", figure: str | None = None) -> Content:
        """The content of a file with this suffix.

        A .csv has the ``decimal`` mark, a picture the one ``figure`` or all.
        """
        if suffix == ".csv":
            return results_terminal.csv_table(self.sheet, decimal)
        if suffix == ".xlsx":
            from reports.designs.results_workbook import workbook  # noqa: PLC0415 - half a second

            return workbook(self.sheet)
        if suffix == ".dxf":
            from reports.designs.results_dxf import dxf  # noqa: PLC0415 - half a second

            result = self.sheet
            assert result.positions is not None
            return dxf(result.linkage, result.positions, None if self.chosen is None else float(result.table["phi"][0]))
        return super().content(suffix, figure=figure) if suffix in PICTURES else self.json()

    def write(self, folder: str | Path) -> Path:
        """Save the case among those of a report's folder and write all its pages; returns the linkage's page."""
        from comparisons.trials.campaign.saved_linkages import save_case  # noqa: PLC0415 - figures cost a second
        from comparisons.trials.runs.files import claim  # noqa: PLC0415
        from reports.mechanism.page import file_of  # noqa: PLC0415
        from reports.site import write_site  # noqa: PLC0415

        out = Path(folder)
        _claimed = claim(out)  # until the pages are written
        save_case(out, self.case)
        index, page = write_site(out, processes=0), out / file_of(self.case.mechanism.linkage)
        return page if page.is_file() else index  # the only one
