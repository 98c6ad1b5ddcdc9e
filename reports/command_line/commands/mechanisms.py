"""``linkproof list``: the linkages that are known by name, and what can be asked and varied of one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

import numpy as np

from analytic.description.changes import SPEED
from analytic.description.linkage import Linkage
from analytic.description.loading import catalogue, literature, load
from analytic.description.written import finite, in_unit
from analytic.designs.figures import figure_names
from comparisons.designs.parameters import named_figures, parameters, speed_unit
from reports.command_line.destination import Destination
from reports.document.numbers import ABSENT, printed
from reports.document.parts import Paragraph, Table
from reports.mechanism import terminal
from reports.requests.designs_options import SteadyOptions

SHELVES: Final = {
    "catalogue": "The catalogue, taken where nothing is named",
    "literature": "Linkages of the literature, taken where they are named",
}


def list_names(name: str | None, destination: Destination) -> None:
    """Print the linkages shelf by shelf, or of one the figures and numbers of its designs."""
    if name is None:
        _list_mechanisms(destination)
    else:
        _list_figures_and_numbers(load(name), destination)


def _list_figures_and_numbers(linkage: Linkage, destination: Destination) -> None:
    """Print every figure of a design under the default motion, extremes refined, and every number, in file units.

    A number has the digits that give its value back.
    """
    from reports.requests.case import steady_case  # noqa: PLC0415 - for this list alone

    mechanism, motion, conditions = steady_case(linkage, SteadyOptions())
    every = named_figures(mechanism, figure_names(mechanism))
    speed = {SPEED: np.array([abs(motion.speed)])}
    values = motion.figures(mechanism, speed, [figure.figure for figure in every])[:, 0].tolist()
    figures = [
        {"name": each.name, "units": each.unit.name, "value": finite(float(f"{value / each.unit.size:.15g}"))}
        for each, value in zip(every, values, strict=True)
    ]
    numbers = [
        {"name": each.name, "units": each.unit.name, "value": in_unit(each.value, each.unit.size)}
        for each in parameters(linkage).values()
    ]
    beside = f"speed, {speed_unit(linkage).name}, may be varied too, and tolerances be of a point's length and angle"
    destination.print(
        Paragraph(conditions, colour="bold"),
        "",
        _values_table("figure", figures, lambda value: ABSENT if value is None else printed(value)),
        "",
        _values_table("number", numbers, lambda value: repr(value).removesuffix(".0")),
        "",
        beside,
    )
    about = {"mechanism": linkage.name, "variant": linkage.variant, "conditions": conditions}
    destination.write_json({**about, "figures": figures, "numbers": numbers})


def _values_table(what: str, rows: Sequence[Mapping[str, Any]], written: Callable[[Any], str]) -> Table:
    cells = [(row["name"], row["units"], written(row["value"])) for row in rows]
    return Table("", (what, "unit", "value"), cells, "llr")


def _list_mechanisms(destination: Destination) -> None:
    """Print or write the suite's linkages, shelf by shelf."""
    names = (catalogue(), literature())
    shelves = {shelf: [load(name) for name in shelf_names] for shelf, shelf_names in zip(SHELVES, names, strict=True)}
    destination.print(*terminal.catalogue({SHELVES[shelf]: linkages for shelf, linkages in shelves.items()}))
    destination.write_json({"records": [_linkage_entry(each, shelf) for shelf in shelves for each in shelves[shelf]]})


def _linkage_entry(linkage: Linkage, shelf: str) -> dict[str, object]:
    facts = {"title": linkage.title, "source": linkage.source, "variants": list(linkage.variants)}
    return {"mechanism": linkage.name, "shelf": shelf, **facts}
