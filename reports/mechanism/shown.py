"""A data sheet as its page shows it: in the units of its file, over the crank angle of a turn, a travel or the time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from comparisons.datasheet.sheet import Sheet
from comparisons.datasheet.units import FileUnit, file_unit
from reports.document.chart import Chart, Curve, Panel
from reports.document.numbers import ABSENT, figure, within_turn
from reports.document.parts import PageFigure

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Drawing

Array = NDArray[np.float64]

TURN: Final = 2.0 * np.pi
ROUNDING: Final = 1e-6  # of a turn: what a sheet's digits leave of it
JOINT, MAGNITUDE = "joint_force:", ":magnitude"
NEGLIGIBLE: Final = 1e-9  # share of the largest value of a kind below which a value is zero but for a sheet's digits


@dataclass(frozen=True)
class ShownSheet:
    """Values (n,) in the file's units, in ascending order of the axis."""

    sheet: Sheet

    def figure(self, name: str, caption: str, what: str, drawing: Chart | Callable[[], Drawing]) -> PageFigure:
        """A figure of the mechanism; ``what`` it is stands for it where there are no pictures."""
        is_wide = isinstance(drawing, Chart) and drawing.wide
        return PageFigure(
            name, caption, f"{self.sheet.linkage.title} ({self.sheet.variant}): {what}", drawing, wide=is_wide
        )

    def has(self, name: str) -> bool:
        """Whether the sheet has values of a signal."""
        return name in self.sheet.values

    def unit(self, name: str) -> FileUnit:
        """The file's unit of a signal."""
        return self.own(self.sheet.units[name])

    def own(self, si: str) -> FileUnit:
        """The file's unit for an SI unit, as it is printed: "N mm", "mm/s²"."""
        name, size = file_unit(si, self.sheet.linkage)
        return FileUnit(name.replace("*", " ").replace("^2", "²"), size)

    @cached_property
    def is_turn(self) -> bool:
        """Whether the axis is the crank angle of one turn, which is shown from 0° to 360°."""
        if self.sheet.axis != "phi" or self.sheet.linkage.is_linear:
            return False
        return abs(float(np.ptp(self.sheet.values["phi"])) - TURN) <= ROUNDING * TURN

    @property
    def axis(self) -> FileUnit:
        """The unit of the axis: degrees of a turn, else the file's."""
        return FileUnit("°", TURN / 360.0) if self.is_turn else self.unit(self.sheet.axis)

    @property
    def symbol(self) -> str:
        """The axis in a word: t, φ, or the travel of a drive along a line."""
        return "t" if self.sheet.axis == "time" else "travel" if self.sheet.linkage.is_linear else "φ"

    @property
    def where(self) -> str:
        """Head of a column of places on the axis."""
        return f"at {self.symbol}"

    @property
    def axis_name(self) -> str:
        """The axis in words."""
        if self.sheet.axis == "time":
            return f"time, {self.axis.name}"
        return f"{'travel' if self.sheet.linkage.is_linear else 'crank angle φ'}, {self.axis.name}"

    @cached_property
    def _order(self) -> NDArray[np.intp]:
        """The samples by the axis; of a turn without the last, which is the first again."""
        along = self.sheet.values[self.sheet.axis]
        return np.argsort(along[:-1] % TURN if self.is_turn else along, kind="stable")

    def _in_order(self, values: Array) -> Array:
        ordered = values[self._order]
        return np.append(ordered, ordered[0]) if self.is_turn else ordered

    @cached_property
    def x(self) -> Array:
        """The axis, (n,), in its unit."""
        along = self.sheet.values[self.sheet.axis]
        if not self.is_turn:
            return along[self._order] / self.axis.size
        ordered = (along[:-1] % TURN)[self._order]
        return np.append(ordered, ordered[0] + TURN) / self.axis.size

    def y(self, name: str) -> Array:
        """A signal along the axis, in its unit."""
        return self._in_order(self.sheet.values[name]) / self.unit(name).size

    def shares(self, kind: str) -> dict[str, Array]:
        """The parts of Jeq by name, along the axis, in the file's unit; ``kind`` is "groups" or "links"."""
        size = self.unit("Jeq").size
        return {name: self._in_order(values) / size for name, values in self.sheet.shares.get(kind, {}).items()}

    def vector(self, name: str) -> Array:
        """A force, (2, n), in its unit."""
        return np.stack([self.y(f"{name}:x"), self.y(f"{name}:y")])

    def joints(self) -> list[str]:
        """Joints by name, that of the largest force first."""
        peaks = self.sheet.peaks
        signals = [name for name in self.sheet.values if name.startswith(JOINT) and name.endswith(MAGNITUDE)]
        signals.sort(key=lambda name: -abs(peaks[name]["value"] or 0.0))
        return [name.removeprefix(JOINT).removesuffix(MAGNITUDE) for name in signals]

    def value(self, name: str, value: float | None) -> str:
        """A value of a signal, SI, with the file's unit."""
        if value is None:
            return ABSENT
        unit = self.unit(name)
        told = figure(0.0 if abs(value) <= NEGLIGIBLE * self.scale(name) else value / unit.size)
        return f"{told} {unit.name}".replace("-", "−", 1) if value < 0.0 else f"{told} {unit.name}"

    def scale(self, name: str) -> float:
        """The largest magnitude of a signal, SI."""
        return float(np.nanmax(np.abs(self.sheet.values[name]), initial=0.0))

    def place(self, at: float | None) -> str:
        """Where on the axis: φ, rad, or the time, s."""
        if at is None:
            return ""
        if self.is_turn:
            return within_turn(at / self.axis.size)
        return f"{at / self.axis.size:z.4g} {self.axis.name}".replace("-", "−", 1)

    def peak(self, name: str) -> str:
        """The value of the largest magnitude of a signal, with its unit."""
        return self.value(name, self.sheet.peaks[name]["value"])

    def panel(self, curves: Sequence[Curve], y_label: str, *, is_last: bool = True) -> Panel:
        """Curves over the axis."""
        return Panel(tuple(curves), self.axis_name if is_last else "", y_label, turn=self.is_turn)

    def stacked(self, names: Sequence[str], height: float, *, wide: bool = False) -> Chart:
        """Signals one under the other over the axis, each with its peak marked."""
        panels = []
        for number, name in enumerate(names):
            curves = (Curve(self.x, self.y(name), ink=number), *self._dot(name, number))
            label = f"{'force' if name == 'Mkr' and self.sheet.linkage.is_linear else name}, {self.unit(name).name}"
            panels.append(self.panel(curves, label, is_last=number == len(names) - 1))
        return self.chart(panels, height, wide=wide)

    def _dot(self, name: str, ink: int) -> tuple[Curve, ...]:
        """A mark at the value of the largest magnitude of a signal."""
        peak = self.sheet.peaks[name]
        if peak["value"] is None or peak["at"] is None:
            return ()
        at = peak["at"] % TURN if self.is_turn else peak["at"]
        place, value = np.array([at / self.axis.size]), np.array([peak["value"] / self.unit(name).size])
        return (Curve(place, value, ink=ink, line="", marker="o"),)

    def chart(self, panels: Sequence[Panel], height: float, *, wide: bool = False) -> Chart:
        """Panels one under the other over the sheet's axis, on which a page shows where its mechanism is."""
        return Chart(tuple(panels), height, wide=wide, axis="time" if self.sheet.axis == "time" else "phi")
