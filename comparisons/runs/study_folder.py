"""A study in its folder: ``study.json``, its records with their curves, and the checksum of each file.

Every study has a folder of its name beneath the one that the user gives: ``compare``, ``judge``, ``bench``, ``stress``.
``sha256sum -c SHA256SUMS`` checks it as well.
"""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, is_dataclass
from pathlib import Path
from typing import Any, Final, TypeVar

from pydantic import TypeAdapter, ValidationError

from analytic.errors import LinkproofError
from comparisons.runs.files import claim, writing
from comparisons.runs.record_file import CURVES, RECORDS, Array, RecordFile

DOCUMENT: Final = "study.json"
SUMS: Final = "SHA256SUMS"
FORMAT: Final = 5  # of the files; it counts up where they change
REPEAT_HINT: Final = "run {} with --out again"

R = TypeVar("R")
WrittenRecord = tuple[str, Mapping[str, Any], Mapping[str, Array]]  # key, row and curves


def save_study(folder: Path, kind: str, document: Mapping[str, Any], records: Iterable[WrittenRecord]) -> None:
    """Write a study into ``folder/kind``, which is replaced as a whole once all is written.

    The records may come from a generator; they do not stay in memory.
    """
    lock, new = claim(folder), folder / f".{kind}.new"
    with writing(folder / kind):
        shutil.rmtree(new, ignore_errors=True)
        file = RecordFile(new)
        file.begin()
        for record in records:
            file.append(*record)
        file.finish()
        table = {"kind": kind, "format": FORMAT, **document}
        with (new / DOCUMENT).open("w", encoding="utf-8") as target:  # in pieces: there may be many key figures
            json.dump(table, target, indent=1, ensure_ascii=False, allow_nan=False, default=_json_value)
        sums = "".join(f"{_checksum_line(new / name)}\n" for name in (DOCUMENT, RECORDS, CURVES))
        (new / SUMS).write_text(sums, "utf-8")
        _replace_folder(folder / kind, new)
    del lock


def to_json(document: Mapping[str, Any]) -> str:
    """JSON text with records written out; NaN never appears."""
    return json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False, default=_json_value) + "\n"


def _json_value(value: object) -> object:
    """A data class as JSON has it, with its ``sentence`` if it has one; raises TypeError for anything else."""
    if not is_dataclass(value) or isinstance(value, type):
        raise TypeError(f"cannot write {type(value).__name__} as JSON")
    sentence = getattr(value, "sentence", None)
    return asdict(value) | ({"sentence": sentence} if sentence is not None else {})


def has_study(folder: Path, kind: str) -> bool:
    """Whether a folder has a study of this kind."""
    return (folder / kind / DOCUMENT).is_file()


def load_study(
    folder: Path, kind: str, form: TypeAdapter[Any], read: Callable[[Mapping[str, Any], Mapping[str, Array]], R]
) -> tuple[dict[str, Any], tuple[R, ...]]:
    """The document of a study, which has the ``form``, and its records, of which ``read`` makes each.

    Raises LinkproofError where the study is missing, damaged, or of another version.
    """
    place = folder / kind
    if not (place / DOCUMENT).is_file():
        raise LinkproofError(f"no results of {kind} in '{folder}': expected the folder given to {kind} --out")
    with study_errors(folder, kind):
        _check_sums(place)
        document = json.loads((place / DOCUMENT).read_text("utf-8"))
        if document["format"] != FORMAT:
            raise LinkproofError(
                f"'{place}' was made by another version of linkproof: {REPEAT_HINT.format(kind)}, into a new folder"
            )
        form.validate_python(document)
        file = RecordFile(place, may_be_torn=False)
        del document["kind"], document["format"]
        return document, tuple(read(*file.read(key)) for key in file.keys)


@contextmanager
def study_errors(folder: Path, kind: str) -> Iterator[None]:
    """Turn errors of reading a changed or damaged study into LinkproofError."""
    try:
        yield
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise LinkproofError(
            f"'{folder / kind}' cannot be used: {fault_words(error)}; {REPEAT_HINT.format(kind)}"
        ) from error


def _check_sums(place: Path) -> None:
    """Raise ValueError for a file that is not as it was written."""
    sums = (place / SUMS).read_text("utf-8").splitlines()
    for name in (DOCUMENT, RECORDS, CURVES):
        if _checksum_line(place / name) not in sums:
            raise ValueError(f"the checksum of {name} does not match: the file was changed after it was written")


def _checksum_line(path: Path) -> str:
    """A file's line among the checksums, as sha256sum writes it."""
    with path.open("rb") as file:
        return f"{hashlib.file_digest(file, 'sha256').hexdigest()}  {path.name}"


def _replace_folder(place: Path, new: Path) -> None:
    """Put a finished folder in the place of the one before."""
    old = place.with_name(f".{place.name}.old")
    shutil.rmtree(old, ignore_errors=True)
    if place.exists():
        place.rename(old)
    new.rename(place)
    shutil.rmtree(old, ignore_errors=True)


def first_fault(error: ValidationError) -> tuple[str, str]:
    """The key of the first wrong part, such as "cells.3.value", empty for the whole, and the fault in words."""
    first = error.errors(include_url=False, include_input=False)[0]
    return ".".join(map(str, first["loc"])), first["msg"]


def fault_words(error: Exception) -> str:
    """Why a saved file cannot be read: the first fault with its key of a ValidationError, else the error's text."""
    return ": ".join(first_fault(error)) if isinstance(error, ValidationError) else str(error)
