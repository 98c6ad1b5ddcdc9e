"""Folders of several machines joined: each copied whole into a subfolder, with one list of them, no run twice."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Final

from analytic.errors import LinkproofError
from comparisons.campaign.results import KINDS
from comparisons.datasheet.saved import FILE as SHEETS
from comparisons.folders.studies import OTHER_CHARACTERS, StudyFolder, numbered
from comparisons.runs.files import claim, write_file, write_text, writing
from comparisons.runs.study_folder import has_study
from comparisons.stress.saved import KIND as STRESS
from comparisons.work_precision.records import KIND as BENCH

LIST: Final = "merged.json"
STUDIES: Final = (*KINDS, BENCH, STRESS)


@dataclass(frozen=True)
class MergedFolder(StudyFolder):
    """One folder of those that are joined: where it is, and the name it has among them."""

    name: str

    @cached_property
    def environment(self) -> Mapping[str, str]:
        """The environment of the folder's runs; raises LinkproofError without a run, or for several machines."""
        studies = [study.document for study in (self.campaign, self.bench, self.stress) if study is not None]
        if not studies:
            raise LinkproofError(
                f"nothing to merge in '{self.path}': expected the folder given to --out of compare, bench or stress"
            )
        machines = dict.fromkeys(document["environment"]["machine"] for document in studies)
        if len(machines) > 1:
            raise LinkproofError(
                f"expected the work of one machine in '{self.path}', got that of {' and of '.join(machines)}: make "
                "the studies again in folders of their own"
            )
        names: Mapping[str, str] = studies[0]["environment"]
        return names

    @property
    def machine(self) -> str:
        """The hardware."""
        return self.environment["machine"]

    @cached_property
    def runs(self) -> frozenset[str]:
        """The names of the runs, unique on one machine."""
        campaign, bench, stress = self.campaign, self.bench, self.stress
        return frozenset((
            *(f"compare {run.key}, {run.conditions}" for run in (campaign.runs if campaign else ())),
            *(f"bench {point.key}" for point in (bench.points if bench else ())),
            *(f"stress {cell.key}" for cell in (stress.cells if stress else ())),
        ))  # fmt: skip


def folders_to_merge(paths: Sequence[Path]) -> tuple[MergedFolder, ...]:
    """The folders to join, those of a folder that is joined already one by one.

    Raises LinkproofError for one that holds nothing, and where one machine made the same run twice.
    """
    result = [place for path in paths for place in (merged_folders(path) or [path])]
    stems = (re.sub(OTHER_CHARACTERS, "-", path.resolve().name).strip(".") or "folder" for path in result)
    folders = [MergedFolder(path, name) for path, name in zip(result, numbered(stems), strict=True)]
    seen: dict[tuple[str, str], Path] = {}
    for folder in folders:
        machine = folder.machine
        for run in sorted(folder.runs):
            if (machine, run) in seen:
                raise LinkproofError(
                    f"expected every run once, got {run} of one machine in '{seen[machine, run]}' and in "
                    f"'{folder.path}': leave one out, or see what has moved with linkproof diff"
                )
            seen[machine, run] = folder.path
    return tuple(folders)


def merged_folders(path: Path) -> list[Path]:
    """The subfolders of a folder that ``merge`` wrote, else empty; raises LinkproofError for a damaged list."""
    file = path / LIST
    if not file.is_file():
        return []
    try:
        document = json.loads(file.read_text(encoding="utf-8"))
        names = [str.strip(name) for name in document["folders"] if Path(name).name == name]
        if document["format"] != 1 or not names or len(names) != len(document["folders"]):
            raise ValueError(f"got {document}")
    except (OSError, ValueError, TypeError, KeyError) as error:
        raise LinkproofError(f"'{file}' is no list of merged folders ({error}); merge them again") from error
    return [path / name for name in names]


def merge(folders: Sequence[MergedFolder], out: Path) -> tuple[MergedFolder, ...]:
    """Copy the data of folders into a new one; returns them in their new places. The list is written last.

    Raises LinkproofError where ``out`` holds something already, or cannot be written.
    """
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise LinkproofError(f"expected a new or an empty folder to merge into, got '{out}': give another")
    lock = claim(out)
    for folder in folders:
        for kind in STUDIES:
            if has_study(folder.path, kind):
                with writing(out / folder.name / kind):
                    shutil.copytree(folder.path / kind, out / folder.name / kind)
        if (folder.path / SHEETS).is_file():
            write_file(out / folder.name / SHEETS, partial(shutil.copyfile, folder.path / SHEETS))
    names = [folder.name for folder in folders]
    write_text(out / LIST, json.dumps({"format": 1, "folders": names}, indent=1, ensure_ascii=False) + "\n")
    del lock
    return tuple(MergedFolder(out / name, name) for name in names)
