"""A study in its folder: ``study.json``, its records with their curves, and the checksum of each file.

Every study has a folder of its name beneath the one that the user gives: ``compare``, ``judge``, ``bench``, ``stress``.
``sha256sum -c SHA256SUMS`` checks it as well.
"""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, is_dataclass
from pathlib import Path
from typing import Any, Final

from pydantic import TypeAdapter

from analytic.errors import LinkproofError
from comparisons.runs.damage import fault_words
from comparisons.runs.files import claim, writing
from comparisons.runs.record_file import CURVES, RECORDS, Array, RecordFile

DOCUMENT: Final = "study.json"
SUMS: Final = "SHA256SUMS"
FORMAT: Final = 4  # the files of versions before had 1 to 3
AGAIN: Final = "run {} with --out again"
# What versions before wrote instead.
OLD_FILES: Final = {"compare": "curves.nc", "judge": "curves.nc", "bench": "bench.json", "stress": "stress.json"}

WrittenRecord = tuple[str, Mapping[str, Any], Mapping[str, Array]]  # key, row and curves


@dataclass(frozen=True)
class SavedStudy:
    """A study read back: its ``document`` has all but the ``records``."""

    document: dict[str, Any]
    records: RecordFile

    def rows(self) -> Iterator[dict[str, Any]]:
        """Every record without its curves, in the order in which they were written."""
        return (self.records.row(key) for key in self.records.keys)


def save_study(folder: Path, kind: str, document: Mapping[str, Any], records: Iterable[WrittenRecord]) -> None:
    """Write a study into ``folder/kind``, which is replaced as a whole once all is written.

    The records may come from a generator: none stays in memory.
    """
    held, new = claim(folder), folder / f".{kind}.new"
    with writing(folder / kind):
        shutil.rmtree(new, ignore_errors=True)
        file = RecordFile(new)
        file.begin()
        for record in records:
            file.append(*record)
        file.finish()
        told = {"kind": kind, "format": FORMAT, **document}
        with (new / DOCUMENT).open("w", encoding="utf-8") as target:  # in pieces: there may be many key figures
            json.dump(told, target, indent=1, ensure_ascii=False, allow_nan=False, default=plain)
        sums = "".join(f"{_sum(new / name)}\n" for name in (DOCUMENT, RECORDS, CURVES))
        (new / SUMS).write_text(sums, "utf-8")
        _replace(folder / kind, new)
    del held


def plain(value: object) -> object:
    """A data class as JSON has it, with its ``sentence`` if it has one; raises TypeError for anything else."""
    if not is_dataclass(value) or isinstance(value, type):
        raise TypeError(f"cannot write {type(value).__name__} as JSON")
    sentence = getattr(value, "sentence", None)
    return asdict(value) | ({"sentence": sentence} if sentence is not None else {})


def has_study(folder: Path, kind: str) -> bool:
    """Whether a folder has a study of this kind, of this version or of one before."""
    return (folder / kind / DOCUMENT).is_file() or (folder / OLD_FILES[kind]).is_file()


def load_study(folder: Path, kind: str, form: TypeAdapter[Any]) -> SavedStudy:
    """Read a study back; raises LinkproofError where it is missing, damaged, or of another version.

    ``form`` is that of its document.
    """
    place, old = folder / kind, folder / OLD_FILES[kind]
    if not (place / DOCUMENT).is_file():
        if old.is_file():
            raise LinkproofError(f"'{old}' is of an earlier version of linkproof: {AGAIN.format(kind)}")
        raise LinkproofError(f"no results of {kind} in '{folder}': expected the folder given to {kind} --out")
    with usable(folder, kind):
        _check_sums(place)
        document = json.loads((place / DOCUMENT).read_text("utf-8"))
        if document["format"] != FORMAT:
            raise ValueError(f"expected format {FORMAT}, got {document['format']}, of another version")
        form.validate_python(document)
        return SavedStudy(document, RecordFile(place, may_be_torn=False))


@contextmanager
def usable(folder: Path, kind: str) -> Iterator[None]:
    """Raise LinkproofError where what is done inside finds a study that is not as it was written."""
    try:
        yield
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise LinkproofError(f"'{folder / kind}' cannot be used: {fault_words(error)}; {AGAIN.format(kind)}") from error


def _check_sums(place: Path) -> None:
    """Raise ValueError for a file that is not as it was written."""
    sums = (place / SUMS).read_text("utf-8").splitlines()
    for name in (DOCUMENT, RECORDS, CURVES):
        if _sum(place / name) not in sums:
            raise ValueError(f"the checksum of {name} does not match: the file was changed after it was written")


def _sum(path: Path) -> str:
    """A file's line among the checksums, as sha256sum writes it."""
    with path.open("rb") as file:
        return f"{hashlib.file_digest(file, 'sha256').hexdigest()}  {path.name}"


def _replace(place: Path, new: Path) -> None:
    """Put a finished folder in the place of the one before."""
    old = place.with_name(f".{place.name}.old")
    shutil.rmtree(old, ignore_errors=True)
    if place.exists():
        place.rename(old)
    new.rename(place)
    shutil.rmtree(old, ignore_errors=True)
