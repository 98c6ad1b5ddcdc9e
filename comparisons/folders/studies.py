"""Benchmarks and stability maps of folders: checked for contradictions, and compared with another folder's."""

from __future__ import annotations

import csv
import io
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Final

from analytic.errors import LinkproofError
from comparisons.campaign import results as campaign
from comparisons.campaign.results import Results
from comparisons.folders.difference import ROUNDING, differ
from comparisons.judging.baseline import GROWTH
from comparisons.judging.records import CURVE, RunRecord
from comparisons.runs.files import check_writable, write_text
from comparisons.runs.study_folder import has_study
from comparisons.stress import saved as stress_test
from comparisons.stress.cell_result import CellResult, StressVerdict
from comparisons.stress.saved import Stress
from comparisons.stress.verdict import verdict_of
from comparisons.work_precision import records as work_precision
from comparisons.work_precision.analysis import judged
from comparisons.work_precision.records import Bench, PointRecord
from engines.contract import Outcome

Measured = PointRecord | CellResult
GOOD_OUTCOMES: Final = (Outcome.FINISHED, StressVerdict.WITHIN)
SAME_ORDER: Final = 0.01  # what rounding may change in an observed order
OTHER_CHARACTERS: Final = r"[^\w+.-]+"  # than a file name may have everywhere
COLUMNS: Final = ("quantity", "unit", *CURVE)


@dataclass(frozen=True)
class StudyFolder:
    """The studies of a folder, each read on first use; None for a kind that is missing."""

    path: Path

    @cached_property
    def campaign(self) -> Results | None:
        """The campaign."""
        return campaign.load(self.path) if campaign.is_saved(self.path) else None

    @cached_property
    def bench(self) -> Bench | None:
        """The benchmark."""
        return work_precision.load(self.path) if has_study(self.path, work_precision.KIND) else None

    @cached_property
    def stress(self) -> Stress | None:
        """The stability maps."""
        return stress_test.load(self.path) if has_study(self.path, stress_test.KIND) else None


@dataclass(frozen=True)
class StudyMove:
    """A run of both folders whose outcome, or whose error in a quantity, over the peak, is not the same.

    ``is_worse``: it finished, or was right, and does no more, or its error is over three times the one before.
    """

    run: str
    quantity: str
    outcomes: tuple[str, str]
    errors: tuple[float | None, float | None]
    is_worse: bool


@dataclass(frozen=True)
class StudyDifference:
    """The differences of two studies of a ``kind``; ``compared`` counts the runs in both."""

    kind: str
    compared: int
    moves: tuple[StudyMove, ...]
    only_before: tuple[str, ...]
    only_after: tuple[str, ...]


def study_differences(before: StudyFolder, after: StudyFolder) -> Iterator[StudyDifference]:
    """The differences of the studies, other than campaigns, that both folders have."""
    if before.bench and after.bench:
        yield _study_difference(work_precision.KIND, before.bench.points, after.bench.points)
    if before.stress and after.stress:
        yield _study_difference(stress_test.KIND, before.stress.results, after.stress.results)


def _study_difference(kind: str, before: Sequence[Measured], after: Sequence[Measured]) -> StudyDifference:
    first, second = ({entry.key: entry for entry in part} for part in (before, after))
    pairs = [(first[key], new) for key, new in second.items() if key in first]
    moves = []
    for old, new in pairs:
        outcomes = (old.outcome, new.outcome)
        if old.outcome != new.outcome:
            is_worse = old.outcome in GOOD_OUTCOMES or new.outcome == StressVerdict.MISSED
            moves.append(StudyMove(new.key, "", outcomes, (None, None), is_worse))
        moves += [
            StudyMove(new.key, name, outcomes, errors, is_worse=errors[1] > max(GROWTH * errors[0], ROUNDING))
            for name, errors in _common_errors(old, new)
            if differ(*errors)
        ]
    only = (tuple(key for key in table if key not in other) for table, other in ((first, second), (second, first)))
    return StudyDifference(kind, len(pairs), tuple(moves), *only)


def _common_errors(old: RunRecord, new: RunRecord) -> Iterator[tuple[str, tuple[float, float]]]:
    """Errors of the quantities that both runs have."""
    first = {record.quantity: record.error_max for record in old.errors if record.error_max is not None}
    for error in new.errors:
        if error.quantity in first and error.error_max is not None:
            yield error.quantity, (first[error.quantity], error.error_max)


def check_studies(folder: StudyFolder) -> Iterator[tuple[str, list[tuple[str, str]]]]:
    """The size of each study of a folder other than a campaign, and its contradictions: place, sentence."""
    if bench := folder.bench:
        yield f"{work_precision.KIND}: {len(bench.points)} points", list(_bench_faults(bench))
    if stress := folder.stress:
        extent = f"{len(stress.results)} cells, {len(stress.borders)} borders"
        yield f"{stress_test.KIND}: {extent}", list(_stress_faults(stress))


def _bench_faults(bench: Bench) -> Iterator[tuple[str, str]]:
    """Times and orders that are not those of the points."""
    bare = [replace(point, orders={}, fronts=()) for point in bench.points]
    for saved, now in zip(bench.points, judged(bare), strict=True):
        place = f"bench {saved.key}"
        if saved.repeats and saved.seconds != min(saved.repeats):
            yield place, f"its time is {saved.seconds:.4g} s, the shortest repeat took {min(saved.repeats):.4g} s"
        if {*saved.fronts} != {*now.fronts}:
            before, after = _names_text(saved.fronts), _names_text(now.fronts)
            yield place, f"it is on the fronts of {before}, its errors and times say {after}"
        for name, order in saved.orders.items():
            if name not in now.orders or abs(order - now.orders[name]) > SAME_ORDER:
                yield place, f"its order in {name} is {order:.3g}, that of its sweep is {now.orders.get(name)}"


def _stress_faults(stress: Stress) -> Iterator[tuple[str, str]]:
    """Verdicts that a cell's errors do not give, and borders that no cell has."""
    for cell in stress.results:
        now = verdict_of(cell)
        if now is not None and now is not cell.verdict:
            yield f"stress {cell.key}", f"saved as {cell.verdict.value}, its errors say {now.value}"
    known = {result.key: result.verdict for result in stress.results}
    for border in stress.borders:
        inside, outside = (known.get(border.cell(value).key) for value in (border.inside, border.outside))
        if inside is not StressVerdict.WITHIN or outside is not border.verdict:
            yield f"stress {'/'.join(border.line)}", "its border does not lie between two cells of its line"


def _names_text(names: Sequence[str]) -> str:
    return ", ".join(names) or "no quantity"


# The curves of a campaign as CSV: one tidy file per run, a row per quantity and sample.


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
        write_text(folder / name, _curve_table(results, run, quantities))
        paths.append(folder / name)
    return tuple(paths)


def _curve_table(results: Results, run: Sequence[str], quantities: dict[str, str]) -> str:
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
