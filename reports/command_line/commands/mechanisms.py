"""``linkproof new``, ``check`` and ``list``: a linkage file to fill in, its review, the linkages known by name."""

from __future__ import annotations

import json
import math
import os
import re
import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from analytic.description.json_schema import TITLE, json_schema
from analytic.description.linkage import Linkage
from analytic.description.loading import catalogue, literature, load
from analytic.description.written import finite, in_unit
from analytic.designs.figures import figure_names
from analytic.errors import LinkproofError, is_safe
from analytic.files import read_file
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer import linkage_check
from comparisons.designer.curves import Curves
from comparisons.designer.figures import case_figures
from comparisons.designer.linkage_check import check_slips
from comparisons.designer.open_ends import BINDS
from comparisons.designer.parameters import named_figures, parameters, speed_unit
from comparisons.trials.runs.files import check_writable, write_file
from comparisons.trials.runs.store import to_json
from reports.command_line.destination import Destination, Writers, picture_writers
from reports.document.numbers import ABSENT, printed
from reports.document.parts import Paragraph, Table
from reports.document.templates import lines
from reports.document.terminal import Printed
from reports.requests.options import SteadyOptions

if TYPE_CHECKING:
    from matplotlib.figure import Figure


TEMPLATE: Final = Path(json_schema.__code__.co_filename).with_name("new.toml")
SCHEMA_FILE: Final = "linkproof.schema.json"


def new(name: str, destination: Destination) -> None:
    """Write a linkage file to fill in, and the schema with which an editor completes and checks it."""
    path = Path(name if name.lower().endswith(".toml") else f"{name}.toml")
    if path.suffix.lower() != ".toml" or not all(map(is_safe, name)):
        raise LinkproofError(f"expected a name for the new file, got '{name}': give one of letters and digits")
    if os.path.lexists(path):
        raise LinkproofError(f"'{path}' exists already: give another name; linkproof new overwrites nothing")
    check_writable(path)
    schema = path.with_name(SCHEMA_FILE)
    title = json.dumps(path.stem, ensure_ascii=False)[1:-1]
    write_file(path, TEMPLATE.read_text(encoding="utf-8").replace("{title}", title))
    beside = ""
    if _is_ours(schema):
        beside = f" and {'renewed ' if schema.exists() else ''}{schema}, by which editors complete and check it"
        write_file(schema, json.dumps(json_schema(), indent=1, ensure_ascii=False) + "\n")
    argument = shlex.quote(f"./{path}" if str(path).startswith("-") else str(path))
    destination.print(f"wrote {path}{beside}; next: linkproof check {argument}")


def _is_ours(path: Path) -> bool:
    """Whether a schema file can be written: it does not exist, or is ours, perhaps of an older version."""
    try:
        return not os.path.lexists(path) or bool(json.loads(read_file(path, "a schema")).get("title") == TITLE)
    except (LinkproofError, ValueError, AttributeError, RecursionError):
        return False


def check(name: str, variant: str | None, destination: Destination, *, strict: bool = False) -> None:
    """Print or write the facts of a linkage up to its first fault, draw it, and raise the fault.

    With ``strict`` a likely mistake is a fault.
    """
    linkage = load(name, variant)
    destination.check_saves({**FACTS, **DRAWINGS}, {"the linkage's file": Path(name)})
    facts, fault = linkage_check.check(linkage)
    destination.print(*printed_facts(facts, linkage.written))
    destination.write_json(facts)
    destination.write_saves(FACTS, facts)
    if fault is not None:
        raise fault
    if strict:
        check_slips(linkage)
    destination.write_saves(DRAWINGS, linkage)
    for file in destination.save:
        destination.print(f"wrote {file}")
    if not destination.save:
        destination.print("", f"scheme       linkproof check {shlex.quote(name)} --save scheme.svg draws it")


def printed_facts(facts: Mapping[str, Any], written: Callable[[float], str]) -> list[Printed]:
    """A line for each fact, then the links; ``written`` writes a length, m, in the file's unit."""
    heading = Paragraph(f"{facts['mechanism']} ({facts['variant']}): {facts['title']}", colour="bold")
    about = {"facts": facts, "written": written, "binds": math.degrees(BINDS)}
    warnings = [Paragraph(f"warning: {text}", colour="yellow") for text in lines("check_warnings", **about)]
    head = ("link", "mass kg", "inertia kg m²", "mean Jeq kg m²", "points")
    links = Table("", head, list(_links(facts["links"])), "lrrrl")
    return [heading, *_lines("check", 12, **about), "", links, *warnings]


