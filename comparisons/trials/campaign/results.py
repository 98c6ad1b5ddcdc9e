"""Results that a folder saves: campaigns with all that a report needs besides, and cases of ``results --out``."""

from __future__ import annotations

import csv
import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Final, NotRequired

from pydantic import Field, TypeAdapter
from typing_extensions import TypedDict

from analytic.description.crank_motion import CrankMotion, Segment
from analytic.description.linkage import Linkage
from analytic.description.loading import parse
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Case, case_of_file_regime
from comparisons.trials.campaign.campaign import CampaignRequest
from comparisons.trials.judging.changes import CLOSED_FORM, Change
from comparisons.trials.judging.limits import Limit, LimitTable, shipped_limits, table_from_rows
from comparisons.trials.judging.records import NAMES, Error, RunRecord
from comparisons.trials.runs.environment import environment
from comparisons.trials.runs.store import Curve, has_study, load_study, save_study
from engines.contract import ReadOut

RESULTS: Final = "results"


class LinkageRow(TypedDict):
    """A linkage as it was described, the ``text`` of its file, under a gravity, m/s²."""

    name: str
    variant: str
    gravity: tuple[float, float]
    text: str


class MotionRow(TypedDict):
    """A crank motion: its pieces from one instant to another, s, each a polynomial of the angle, rad.

    A segment is start, end, and coefficients of the time since the start, lowest order first.
    """

    regime: str
    segments: Annotated[list[tuple[float, float, Annotated[list[float], Field(min_length=1)]]], Field(min_length=1)]


class CaseRow(TypedDict):
    """A linkage under a motion; that of a released crank, which the text of the linkage has, is named alone."""

    linkage: LinkageRow
    motion: MotionRow | None
    regime: str
    conditions: str


CASE: Final = TypeAdapter(CaseRow)


def linkage_row(linkage: Linkage) -> LinkageRow:
    """The row that saves a linkage, its file's text among it."""
    return LinkageRow(name=linkage.name, variant=linkage.variant, gravity=linkage.gravity, text=linkage.text)


def described_linkage(row: LinkageRow) -> Linkage:
    """The linkage that a row saved, under its gravity; raises DescriptionError for a damaged text."""
    own = parse(row["text"], row["name"], row["name"], row["variant"])
    return replace(own, gravity=(row["gravity"][0], row["gravity"][1]))


def motion_row(motion: CrankMotion) -> MotionRow:
    """The row that saves a motion; ``described_motion`` reads it back."""
    segments = [(piece.start, piece.end, list(piece.coefficients)) for piece in motion.segments]
    return MotionRow(regime=motion.regime, segments=segments)


def described_motion(row: MotionRow) -> CrankMotion:
    """The motion that a row saved."""
    return CrankMotion(row["regime"], tuple(Segment(start, end, tuple(c)) for start, end, c in row["segments"]))


def save_case(folder: Path, case: Case) -> None:
    """Write a case into a folder, replacing an earlier one of its linkage and variant; it becomes the last.

    Raises LinkproofError where the folder cannot be written or its saved cases are damaged.
    """
    linkage, motion = case.mechanism.linkage, case.motion
    row = CaseRow(
        linkage=linkage_row(linkage),
        motion=motion_row(motion) if isinstance(motion, CrankMotion) else None,
        regime=motion.regime,
        conditions=case.conditions,
    )
    rows = {**({_key(row): row for row in _load_rows(folder)} if has_study(folder, RESULTS) else {}), _key(row): row}
    rows[_key(row)] = rows.pop(_key(row))  # the last one
    save_study(folder, RESULTS, {}, ((key, row, {}) for key, row in rows.items()))


def _key(row: CaseRow) -> str:
    """The key of a saved case: "mechanism/variant"."""
    return f"{row['linkage']['name']}/{row['linkage']['variant']}"


def load_cases(folder: Path) -> list[Case]:
    """The saved cases of a folder, in the order of saving, [] without any; raises LinkproofError for a damaged one."""
    return [*map(_case_of_row, _load_rows(folder))] if has_study(folder, RESULTS) else []


def _load_rows(folder: Path) -> tuple[CaseRow, ...]:
    """The saved cases of a folder as rows, as they were saved; raises LinkproofError for a damaged or missing file."""
    return load_study(folder, RESULTS, TypeAdapter(dict[str, Any]), lambda row, _: CASE.validate_python(row))[1]


