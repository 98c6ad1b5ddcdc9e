"""Data sheets as a file beside a campaign's curves: ``mechanisms.json``."""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from pydantic import TypeAdapter, ValidationError

from analytic.errors import LinkproofError
from comparisons.datasheet.sheet import Sheet
from comparisons.runs.files import write_text
from comparisons.runs.study_folder import first_fault

FILE: Final = "mechanisms.json"
REMEDY: Final = "run compare with --out again"


@dataclass(frozen=True)
class SavedSheets:
    """Contents of the file: the sheets, preceded by a digest of them."""

    format: Literal[2]
    digest: str
    sheets: tuple[Sheet, ...]


SCHEMA: Final = TypeAdapter(SavedSheets)
SHEETS_KEY: Final = b'"sheets":'


def save_sheets(folder: Path, sheets: Sequence[Sheet]) -> None:
    """Write the sheets into a folder, in one step."""
    _, mark, body = SCHEMA.dump_json(SavedSheets(2, "", tuple(sheets))).partition(SHEETS_KEY)
    text = f'{{"format":2,"digest":"{_checksum(body)}",{(mark + body).decode()}'
    write_text(folder / FILE, text)


def load_sheets(folder: Path) -> tuple[Sheet, ...]:
    """The sheets of a folder; raises LinkproofError, which names the key, for a file that is missing or damaged."""
    path = folder / FILE
    if not path.is_file():
        raise LinkproofError(f"no data sheets of the mechanisms at '{path}': {REMEDY}")
    try:
        content = path.read_bytes()
        result = SCHEMA.validate_json(content, strict=True)
    except ValidationError as error:
        if first_fault(error)[0] == "format":
            raise LinkproofError(f"'{path}' was written by another version of linkproof: delete it") from error
        raise _damage_error(path, *first_fault(error)) from error
    except OSError as error:
        raise LinkproofError(f"cannot read '{path}': {error.strerror}; {REMEDY}") from error
    if _checksum(content.partition(SHEETS_KEY)[2]) != result.digest:
        raise _damage_error(path, "sheets", "the checksum does not match, so the file was changed after it was written")
    return result.sheets


def _checksum(body: bytes) -> str:
    """A few letters that change with every damage."""
    return f"{zlib.crc32(body):08x}"


def _damage_error(path: Path, key: str, reason: str) -> LinkproofError:
    return LinkproofError(f"'{path}' is damaged at {key or 'its start'}: {reason}; {REMEDY}")
