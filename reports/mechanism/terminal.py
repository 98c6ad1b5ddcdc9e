"""Mechanisms, and their check for a terminal."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from comparisons.datasheet.open_ends import BINDS
from reports.document.parts import Paragraph, Table
from reports.document.templates import lines
from reports.document.terminal import Printed

if TYPE_CHECKING:
    from analytic.description.linkage import Linkage


def catalogue(shelves: Mapping[str, Sequence[Linkage]]) -> list[Printed]:
    """Mechanisms with their variants and sources, shelf by shelf: a table each, its heading before it."""
    blocks: list[Printed] = []
    for heading, linkages in shelves.items():
        rows = [(linkage.name, linkage.title, ", ".join(linkage.variants), linkage.source) for linkage in linkages]
        table = Table("", ("mechanism", "what", "variants", "source"), rows, "l")
        blocks += ["", Paragraph(f"{heading}:", colour="bold"), table] if rows else []
    return blocks[1:]


def _lines(macro: str, width: int, **values: object) -> list[Printed]:
    """The lines of a macro of ``sentences.txt``, each with a name of so many characters before its first colon."""
    return [f"{name:<{width}} {fact}" for name, _, fact in (words.partition(": ") for words in lines(macro, **values))]


def _links(links: Mapping[str, Mapping[str, Any]]) -> Iterator[tuple[str, ...]]:
    for name, link in links.items():
        inertia = "-" if link["inertia"] is None else f"{link['inertia']:.4g}"
        mean = f"{link['Jeq_mean']:.4g}" if "Jeq_mean" in link else "-"
        yield name, f"{link['mass']:.4g}", inertia, mean, ", ".join(link["points"])


# The output of ``linkproof check``: a line for each property of a linkage.


def printed(facts: Mapping[str, Any], written: Callable[[float], str]) -> list[Printed]:
    """A line for each fact, then the links; ``written`` writes a length, m, in the file's unit."""
    heading = Paragraph(f"{facts['mechanism']} ({facts['variant']}): {facts['title']}", colour="bold")
    about = {"facts": facts, "written": written, "binds": math.degrees(BINDS)}
    warnings = [Paragraph(f"warning: {text}", colour="yellow") for text in lines("check_warnings", **about)]
    head = ("link", "mass kg", "inertia kg m²", "mean Jeq kg m²", "points")
    links = Table("", head, list(_links(facts["links"])), "lrrrl")
    return [heading, *_lines("check", 12, **about), "", links, *warnings]
