"""Benchmarks and stability maps of folders: held against themselves, and against those of another folder."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

from comparisons.folders.difference import ROUNDING, is_other
from comparisons.judging.baseline import GROWTH
from comparisons.judging.records import RunRecord
from comparisons.runs.study_folder import has_study
from comparisons.stress import saved as stress_test
from comparisons.stress.cell_result import CellResult, StressVerdict
from comparisons.stress.saved import Stress
from comparisons.stress.verdict import verdict_of
from comparisons.work_precision import records as work_precision
from comparisons.work_precision.analysis import judged
from comparisons.work_precision.records import Bench, PointRecord
from engines.contract import Outcome

SAME_ORDER: Final = 0.01  # what rounding may change in an observed order


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
    """What has moved between two studies of a ``kind``; ``compared`` counts the runs in both."""

    kind: str
    compared: int
    moves: tuple[StudyMove, ...]
    only_before: tuple[str, ...]
    only_after: tuple[str, ...]


def study_differences(before: Path, after: Path) -> Iterator[StudyDifference]:
    """The differences of the studies, other than campaigns, that both folders have."""
    if has_study(before, work_precision.KIND) and has_study(after, work_precision.KIND):
        old, new = ({one.key: one for one in work_precision.load(folder).points} for folder in (before, after))
        yield _difference(work_precision.KIND, old, new, lambda one: one.outcome, _is_worse_point)
    if has_study(before, stress_test.KIND) and has_study(after, stress_test.KIND):
        first, second = ({one.cell.key: one for one in stress_test.load(folder).results} for folder in (before, after))
        yield _difference(stress_test.KIND, first, second, lambda one: one.verdict.value, _is_worse_cell)


def _difference(
    kind: str,
    before: Mapping[str, Any],
    after: Mapping[str, Any],
    outcome: Callable[[Any], str],
    is_worse: Callable[[Any, Any], bool],
) -> StudyDifference:
    both = [key for key in after if key in before]
    moves = []
    for key in both:
        old, new = before[key], after[key]
        outcomes = (outcome(old), outcome(new))
        if outcomes[0] != outcomes[1]:
            moves.append(StudyMove(key, "", outcomes, (None, None), is_worse(old, new)))
        moves += [
            StudyMove(key, name, outcomes, errors, is_worse=errors[1] > max(GROWTH * errors[0], ROUNDING))
            for name, errors in _errors(old, new)
            if is_other(*errors)
        ]
    only = (tuple(key for key in one if key not in other) for one, other in ((before, after), (after, before)))
    return StudyDifference(kind, len(both), tuple(moves), *only)


def _errors(old: RunRecord, new: RunRecord) -> Iterator[tuple[str, tuple[float, float]]]:
    """Errors of the quantities that both runs have."""
    first = {one.quantity: one.error_max for one in old.errors if one.error_max is not None}
    for one in new.errors:
        if one.quantity in first and one.error_max is not None:
            yield one.quantity, (first[one.quantity], one.error_max)


def _is_worse_point(old: PointRecord, new: PointRecord) -> bool:
    return old.outcome == Outcome.FINISHED and new.outcome != Outcome.FINISHED


def _is_worse_cell(old: CellResult, new: CellResult) -> bool:
    return old.verdict is StressVerdict.WITHIN or new.verdict is StressVerdict.MISSED


@dataclass(frozen=True)
class CheckedStudy:
    """How much a study of a ``kind`` has, in words, and where it contradicts itself: place and sentence."""

    kind: str
    extent: str
    faults: tuple[tuple[str, str], ...]


def checked_studies(folder: Path) -> Iterator[CheckedStudy]:
    """The studies of a folder, other than campaigns, held against themselves."""
    if has_study(folder, work_precision.KIND):
        bench = work_precision.load(folder)
        yield CheckedStudy(work_precision.KIND, f"{len(bench.points)} points", tuple(_bench_faults(bench)))
    if has_study(folder, stress_test.KIND):
        stress = stress_test.load(folder)
        extent = f"{len(stress.results)} cells, {len(stress.borders)} borders"
        yield CheckedStudy(stress_test.KIND, extent, tuple(_stress_faults(stress)))


def _bench_faults(bench: Bench) -> Iterator[tuple[str, str]]:
    """Times and orders that are not those of the points."""
    bare = [replace(point, orders={}, fronts=()) for point in bench.points]
    for saved, now in zip(bench.points, judged(bare), strict=True):
        place = f"bench {saved.key}"
        if saved.repeats and saved.seconds != min(saved.repeats):
            yield place, f"its time is {saved.seconds:.4g} s, the shortest repeat took {min(saved.repeats):.4g} s"
        if {*saved.fronts} != {*now.fronts}:
            yield place, f"it is on the fronts of {_words(saved.fronts)}, its errors and times say {_words(now.fronts)}"
        for name, order in saved.orders.items():
            if name not in now.orders or abs(order - now.orders[name]) > SAME_ORDER:
                yield place, f"its order in {name} is {order:.3g}, that of its sweep is {now.orders.get(name)}"


def _stress_faults(stress: Stress) -> Iterator[tuple[str, str]]:
    """Verdicts that a cell's errors do not give, and borders that no cell has."""
    for cell in stress.results:
        now = verdict_of(cell)
        if now is not None and now is not cell.verdict:
            yield f"stress {cell.cell.key}", f"saved as {cell.verdict.value}, its errors say {now.value}"
    known = {one.cell.key: one.verdict for one in stress.results}
    for border in stress.borders:
        inside, outside = (known.get(border.cell(value).key) for value in (border.inside, border.outside))
        if inside is not StressVerdict.WITHIN or outside is not border.verdict:
            yield f"stress {'/'.join(border.line)}", "its border does not lie between two cells of its line"


def _words(names: Sequence[str]) -> str:
    return ", ".join(names) or "no quantity"