def _case_of_row(row: CaseRow) -> Case:
    """The case that a row saved, a released crank's motion anew; raises DescriptionError for a damaged text.

    Raises KeyError for a released regime that the text does not have.
    """
    mechanism = Mechanism(described_linkage(row["linkage"]))
    if row["motion"] is not None:
        return Case(mechanism, described_motion(row["motion"]), conditions=row["conditions"])
    case = case_of_file_regime(mechanism, mechanism.linkage.released[row["regime"]])
    return replace(case, mechanism=mechanism)  # a torque over the angle is the drive's, not a load


# The form of a campaign's saved document, by which it is checked when it is read back.


class KeyFigure(TypedDict):
    """A key figure of a linkage under a motion by its name: the value, SI, and its unit."""

    mechanism: str
    variant: str
    regime: str
    conditions: str
    figure: str
    value: float
    unit: str


class SavedCampaign(TypedDict):
    """A campaign's saved document, all but the runs."""

    command: str
    conditions: str
    environment: Mapping[str, str]
    readouts: Mapping[str, Mapping[str, ReadOut]]  # by engine and channel
    motions: list[MotionRow]
    descriptions: list[LinkageRow]
    limits: NotRequired[list[Limit]]
    figures: NotRequired[list[KeyFigure]]
    changes: NotRequired[list[Change]]
    judgement: NotRequired[list[str]]


FORM: Final[TypeAdapter[Any]] = TypeAdapter(SavedCampaign)
_CHANGES: Final = TypeAdapter(tuple[Change, ...])


# The results of a campaign: its runs, and all that a report needs besides; saved and read back.


COMPARE: Final = "compare"
JUDGE: Final = "judge"  # another tool's results in an engine's place
KINDS: Final = (COMPARE, JUDGE)


@dataclass(frozen=True)
class CampaignResults:
    """A finished campaign: its document and its runs."""

    document: Mapping[str, Any]
    runs: Iterable[RunRecord]

    @cached_property
    def records(self) -> tuple[Error, ...]:
        """The errors of all runs, one record per run and quantity."""
        return tuple(error for run in self.runs for error in run.errors)

    @cached_property
    def invariants(self) -> tuple[Error, ...]:
        """The invariants of all runs, one record per run and invariant."""
        return tuple(error for run in self.runs for error in run.invariants)

    @cached_property
    def limits(self) -> LimitTable:
        """The limits of the records; the suite's own if the document has no table of limits."""
        return table_from_rows(self.document["limits"]) if "limits" in self.document else shipped_limits()

    @cached_property
    def figures(self) -> tuple[Error, ...]:
        """Key figures of the closed form, as Error records of ``CLOSED_FORM`` whose ``error_max`` is the value, SI."""
        return tuple(
            Error(
                **{name: row[name] for name in NAMES[:4]}, engine=CLOSED_FORM, setting="", quantity=row["figure"],
                unit=row["unit"], error_max=row["value"], outcome="",
            )
            for row in self.document.get("figures", ())
        )  # fmt: skip

    @cached_property
    def changes(self) -> tuple[Change, ...]:
        """The changes since the results that the campaign was compared with."""
        return _CHANGES.validate_python(self.document.get("changes", ()))

    @property
    def rows(self) -> list[Error]:
        """All errors of runs, invariants and key figures, as one list."""
        return [*self.records, *self.invariants, *self.figures]

    @cached_property
    def linkages(self) -> tuple[Linkage, ...]:
        """The linkages as they were described when the campaign ran; raises DescriptionError for a damaged text."""
        return tuple(map(described_linkage, self.document["descriptions"]))

    @cached_property
    def motions(self) -> tuple[CrankMotion, ...]:
        """The crank motions of the campaign's regimes."""
        return tuple(map(described_motion, self.document["motions"]))

    @cached_property
    def regimes(self) -> tuple[str, ...]:
        """Names of the regimes of its runs, the linkages' own among them."""
        return tuple(dict.fromkeys(run.regime for run in self.runs))

    @cached_property
    def _curves(self) -> Mapping[tuple[str, ...], Mapping[str, Curve]]:
        """The curves of every run by the run's name."""
        return {run.run: run.curves for run in self.runs}

    def curve(self, run: Sequence[str], quantity: str) -> Curve:
        """The curve, ``CURVE``, (4, samples), of a run (mechanism, variant, regime, engine, setting) and quantity.

        Raises KeyError without one.
        """
        return self._curves[tuple(run)][quantity]


