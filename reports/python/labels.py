"""Signals by their names as labelled arrays: signals of one kind are a variable over parts and components."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
import xarray
from markupsafe import escape
from numpy.typing import NDArray

from analytic import signals
from analytic.description.linkage import Linkage
from comparisons.datasheet.curves import TIME
from comparisons.judging.records import Record
from reports.document.terminal import Printed, Printout, rendered

if TYPE_CHECKING:
    import pandas


Array = NDArray[np.float64]

GROUP: Final = "transmission_angle"
# Of a kind of signal the dimension of its parts; a shaking force has none.
DIMENSIONS: Final = {"point": "point", "link": "link", "joint_force": "joint", GROUP: "group"}
# Of a kind's components the variable that each belongs to.
VARIABLES: Final[Mapping[str, Mapping[str, str]]] = {
    "point": {
        **{"x": "point_position", "y": "point_position", "vx": "point_velocity", "vy": "point_velocity"},
        **{"ax": "point_acceleration", "ay": "point_acceleration"},
    },
    "link": {"angle": "link_angle", "omega": "link_omega", "alpha": "link_alpha"},
    "joint_force": {"x": "joint_force", "y": "joint_force", "magnitude": "joint_force_magnitude"},
    "shaking_force": {"x": "shaking_force", "y": "shaking_force", "magnitude": "shaking_force_magnitude"},
}


class Label(NamedTuple):
    """The place of a signal: its variable, the dimension and name of its part, its component; "" if there is none."""

    variable: str
    dimension: str = ""
    part: str = ""
    component: str = ""


def label(name: str) -> Label:
    """The place of a signal in a dataset, from its name."""
    kind, _, rest = name.partition(":")
    if kind == GROUP:
        return Label(kind, DIMENSIONS[kind], rest)
    if kind not in VARIABLES:
        return Label(name)
    part, _, component = rest.rpartition(":")
    axis = component[-1] if component[-1] in "xy" else ""
    return Label(VARIABLES[kind][component], DIMENSIONS.get(kind, ""), part, axis)


def unit(name: str, linkage: Linkage) -> str:
    """SI unit of a signal or quantity."""
    return "s" if name == TIME else signals.unit(name, linkage)


def labelled(linkage: Linkage, axis: str, values: Mapping[str, Array], about: Mapping[str, str]) -> xarray.Dataset:
    """Signals (n,) by name over the signal ``axis``, with units, mechanism and further facts in the attributes."""
    variables: dict[str, dict[Label, str]] = {}
    for name in values:
        variables.setdefault(label(name).variable, {})[label(name)] = name
    arrays: dict[str, xarray.Variable] = {}
    coordinates: dict[str, list[str]] = {}
    for variable, names in variables.items():
        first = next(iter(names))
        sides = {
            first.dimension: list(dict.fromkeys(entry.part for entry in names)),
            "component": list(dict.fromkeys(entry.component for entry in names)),
        }
        sides = {side: places for side, places in sides.items() if places != [""]}
        shape = [*map(len, sides.values()), -1]
        stacked = np.stack([values[name] for name in names.values()]).reshape(shape)
        units = {"units": unit(names[first], linkage)}
        arrays[variable] = xarray.Variable((*sides, axis), stacked, units)
        coordinates |= sides
    beside = {name: arrays.pop(name) for name in (TIME, "phi") if name in arrays}
    attributes = {"mechanism": linkage.name, "variant": linkage.variant, **about}
    return xarray.Dataset(arrays, coords={**beside, **coordinates}, attrs=attributes)


# Results of functions, printed as their commands print them: a line, all text, a notebook's cell, a table.


class PrintedResult(ABC):
    """A result with the output of its command."""

    @abstractmethod
    def _printout(self) -> Printout:
        """The output of the command."""

    @abstractmethod
    def _rows(self) -> Sequence[Any]:
        """Dataclasses, one for each row of the table."""

    def _sentence(self) -> Printed:
        """The outcome in a sentence."""
        return self._printout().closing[-1]

    def __repr__(self) -> str:
        """A line: the kind of result and the outcome."""
        return f"<{type(self).__name__}: {rendered(self._sentence()).strip()}>"

    def __str__(self) -> str:
        """The output of the command."""
        printed = self._printout()
        return rendered(*printed.tables, *printed.closing).strip("\n")

    def _repr_html_(self) -> str:
        return f"<pre>{escape(str(self))}</pre>"

    def to_pandas(self) -> pandas.DataFrame:
        """A row for every record, verdict or finding, a column for each of its fields."""
        import pandas  # noqa: PLC0415  half a second that results alone do not pay

        return pandas.DataFrame([asdict(row) for row in self._rows()])


def failed_rows(records: Iterable[Record]) -> list[str]:
    """A line for each record, with its outcome and the reason: what ``check`` of a result raises."""
    return [
        f"{record.mechanism} ({record.variant}), {record.regime}, {record.engine} {record.setting}, {record.quantity}: "
        f"{record.outcome}, {record.detail}"
        for record in records
    ]
