"""What has changed since results were recorded: the errors of before and of now, joined by run and quantity.

A row of the engine ``CLOSED_FORM`` has a figure of the closed form, SI, in the error's place, so that a changed mass in
a linkage's file is seen. A file of rows is CSV, sorted, so that its diff shows what moved.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Final

import numpy as np

from analytic.description.written import change
from analytic.errors import LinkproofError, shortened
from analytic.files import read_file
from comparisons.trials.judging.records import NAMES, Error, Verdict
from comparisons.trials.runs.files import write_file

CLOSED_FORM: Final = "closed form"
GROWTH: Final = 3.0  # times its recorded value an error may become
FLOOR_SHARE: Final = 1e-3  # of its limit: a smaller error is round-off, and may grow
SAME_FIGURE: Final = 1e-6  # what a figure of the closed form may change by, relative
MotionUnit = tuple[str, ...]  # mechanism, variant, regime, conditions, and a unit
ROUNDINGS: Final = 16  # of the largest figure of a unit: a smaller figure counts as zero
Place = tuple[str, str, str, str, str, str, str]  # what tells a row from all others: its run, and the quantity
COLUMNS: Final = (*NAMES, "quantity", "outcome", "value")
LARGEST: Final = 1 << 25  # bytes of a file of rows


def write_rows(rows: Iterable[Error], file: Path) -> None:
    """Write rows as CSV, sorted, replacing the file: errors with four digits, figures with nine.

    Columns are ``COLUMNS``, ``value`` being ``error_max``. Raises LinkproofError where the file cannot be written.
    """
    target = io.StringIO()
    writer = csv.writer(target, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row in sorted(rows, key=_place_of_row):
        digits = ".9g" if row.engine == CLOSED_FORM else ".3e"
        writer.writerow(
            (*_place_of_row(row), row.outcome, "" if row.error_max is None else f"{row.error_max:{digits}}")
        )
    write_file(file, target.getvalue())


def read_rows(file: Path) -> list[Error]:
    """The rows of a CSV file that ``write_rows`` wrote, in its order; of each Error its columns alone are filled in.

    Raises LinkproofError, with the line, for other columns, a wrong value, or a row that stands above, and without a
    line for a file that is missing, too large, or no CSV in UTF-8.
    """
    cure = "record it again with --record, or correct the line"
    content = read_file(file, "recorded results", LARGEST)
    try:
        reader = csv.reader(io.StringIO(content.decode(), newline=""))
        if (head := next(reader, [])) != [*COLUMNS]:
            got = shortened(",".join(head))
            raise LinkproofError(f"'{file}', line 1: expected the columns {','.join(COLUMNS)}, got '{got}'; {cure}")
        rows: dict[Place, Error] = {}
        for cells in reader:
            try:
                row = _row(cells)
                if _place_of_row(row) in rows:
                    raise ValueError("the same row stands above")
            except ValueError as error:
                raise LinkproofError(f"'{file}', line {reader.line_num}: {error}; {cure}") from error
            rows[_place_of_row(row)] = row
    except UnicodeDecodeError as error:
        raise LinkproofError(f"'{file}' is no text in UTF-8: name a file that --record wrote") from error
    except csv.Error as error:
        raise LinkproofError(f"'{file}' cannot be read: {error}; name a file that --record wrote") from error
    return list(rows.values())


def _row(cells: list[str]) -> Error:
    """The Error record of a CSV row's cells, in the order of ``COLUMNS``; raises ValueError for wrong cells.

    Those are too many or few, a value that is not a finite number, a figure without one, or an unknown outcome.
    """
    if len(cells) != len(COLUMNS):
        raise ValueError(f"expected {len(COLUMNS)} columns, got {len(cells)}")
    outcome, text = cells[-2:]
    value = float(text) if text else None
    if value is not None and not math.isfinite(value):
        raise ValueError(f"expected a finite value, got {text}")
    row = Error(*cells[:6])._replace(quantity=cells[6], error_max=value, outcome=outcome)  # type: ignore[arg-type]
    is_figure = row.engine == CLOSED_FORM
    if is_figure and value is None:
        raise ValueError("expected a value of the closed form, got none")
    if not is_figure and outcome not in list(Verdict):
        raise ValueError(f"expected an outcome, such as passed, got '{outcome}'")
    return row


def _place_of_row(row: Error) -> Place:
    """The columns by which a row before and a row after are the same result: the run's names and the quantity."""
    return row[:7]


class ChangeKind(StrEnum):
    """What has become of a row. All but APPEARED fail."""

    FAILING = "newly failing"
    GROWN = "grown threefold"
    VANISHED = "vanished"
    CHANGED = "changed"
    APPEARED = "appeared"


