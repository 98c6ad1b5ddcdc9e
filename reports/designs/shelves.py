"""The mechanisms that come with the suite: read as plain tables, so that the list appears at once."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from reports.document.parts import Paragraph, Table
from reports.document.study import Study
from reports.document.terminal import Printed, Printout

CATALOGUE: Final = Path(__file__).parents[2] / "analytic" / "catalogue"
# Of a shelf its folder and its heading.
SHELVES: Final = {
    "catalogue": (CATALOGUE, "The catalogue, taken where nothing is named"),
    "gallery": (CATALOGUE / "gallery", "The gallery, from which linkproof new mine --like NAME starts"),
    "literature": (CATALOGUE / "literature", "Linkages of the literature, taken where they are named"),
}


@dataclass(frozen=True, repr=False)
class Listing(Study):
    """What is listed: ``parts`` in print and ``closing`` lines, ``table`` as JSON-ready data."""

    parts: Sequence[Printed]
    table: Mapping[str, Any]
    closing: Sequence[Printed] = ()
    exit_code: int = 0

    def printout(self) -> Printout:
        """The printed tables."""
        return Printout(self.parts, self.closing)

    def sentence(self) -> Printed:
        """The number of rows of each list in the table, in words: "12 records"."""
        return ", ".join(f"{len(rows)} {name}" for name, rows in self.table.items() if isinstance(rows, list))

    def to_dict(self) -> Mapping[str, Any]:
        """The whole table, JSON-ready."""
        return self.table


def listed_mechanisms() -> Listing:
    """The suite's linkages with their variants and sources as a Listing, a table for each shelf under its heading."""
    parts: list[Printed] = []
    records = []
    for shelf, (folder, heading) in SHELVES.items():
        entries = [_entry(path, shelf) for path in sorted(folder.glob("*.toml"), key=lambda path: path.stem)]
        rows = [(row["mechanism"], row["title"], ", ".join(row["variants"]), row["source"]) for row in entries]
        table = Table("", ("mechanism", "what", "variants", "source"), rows, "l")
        parts += [*([""] if parts else []), Paragraph(f"{heading}:", colour="bold"), table]
        records += entries
    return Listing(parts, {"records": records})


def _entry(path: Path, shelf: str) -> dict[str, Any]:
    """Name, ``shelf``, title, source and variants, its own first, of a linkage file, JSON-ready."""
    table = tomllib.loads(path.read_text(encoding="utf-8"))
    variants = [table.get("variant", "base"), *sorted(table.get("variants", {}))]
    facts = {"title": table["title"], "source": table["source"], "variants": variants}
    return {"mechanism": path.stem, "shelf": shelf, **facts}
