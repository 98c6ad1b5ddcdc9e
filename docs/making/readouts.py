"""The tables of docs/engines.md: ``python -m docs.making.readouts docs/engines.md`` writes them anew."""

from __future__ import annotations

import sys
from pathlib import Path

from engines.registry import engine, engine_names
from reports.document.markdown import table
from reports.records.origins import readout_table

MARK = "<!-- below: python -m docs.making.readouts docs/engines.md -->"


def tables() -> str:
    """Every engine's read-outs in Markdown."""
    return "\n\n".join(table(readout_table(name, engine(name).abilities.as_dict())) for name in engine_names())


def renewed(page: str) -> str:
    """The page with its tables made anew."""
    return f"{page.partition(MARK)[0]}{MARK}\n\n{tables()}\n"


if __name__ == "__main__":
    path = Path(sys.argv[1])
    path.write_text(renewed(path.read_text(encoding="utf-8")), encoding="utf-8")