def _lines(macro: str, width: int, **values: object) -> list[Printed]:
    """The lines of a macro of ``sentences.txt``, each with a name of so many characters before its first colon."""
    return [f"{name:<{width}} {fact}" for name, _, fact in (words.partition(": ") for words in lines(macro, **values))]


def _links(links: Mapping[str, Mapping[str, Any]]) -> Iterator[tuple[str, ...]]:
    for name, link in links.items():
        inertia = "-" if link["inertia"] is None else f"{link['inertia']:.4g}"
        mean = f"{link['Jeq_mean']:.4g}" if "Jeq_mean" in link else "-"
        yield name, f"{link['mass']:.4g}", inertia, mean, ", ".join(link["points"])


# The writers of the files of ``check``: of its facts, and of the scheme in twelve positions of its range.


def _scheme(linkage: Linkage) -> Figure:
    from comparisons.designer.building import positions_over_range  # noqa: PLC0415 - matplotlib takes a second
    from reports.charts.scheme import scheme_figure  # noqa: PLC0415

    return scheme_figure(linkage, positions_over_range(Mechanism(linkage)))


def _dxf(linkage: Linkage) -> str:
    from comparisons.designer.building import positions_over_range  # noqa: PLC0415 - ezdxf takes half a second
    from reports.designs.results_dxf import dxf  # noqa: PLC0415

    return dxf(linkage, positions_over_range(Mechanism(linkage)))


TOUCH: Final = 1e-9  # of the largest of its kind: the least magnitude of what passes zero is known no nearer
FACTS: Final[Writers] = {".json": to_json}
DRAWINGS: Final[Writers] = {**picture_writers(_scheme), ".dxf": _dxf}


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
    from reports.requests.designs import steady_case  # noqa: PLC0415 - for this list alone

    mechanism, _, conditions, case = steady_case(linkage, SteadyOptions())
    every = named_figures(mechanism, figure_names(mechanism))
    curves = Curves(case)  # of one design, all figures are found together
    found = case_figures(curves, {each.name: each.figure for each in every})
    values = [found[each.name] / each.unit.size for each in every]
    sizes: dict[tuple[str, str], float] = {}  # of signals of one kind, beside which a value may be rounding
    kinds = [(re.split("[:.@]", each.name)[0], each.unit.name) for each in every]
    for kind, value in zip(kinds, values, strict=True):
        sizes[kind] = max(sizes.get(kind, 0.0), abs(finite(value) or 0.0))
    figures = [
        {
            "name": each.name,
            "units": each.unit.name,
            "value": 0.0 if abs(value) <= TOUCH * sizes[kind] else finite(float(f"{value:.15g}")),
        }
        for each, value, kind in zip(every, values, kinds, strict=True)
    ]
    numbers = [
        {"name": each.name, "units": each.unit.name, "value": in_unit(each.value, each.unit.size)}
        for each in parameters(linkage).values()
    ]
    beside = (
        "Figures stand to six digits; --json gives them in full. "
        f"speed, {speed_unit(linkage).name}, may be varied too, and tolerances be of a point's length and angle."
    )
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
    destination.print(*_shelves({SHELVES[shelf]: linkages for shelf, linkages in shelves.items()}))
    destination.write_json({"records": [_linkage_entry(each, shelf) for shelf in shelves for each in shelves[shelf]]})


def _linkage_entry(linkage: Linkage, shelf: str) -> dict[str, object]:
    facts = {"title": linkage.title, "source": linkage.source, "variants": list(linkage.variants)}
    return {"mechanism": linkage.name, "shelf": shelf, **facts}


def _shelves(shelves: Mapping[str, Sequence[Linkage]]) -> list[Printed]:
    """Mechanisms with their variants and sources, shelf by shelf: a table each, its heading before it."""
    blocks: list[Printed] = []
    for heading, linkages in shelves.items():
        rows = [(linkage.name, linkage.title, ", ".join(linkage.variants), linkage.source) for linkage in linkages]
        table = Table("", ("mechanism", "what", "variants", "source"), rows, "l")
        blocks += ["", Paragraph(f"{heading}:", colour="bold"), table] if rows else []
    return blocks[1:]
