"""Linkages and motions as results folders hold them, and the cases of ``results --out``, of which pages make sheets."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Final

from pydantic import Field, TypeAdapter
from typing_extensions import TypedDict

from analytic.description.crank_motion import CrankMotion, Segment
from analytic.description.linkage import Linkage
from analytic.description.loading import parse
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Case, case_of_file_regime
from comparisons.trials.runs.store import has_study, load_study, save_study

RESULTS: Final = "results"


class LinkageRow(TypedDict):
    """A linkage as it was described, under a gravity, m/s²."""

    name: str
    variant: str
    gravity: tuple[float, float]
    text: str


class MotionRow(TypedDict):
    """A crank motion: its pieces from one instant to another, s, each a polynomial of the angle, rad."""

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
    """The row that saves a linkage."""
    return LinkageRow(name=linkage.name, variant=linkage.variant, gravity=linkage.gravity, text=linkage.text)


def described_linkage(row: LinkageRow) -> Linkage:
    """The linkage that a row saved, under its gravity; raises DescriptionError for a damaged text."""
    own = parse(row["text"], row["name"], row["name"], row["variant"])
    return replace(own, gravity=(row["gravity"][0], row["gravity"][1]))


def motion_row(motion: CrankMotion) -> MotionRow:
    """The row that saves a motion."""
    segments = [(piece.start, piece.end, list(piece.coefficients)) for piece in motion.segments]
    return MotionRow(regime=motion.regime, segments=segments)


def described_motion(row: MotionRow) -> CrankMotion:
    """The motion that a row saved."""
    return CrankMotion(row["regime"], tuple(Segment(start, end, tuple(c)) for start, end, c in row["segments"]))


def save_case(folder: Path, case: Case) -> None:
    """Write a case into a folder, replacing an earlier one of its linkage and variant; it becomes the last."""
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
    """The key of a saved case: mechanism/variant."""
    return f"{row['linkage']['name']}/{row['linkage']['variant']}"


def load_cases(folder: Path) -> list[Case]:
    """The saved cases of a folder, [] without any; raises LinkproofError for a damaged one."""
    return [*map(_case_of_row, _load_rows(folder))] if has_study(folder, RESULTS) else []


def _load_rows(folder: Path) -> tuple[CaseRow, ...]:
    """The saved cases of a folder as rows; raises LinkproofError for a damaged or missing file."""
    return load_study(folder, RESULTS, TypeAdapter(dict[str, Any]), lambda row, _: CASE.validate_python(row))[1]


def _case_of_row(row: CaseRow) -> Case:
    """The case that a row saved; a released crank's motion is computed anew."""
    mechanism = Mechanism(described_linkage(row["linkage"]))
    if row["motion"] is not None:
        return Case(mechanism, described_motion(row["motion"]), conditions=row["conditions"])
    case = case_of_file_regime(mechanism, mechanism.linkage.released[row["regime"]])
    return replace(case, mechanism=mechanism)  # a torque over the angle is the drive's, not a load
