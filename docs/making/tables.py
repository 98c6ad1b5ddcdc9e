"""Tables of the documentation: ``python -m docs.making.tables docs/sources.md`` writes those of a page anew."""

from __future__ import annotations

import sys
from pathlib import Path

from analytic.description.loading import catalogue, literature, load
from comparisons.designer.figures import compare_published
from docs.making.rooms import rooms
from engines.registry import engine, own_names
from reports.document.markdown import table, written
from reports.document.parts import Bullets, Section
from reports.mechanism.published import notes, published_table
from reports.records import readout_table

MARK = "<!-- below: python -m docs.making.tables docs/{} -->"


def readouts() -> str:
    """Every engine's read-outs, those with the same ones in one table."""
    alike: dict[str, tuple[list[str], dict[str, dict[str, str]]]] = {}
    for name in own_names():
        channels = engine(name).abilities.as_dict()
        alike.setdefault(repr(channels), ([], channels))[0].append(name)
    return "\n\n".join(table(readout_table(", ".join(names), channels)) for names, channels in alike.values())


def printed_figures() -> str:
    """The figures that the sources print of every mechanism, beside ours."""
    sections = (figures_of(name) for name in (*catalogue(), *literature()))
    return "\n\n".join(filter(None, sections))


def figures_of(name: str) -> str:
    """The printed figures of a mechanism beside ours, and what there is to note; "" without any."""
    rows = [vars(record) for record in compare_published([load(name, variant) for variant in load(name).variants])]
    noted = notes(rows)
    parts = (published_table(rows), *((Bullets(noted),) if noted else ()))
    return written((Section("", name, parts),), level=3) if rows else ""


MADE = {"engines.md": readouts, "rooms.md": rooms, "sources.md": printed_figures}


def renewed(path: Path) -> str:
    """A page with its tables made anew."""
    mark = MARK.format(path.name)
    return f"{path.read_text(encoding='utf-8').partition(mark)[0]}{mark}\n\n{MADE[path.name]()}\n"


if __name__ == "__main__":
    for name in sys.argv[1:]:
        Path(name).write_text(renewed(Path(name)), encoding="utf-8")
