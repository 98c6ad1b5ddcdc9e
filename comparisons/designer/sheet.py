"""The sheet of a designer's results as plain data: what terminal, pages, pictures and files show.

Values are in SI; what a reader sees of them, the unit of the file, the axis, the place on it and what is zero but for
rounding, is answered here alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Final, Literal

import numpy as np

from analytic.description.crank_motion import CrankMotion
from analytic.description.law import FULL_TURN
from analytic.description.linkage import Linkage
from analytic.description.units import FileUnit
from analytic.description.written import file_unit
from analytic.numerics.arrays import Array, Integers
from analytic.numerics.refine import in_turn
from analytic.signals import MAGNITUDE
from comparisons.designer.curves import DIRECTION, TIME, SignalFigure
from comparisons.designer.figures import NEGLIGIBLE, PEAK_SPEED, PEAK_TORQUE, TABLES

ROUNDING: Final = 1e-6  # of a turn
NOWHERE: Final[Mapping[str, Any]] = {"time": None, "phi": None, "at_open_end": False}  # of a figure without a place
JOINT: Final = "joint_force:"


ByName = Mapping[str, Array]  # curves or vectors by their names


@dataclass(frozen=True)
class Positions:
    """Poses of the bodies at n instants, evenly spaced over one turn of φ, or over a motion of less than a turn.

    ``over`` is the quantity of ``axis``: "phi", rad, or "time", s, (n,). ``bodies`` has of each link, by name,
    the origin of its frame x, y, m, and its angle, rad, unwrapped, (3, n). ``carriers`` names the link that carries
    each point of a slot. ``closed``: the last instant is the first again.
    """

    over: str
    axis: Array
    bodies: ByName
    carriers: Mapping[str, str]
    closed: bool


@dataclass(frozen=True)
class ThreadSheet:
    """The thread in the linkage's plane: its contour (stops, 2), m, at the reference angle, rad.

    ``stops`` names the guides and eyes along the contour; ``paths`` has of each eye its way over a turn, m, (2, n).
    """

    contour: Array
    stops: tuple[str, ...]
    paths: ByName
    reference_angle: float


@dataclass(frozen=True)
class Released:
    """A released crank: ``facts``, which the macro ``released_sheet`` puts in words, and its motion.

    ``motion`` has "time", s, "phi", "omega", "epsilon" (n,), ``last_turn`` the last three over the last whole turn,
    empty without a whole turn.
    """

    facts: Mapping[str, Any]
    motion: ByName
    last_turn: ByName


@dataclass(frozen=True)
class Sheet:
    """Everything computed of a linkage under one motion, SI, angles in rad.

    ``values`` are the signals by name over the whole motion, nan where undefined: at every instant of its grid (n,), or
    on a page at as many as a curve needs, φ ascending where that is the axis. ``units`` has the SI unit of each.
    ``chosen`` are those at chosen instants. ``peaks`` has of each signal the largest magnitude, of a transmission angle
    the least, ``figures`` the tables of key figures, ``remarks`` the sentences under them. ``facts`` are those of the
    mechanism alone, as in ``linkproof check --json``. ``required`` is the feed of the thread at the crank angles "phi",
    rad, of its file, "required" there and "actual", m; empty without a required feed.

    The rest is what a page shows besides. ``shares`` has Jeq by Assur group ("groups") and by link ("links") over the
    instants of ``values``, kg m². ``published`` are the printed figures of all variants, ``released`` by regime the
    facts of a released crank. ``missing`` has the reason of each part that cannot be derived.
    ``motion`` is the crank's where it is prescribed. ``open_end_warning`` is the sentence on peaks at an open end of
    the motion, "" without any.
    """

    linkage: Linkage
    facts: Mapping[str, Any]
    conditions: str = ""
    axis: Literal["phi", "time"] = "phi"
    units: Mapping[str, str] = field(default_factory=dict)
    values: ByName = field(default_factory=dict)
    peaks: Mapping[str, SignalFigure] = field(default_factory=dict)
    figures: Mapping[str, tuple[SignalFigure, ...]] = field(default_factory=lambda: dict.fromkeys(TABLES, ()))
    remarks: tuple[str, ...] = ()
    chosen: ByName | None = None
    positions: Positions | None = None
    motion: CrankMotion | None = None
    shares: Mapping[str, ByName] = field(default_factory=dict)
    thread: ThreadSheet | None = None
    required: ByName = field(default_factory=dict)
    published: tuple[Mapping[str, Any], ...] = ()
    released: Mapping[str, Released] = field(default_factory=dict)
    missing: Mapping[str, str] = field(default_factory=dict)
    open_end_warning: str = ""

    @property
    def name(self) -> str:
        """The name of the sheet's linkage."""
        return self.linkage.name

    @property
    def variant(self) -> str:
        """The variant of the sheet's linkage."""
        return self.linkage.variant

    @property
    def is_linear(self) -> bool:
        """Whether the drive moves along a line."""
        return self.linkage.is_linear

    @property
    def table(self) -> Mapping[str, Array]:
        """The signals by name, SI, at the instants of tables and files: the chosen ones, or all."""
        return self.values if self.chosen is None else self.chosen

    @property
    def columns(self) -> dict[str, Array]:
        """Every signal of the table, (n,), in the file's units, the axis first, by name and unit: "Mkr [N*m]"."""
        names = sorted(self.table, key=lambda name: name != self.axis)  # stable: the rest keeps its order
        units = {name: self.unit(name) for name in names}
        return {f"{name} [{unit.name}]": self.table[name] / unit.size + 0.0 for name, unit in units.items()}

    def unit(self, name: str) -> FileUnit:
        """The file's unit of a signal; raises KeyError for one that the sheet does not have."""
        return self.file_unit_of(self.units[name])

    def file_unit_of(self, si: str) -> FileUnit:
        """The file's unit in place of an SI unit."""
        return file_unit(si, self.linkage)

    def unit_of(self, figure: SignalFigure) -> FileUnit:
        """The unit of a key figure: the file's, and rpm of a crank's speed."""
        return self.linkage.phi.speed_unit if figure.signal == "omega" else self.file_unit_of(figure.unit)

    def shown_value(self, figure: SignalFigure) -> float:
        """The value of a key figure in its unit, see ``unit_of``; nan where it has no bound."""
        value = np.nan if figure.value is None else figure.value
        return self.without_rounding(figure.signal, value) / self.unit_of(figure).size

    def without_rounding(self, name: str, value: float) -> float:
        """A value of a signal, SI; 0 where it is no more than rounding beside the signals of its kind and unit.

        Nan stays.
        """
        return 0.0 if abs(value) <= NEGLIGIBLE * self.scale(name) else value

    def scale(self, name: str) -> float:
        """The largest magnitude, SI, of all signals of this signal's kind and unit, and of the terms that it sums up.

        The kind is the name up to its colon; 0 for one that the sheet does not have.
        """
        own = self._scales.get((name.partition(":")[0], self.units.get(name, "")), 0.0)
        return max(own, self._ingredients.get(name, 0.0))

    @cached_property
    def _ingredients(self) -> dict[str, float]:
        """The size, SI, of the terms that Mkr, Peq, shaking_moment and S sum up, by signal.

        Their rounding stays where they cancel.
        """
        extent = self.linkage.extent()
        torque = self._scales.get(("joint_force", "N"), 0.0) * (1.0 if self.is_linear else extent)
        speed = self._scales.get(("omega", self.units.get("omega", "")), 0.0)
        return {"Mkr": torque, "Peq": torque * speed, "shaking_moment": torque, "S": extent}

    def without_rounded_figures(self) -> Sheet:
        """A copy with 0 for each number and curve that is only rounding; a peak of such a curve has no place.

        Where that is the torque's curve, it has no figures of power, no speed at the peak torque, and a remark on it.
        """
        idle = {
            name
            for name, values in self.values.items()
            if np.any(values) and np.all(np.abs(values) <= NEGLIGIBLE * self.scale(name))
        }

        def cleaned(figure: SignalFigure) -> SignalFigure:
            """A copy of a key figure: 0 if its value is only rounding, without a place if its signal is.

            The direction of a force that is only rounding has neither a value nor a place.
            """
            if figure.signal.endswith(DIRECTION):
                no_force = figure.signal.replace(DIRECTION, MAGNITUDE) in idle
                return replace(figure, value=None, time=None, phi=None) if no_force else figure
            value = None if figure.value is None else self.without_rounding(figure.signal, figure.value) + 0.0
            has_place = figure.signal not in idle or figure.what == PEAK_SPEED
            return replace(figure, value=value, **({} if has_place else NOWHERE))

        def zeroed(values: ByName) -> ByName:
            """Curves by name, those that are only rounding replaced by zeros."""
            return {name: np.zeros_like(curve) if name in idle else curve for name, curve in values.items()}

        figures = {name: tuple(map(cleaned, rows)) for name, rows in self.figures.items()}
        if "Mkr" in idle:  # nor is there a power, or a speed at the peak of the torque
            figures["drive"] = tuple(
                replace(row, value=None, **NOWHERE) if row.signal == "omega" and row.what in PEAK_TORQUE else row
                for row in figures["drive"]
                if "power" not in row.what
            )
        return replace(
            self,
            values=zeroed(self.values),
            chosen=None if self.chosen is None else zeroed(self.chosen),
            peaks={name: cleaned(peak) for name, peak in self.peaks.items()},
            figures=figures,
            remarks=(*self.remarks, *(["The drive's torque is 0 at every instant."] if "Mkr" in idle else [])),
        )

    @cached_property
    def _scales(self) -> dict[tuple[str, str], float]:
        """The largest magnitude, SI, of all signals, by kind and unit; the kind is the name up to its colon."""
        scales: dict[tuple[str, str], float] = {}
        for name, values in self.values.items():
            size = float(np.max(np.abs(values), where=np.isfinite(values), initial=0.0))
            kind = (name.partition(":")[0], self.units[name])
            scales[kind] = max(size, scales.get(kind, 0.0))
        return scales

    def place_of(self, figure: SignalFigure) -> float | None:
        """The place of a key figure on the axis: φ, rad or m, or the time, s; None without a place."""
        return figure.time if self.axis == TIME else figure.phi

    @property
    def joints(self) -> list[str]:
        """Joints with a force, by name, that of the largest force first; [] without forces."""
        signals = [name for name in self.values if name.startswith(JOINT) and name.endswith(MAGNITUDE)]
        signals.sort(key=lambda name: -(self.peaks[name].value or 0.0))
        return [name.removeprefix(JOINT).removesuffix(MAGNITUDE) for name in signals]

    @cached_property
    def _swept_angle(self) -> float:
        """How far the crank turns over the motion, rad; 0 of a drive along a line."""
        return 0.0 if self.is_linear else float(np.ptp(self.values["phi"]))

    @property
    def is_turn(self) -> bool:
        """Whether the axis shows exactly one turn of φ."""
        return self.axis == "phi" and abs(self._swept_angle - FULL_TURN) <= ROUNDING * FULL_TURN

    def angle(self, phi: float) -> float:
        """φ, rad or m, in the file's unit, within a turn where the motion is that long."""
        is_long = self._swept_angle >= FULL_TURN * (1.0 - NEGLIGIBLE)
        return float(in_turn(phi) if is_long else phi) / self.unit("phi").size

    @property
    def axis_unit(self) -> FileUnit:
        """The unit of the axis: degrees of a turn, else the file's of φ or the time."""
        return FileUnit("°", FULL_TURN / 360.0) if self.is_turn else self.unit(self.axis)

    @property
    def symbol(self) -> str:
        """The symbol of the axis: "t", "φ", or "travel" for that of a linear drive."""
        return "t" if self.axis == TIME else "travel" if self.is_linear else "φ"

    @cached_property
    def _order(self) -> Integers:
        """Order (n,) that sorts samples by the axis; of a turn without the last sample, which is the first again."""
        along = self.values[self.axis]
        return np.argsort(along[:-1] % FULL_TURN if self.is_turn else along, kind="stable")

    def sorted_by_axis(self, values: Array) -> Array:
        """Samples (n,) in the order of the ascending axis, so that a curve runs from left to right.

        Over a turn the first one is repeated at the end.
        """
        ordered = values[self._order]
        return np.append(ordered, ordered[0]) if self.is_turn else ordered

    @cached_property
    def x(self) -> Array:
        """The abscissas (n,) of every curve, ascending, in ``axis_unit``."""
        axis = self.values[self.axis]
        if not self.is_turn:
            return axis[self._order] / self.axis_unit.size
        ordered = (axis[:-1] % FULL_TURN)[self._order]
        return np.append(ordered, ordered[0] + FULL_TURN) / self.axis_unit.size

    def y(self, name: str) -> Array:
        """The ordinates (n,) of a signal's curve, in ``unit``, in the order of ``x``."""
        return self.sorted_by_axis(self.values[name]) / self.unit(name).size
