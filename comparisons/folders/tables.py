"""The curves of a campaign as CSV: one tidy file per run, a row per quantity and sample."""

from __future__ import annotations

import csv
import io
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Final

from analytic.errors import LinkproofError
from comparisons.campaign.results import Results
from comparisons.judging.records import CURVE
from comparisons.runs.files import check_writable, write_text

OTHER_CHARACTERS: Final = r"[^\w+.-]+"  # than a file name may have everywhere
COLUMNS: Final = ("quantity", "unit", *CURVE)


def write_tables(results: Results, folder: Path) -> tuple[Path, ...]:
    """Write every run that has curves into a folder; returns the files' paths in the order of the runs.

    Columns are ``COLUMNS``: time, s, true crank angle, rad (m of a linear drive), observed and reference in the unit.
    Numbers are written with all their digits. Raises LinkproofError where there is no curve or no place to write.
    """
    units = {(record.run, record.quantity): record.unit for record in results.records if record.error_max is not None}
    runs = tuple(dict.fromkeys(run for run, _ in units))
    if not runs:
        raise LinkproofError("expected curves to write as CSV, got none: no run of the campaign finished")
    check_writable(folder / "run.csv")
    paths = []
    for run, name in zip(runs, _file_names(runs), strict=True):
        quantities = {quantity: unit for (of, quantity), unit in units.items() if of == run}
        write_text(folder / name, _table(results, run, quantities))
        paths.append(folder / name)
    return tuple(paths)


def _table(results: Results, run: Sequence[str], quantities: dict[str, str]) -> str:
    target = io.StringIO()
    writer = csv.writer(target, lineterminator="\n")
    writer.writerow(COLUMNS)
    for quantity, unit in quantities.items():
        columns = (array.tolist() for array in results.curve(run, quantity))
        writer.writerows((quantity, unit, *values) for values in zip(*columns, strict=True))
    return target.getvalue()


def _file_names(runs: Sequence[Sequence[str]]) -> Iterator[str]:
    """A file name of each run that every system takes."""
    stems = ("_".join(re.sub(OTHER_CHARACTERS, "-", word) for word in run) for run in runs)
    return (f"{stem}.csv" for stem in numbered(stems))


def numbered(stems: Iterable[str]) -> Iterator[str]:
    """Names that differ from each other on every system: those that come again have a number."""
    counts: Counter[str] = Counter()
    for stem in stems:
        counts[stem.casefold()] += 1
        count = counts[stem.casefold()]
        yield stem if count == 1 else f"{stem}~{count}"