def document(
    request: CampaignRequest,
    command: str,
    readouts: Mapping[str, Mapping[str, Mapping[str, str]]] | None = None,
) -> dict[str, Any]:
    """A campaign as JSON-ready data without its runs; ``readouts`` are from ``Abilities.as_dict``, by engine.

    It has the required fields of ``SavedCampaign``. ``command`` is the command line that made it. The environment is
    that of now.
    """
    return {
        "command": command,
        "conditions": request.conditions,
        "environment": environment(request.engines),
        "readouts": dict(readouts or {}),
        "motions": [motion_row(motion) for motion in request.motions],
        "descriptions": [linkage_row(linkage) for linkage in request.linkages],
    }


def judgement(limits: LimitTable, figures: Iterable[Error], changes: Iterable[Change]) -> dict[str, Any]:
    """Limits, key figures and changes of a campaign, JSON-ready: the part that judging anew replaces.

    Keys are "limits", "figures" and "changes". ``figures`` are Error records whose ``error_max`` is the value.
    """
    rows = ((*figure[:4], figure.quantity, figure.error_max, figure.unit) for figure in figures)
    return {
        "limits": limits.as_dict,
        "figures": [dict(zip(KeyFigure.__annotations__, row, strict=True)) for row in rows],
        "changes": [{**asdict(entry), "sentence": entry.sentence} for entry in changes],
    }


def checksum(text: str) -> str:
    """The first 16 hexadecimal digits of the SHA-256 of a linkage file's text."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def with_runs(table: Mapping[str, Any], runs: Iterable[RunRecord]) -> dict[str, Any]:
    """A copy of the document with its runs added: a row per quantity and invariant, and details by run.

    They are under "records", "invariants" and "details", whose keys are those of the runs.
    """
    records = list(runs)
    return {
        **table,
        "records": [row for run in records for row in run.rows(run.errors)],
        "invariants": [row for run in records for row in run.rows(run.invariants)],
        "details": {run.key: dict(run.details) for run in records},
    }


def save(folder: Path, table: Mapping[str, Any], runs: Iterable[RunRecord]) -> None:
    """Write a campaign or judgement into a folder, replacing either of them there, and a designer's results.

    ``table`` is its document. Raises LinkproofError where the folder cannot be written.
    """
    kind = kind_of(table)
    save_study(folder, kind, table, ((run.key, *run.written()) for run in runs), {*KINDS, RESULTS} - {kind})


def kind_of(table: Mapping[str, Any]) -> str:
    """The kind of study that a document holds: JUDGE where it has a "judgement", else COMPARE."""
    return JUDGE if "judgement" in table else COMPARE


def is_saved(folder: Path) -> bool:
    """Whether a folder has a campaign or a judgement; raises LinkproofError for a file that cannot be used."""
    return any(has_study(folder, kind) for kind in KINDS)


def load(folder: Path) -> CampaignResults:
    """Read a saved campaign or judgement back; no engine is imported.

    Raises LinkproofError if it is missing or damaged.
    """
    kind = next((kind for kind in KINDS if has_study(folder, kind)), COMPARE)
    return CampaignResults(*load_study(folder, kind, FORM, RunRecord.from_row))


# The curves of a campaign as CSV: a row per run, quantity and sample.

SAMPLE: Final = ("time", "angle", "observed", "reference")
CURVE_COLUMNS: Final = ("mechanism", "variant", "regime", "engine", "setting", "quantity", "unit", *SAMPLE)


def write_curves(runs: Iterable[RunRecord], file: Path) -> None:
    """Write the curves of all runs into a CSV file, replacing it, with every digit of their few samples.

    Columns are ``CURVE_COLUMNS``: time is in s, angle, the true one of the crank, in rad (m of a linear drive),
    observed and reference in the unit. Raises OSError where the file cannot be written.
    """
    with file.open("w", encoding="utf-8", newline="") as opened:
        writer = csv.writer(opened, lineterminator="\n")
        writer.writerow(CURVE_COLUMNS)
        writer.writerows(_curve_rows(runs))


def _curve_rows(runs: Iterable[RunRecord]) -> Iterator[tuple[str | float, ...]]:
    """Yield the rows of the curves' CSV file, ``CURVE_COLUMNS``, a row for each sample of each curve."""
    for run in runs:
        for error in run.errors:
            if error.quantity in run.curves:
                time, angle, reference, beyond = run.curves[error.quantity].astype(float)
                columns = (column.tolist() for column in (time, angle, reference + beyond, reference))
                yield from ((*run.run, error.quantity, error.unit, *row) for row in zip(*columns, strict=True))
