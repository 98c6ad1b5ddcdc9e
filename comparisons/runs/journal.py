"""The journal of a request: its finished records, appended one by one, so that a killed process loses none."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import zip_longest
from pathlib import Path
from typing import Any, Final

from analytic.errors import LinkproofError
from comparisons.runs.files import Claim, claim, write_text, writing
from comparisons.runs.record_file import CURVES, RECORDS, Array, RecordFile

FOLDER: Final = "unfinished"
HEADER: Final = "request.txt"


@dataclass(frozen=True)
class Journal:
    """The finished records of a request, in ``folder/unfinished`` until all are there.

    ``request`` is the text that tells it from any other: first the command that began it, then, line by line, all
    else that decides its results, such as versions. From its first use on no other process may use the folder.
    """

    folder: Path
    request: str

    @property
    def place(self) -> Path:
        """The folder of the records."""
        return self.folder / FOLDER

    @cached_property
    def records(self) -> RecordFile:
        """The records finished so far. Raises LinkproofError if the folder contains the journal of another request."""
        _ = self._claim
        header = self.place / HEADER
        if header.is_file():
            self._check_header(header)
        else:
            for name in (RECORDS, CURVES):  # of an unknown request
                (self.place / name).unlink(missing_ok=True)
            write_text(header, self.request)
        return RecordFile(self.place, survives_power_failure=True)

    def keep(self, key: str, row: Mapping[str, Any], curves: Mapping[str, Array] | None = None) -> None:
        """Write one finished record under its key; a record already there is replaced."""
        with writing(self.place):
            self.records.append(key, row, curves)

    def clear(self) -> None:
        """Remove everything there, of whatever request; a kill leaves all of it or nothing."""
        if self.folder.is_dir():
            _ = self._claim
        vars(self).pop("records", None)
        leaving = self.place.with_name(f".{FOLDER}")
        if leaving.is_dir():
            shutil.rmtree(leaving)
        if self.place.is_dir():
            self.place.rename(leaving)
            shutil.rmtree(leaving)

    @cached_property
    def _claim(self) -> Claim:
        return claim(self.folder)

    def _check_header(self, header: Path) -> None:
        begun = header.read_text(encoding="utf-8", errors="replace")
        lines = zip_longest(begun.splitlines(), self.request.splitlines(), fillvalue="nothing")
        different = [(then, now) for then, now in lines if then != now]
        if not different:
            return
        expected, got = different[0]
        raise LinkproofError(
            f"expected the request that was begun in '{self.folder}': `{expected}`, got `{got}`; repeat it, or leave "
            "out --resume to start anew"
        )
