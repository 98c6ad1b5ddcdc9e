"""``linkproof list``, ``show`` and ``thread``: read linkages, print or write their facts."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from analytic.description.changes import SPEED
from analytic.description.file_units import FileUnit
from analytic.description.linkage import Linkage
from analytic.description.loading import catalogue, literature, load
from analytic.designs.figures import figure_names
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from analytic.motion.thread_feed import compare_feed, read_required_feed
from analytic.written import finite
from comparisons.datasheet.mechanism_summary import portrait, thread_facts
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


def list_names(figures: str | None, numbers: str | None, destination: Destination) -> None:
    """Print or write the figures of a design, or the numbers of a file, by name; the linkages where neither is wanted.

    Figures are those under the default motion of ``linkproof sweep``, with refined extremes.
    """
    if figures is not None and numbers is not None:
        raise LinkproofError("--figures and --numbers make a list each: give one of them")
    if figures is not None:
        _list_figures(figures, destination)
    elif numbers is not None:
        linkage = load(numbers)
        rows = [(parameter.name, parameter.unit, parameter.value) for parameter in parameters(linkage).values()]
        beside = (
            f"speed, {speed_unit(linkage).name}, may be varied too, and tolerances be of a point's length and angle"
        )
        words = f"{linkage.name} ({linkage.variant}); {beside}"
        _print_values("number", linkage, rows, words, destination)
    else:
        list_mechanisms(destination)


def _list_figures(name: str, destination: Destination) -> None:
    """Print or write every figure of a design under the default motion, extremes refined."""
    from reports.requests.case import steady_case  # noqa: PLC0415 - for this list alone

    mechanism, motion, conditions = steady_case(load(name), SteadyOptions())
    every = named_figures(mechanism, figure_names(mechanism))
    values = motion.figures(mechanism, {SPEED: np.array([abs(motion.speed)])}, [figure.figure for figure in every])[
        :, 0
    ]
    rows = [(figure.name, figure.unit, value) for figure, value in zip(every, values.tolist(), strict=True)]
    _print_values("figure", mechanism.linkage, rows, conditions, destination)


def _print_values(
    what: str, linkage: Linkage, rows: Sequence[tuple[str, FileUnit, float]], words: str, destination: Destination
) -> None:
    """Print or write the rows, each a name with its unit and its value in SI, in the units of the file."""
    shown = [(name, unit.name, finite(float(f"{value / unit.size:.15g}"))) for name, unit, value in rows]
    cells = [(name, unit, ABSENT if value is None else printed(value)) for name, unit, value in shown]
    destination.print(Paragraph(words, colour="bold"), "", Table("", (what, "unit", "value"), cells, "llr"))
    records = [{"name": name, "units": unit, "value": value} for name, unit, value in shown]
    about = {"mechanism": linkage.name, "variant": linkage.variant, "conditions": words}
    destination.write_json({**about, "records": records})


def list_mechanisms(destination: Destination) -> None:
    """Print or write the suite's linkages, shelf by shelf."""
    names = (catalogue(), literature())
    shelves = {shelf: [load(name) for name in shelf_names] for shelf, shelf_names in zip(SHELVES, names, strict=True)}
    destination.print(*terminal.catalogue({SHELVES[shelf]: linkages for shelf, linkages in shelves.items()}))
    destination.write_json({"records": [_linkage_entry(each, shelf) for shelf in shelves for each in shelves[shelf]]})


def _linkage_entry(linkage: Linkage, shelf: str) -> dict[str, object]:
    facts = {"title": linkage.title, "source": linkage.source, "variants": list(linkage.variants)}
    return {"mechanism": linkage.name, "shelf": shelf, **facts}


def show(name: str, variant: str | None, destination: Destination) -> None:
    """Print or write the structure and figures of a mechanism."""
    facts = portrait(load(name, variant))
    destination.print(*terminal.portrait(facts))
    destination.write_json(facts)


def thread(name: str, variant: str | None, required: Path | None, destination: Destination) -> None:
    """Print or write contour and feed of a mechanism's thread, and its difference from a required curve."""
    linkage = load(name, variant)
    if linkage.thread is None:
        raise LinkproofError(f"'{linkage.name}' has no thread: add a [thread] with its stops to its file")
    mechanism = Mechanism(linkage)
    facts = {"mechanism": linkage.name, "variant": linkage.variant, **thread_facts(mechanism, linkage.thread)}
    comparison = compare_feed(mechanism, linkage.thread, read_required_feed(required)) if required else None
    destination.print(*terminal.thread(facts, comparison))
    if comparison is not None:
        curves = {name: getattr(comparison, name).tolist() for name in ("required", "actual", "difference")}
        facts["comparison"] = {"angle": np.degrees(comparison.angle).tolist(), **curves}
    destination.write_json(facts)
