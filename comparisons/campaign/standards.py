"""A user's own standard: limits of a file, a baseline beside the linkages, and what results are under it."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from analytic.description.loading import LinkageFile
from comparisons.judging.baseline import Place
from comparisons.judging.run_result import RunResult
from comparisons.judging.verdicts import Standard


def places(files: Iterable[LinkageFile], folder: Path) -> dict[str, Place]:
    """Where linkages stand in a baseline in a folder, by name: the path from there, or the catalogue's own name."""
    return {file.name: Place(_path(file, folder), checksum(file.text)) for file in files}


def _path(file: LinkageFile, folder: Path) -> str:
    if file.is_shipped:
        return file.name
    return Path(os.path.relpath(Path(file.origin).resolve(), folder.resolve())).as_posix()


def checksum(text: str) -> str:
    """What tells one text of a linkage file from another."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def rejudged(result: RunResult, standard: Standard) -> RunResult:
    """A result under another standard; what was measured stays."""
    return replace(
        result,
        records=tuple(map(standard.judge, result.records)),
        invariants=tuple(map(standard.judge, result.invariants)),
    )