@dataclass(frozen=True)
class Change:
    """A row that is not as it was recorded; ``before`` and ``after`` are its values, ``outcome`` is that of now."""

    kind: ChangeKind
    place: Place
    before: float | None
    after: float | None
    outcome: str = ""
    unit: str = ""

    @property
    def fails(self) -> bool:
        """Whether it fails the comparison; a result that has appeared does not."""
        return self.kind is not ChangeKind.APPEARED

    @property
    def run(self) -> str:
        """The run's names as one text, without the conditions: "MECHANISM (VARIANT), REGIME, ENGINE SETTING"."""
        mechanism, variant, regime, _, engine, setting, _ = self.place
        return f"{mechanism} ({variant}), {regime}, {engine} {setting}".rstrip()

    @property
    def share(self) -> float | None:
        """The relative change, after over before less 1; None without both values, or from zero."""
        return self.after / self.before - 1.0 if self.before and self.after is not None else None

    @property
    def sentence(self) -> str:
        """The change in one sentence without a full stop: which row, and what it was and is."""
        place = f"{self.run}, {self.place[-1]}"
        if self.kind is ChangeKind.FAILING:
            return f"{place}: {Verdict(self.outcome).value}, and was not before"
        if self.kind is ChangeKind.VANISHED:
            return f"{place}: was recorded, and {f'is {self.outcome}' if self.outcome else 'is not there any more'}"
        if self.kind is ChangeKind.APPEARED:
            return f"{place}: was not recorded"
        if self.kind is ChangeKind.GROWN:
            return f"{place}: the error was {self.before:.2g} of the peak, and is {self.after:.2g}"
        share = f", {change(self.share, '.2g')}" if self.share is not None else ""
        return f"{place}: was {self.before:.9g} {self.unit}".rstrip() + f", and is {self.after:.9g} {self.unit}{share}"


def changes(before: Iterable[Error], after: Iterable[Error]) -> Iterator[Change]:
    """Yield the differences of rows ``after`` from rows ``before``, in the order of their names: an outer join.

    A row that is neither newly failing nor off by more than is allowed has none, nor has one without a value that is
    there only before or only after.
    """
    old, new = ({_place_of_row(row): row for row in rows} for rows in (before, after))
    roundings = _rounding_errors(old, new)
    for place in sorted(old.keys() | new.keys()):
        was, now = old.get(place), new.get(place)
        kind = _kind_of_change(was, now, roundings)
        if kind is not None:
            was, now = was or Error(*place), now or Error(*place, outcome="")
            yield Change(kind, place, was.error_max, now.error_max, now.outcome, now.unit)


def _kind_of_change(was: Error | None, now: Error | None, roundings: Mapping[MotionUnit, float]) -> ChangeKind | None:
    """The kind of change between the rows of one place, ``was`` and ``now``, of which one may be None; None for none.

    ``roundings`` are what figures of a motion and unit may differ by, in that unit. A row without a value counts as
    absent, but one that fails now, where ``was`` did not, is newly failing; one that failed before may fail on. An
    error that passes may grow to ``GROWTH`` times what it was or to ``FLOOR_SHARE`` of its limit, one without a limit
    to anything; a figure may change by ``SAME_FIGURE`` of itself.
    """
    if was is None or now is None:
        there = was or now
        assert there is not None
        return None if there.error_max is None else ChangeKind.APPEARED if was is None else ChangeKind.VANISHED
    if now.engine != CLOSED_FORM and Verdict(now.outcome).failed:
        return None if Verdict(was.outcome).failed else ChangeKind.FAILING
    if was.error_max is None or now.error_max is None:
        return None if was.error_max is None else ChangeKind.VANISHED
    if now.engine == CLOSED_FORM:
        allowed = max(SAME_FIGURE * abs(was.error_max), roundings.get(_motion(now), 0.0))
        return None if abs(now.error_max - was.error_max) <= allowed else ChangeKind.CHANGED
    most = max(GROWTH * was.error_max, FLOOR_SHARE * (now.limit or math.inf))
    return ChangeKind.GROWN if Verdict(now.outcome).judged and not now.error_max <= most else None


def _rounding_errors(old: Mapping[Place, Error], new: Mapping[Place, Error]) -> dict[MotionUnit, float]:
    """The rounding error of the largest recorded figure, by motion and unit; of rad no less than SAME_FIGURE.

    Only figures of the closed form count, of rows both recorded, ``old``, and there now, ``new``; the errors are in the
    unit.
    """
    values: dict[MotionUnit, float] = {}
    for place, row in new.items():
        if row.engine == CLOSED_FORM and (was := old.get(place)) is not None and was.error_max is not None:
            usual = SAME_FIGURE if row.unit == "rad" else 0.0  # a transmission angle of zero is rounding
            error = ROUNDINGS * float(np.finfo(float).eps) * abs(was.error_max)
            values[_motion(row)] = max(values.get(_motion(row), usual), error)
    return values


def _motion(row: Error) -> MotionUnit:
    """The linkage, motion and unit of a row, within which roundings are alike."""
    return (*row[:4], row.unit)
