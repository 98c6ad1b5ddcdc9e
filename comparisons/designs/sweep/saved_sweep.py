"""The folder of a sweep: its file grows in ``unfinished`` beside a journal of the blocks that are in it."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analytic.errors import LinkproofError
from comparisons.designs.sweep.sweep import Summary, SweepRequest
from comparisons.designs.sweep.sweep_file import FILE, SweepFile
from comparisons.runs.journal import FOLDER, HEADER, Journal

Array = NDArray[np.float64]

PATH: Final = "path"  # the key of that of the closed form
DATA: Final = "data"  # the folder in unfinished; the journal's own pieces stand beside it


@dataclass
class SavedSweep:
    """A request in a folder; ``about`` are the attributes of its file."""

    request: SweepRequest
    folder: Path
    about: Mapping[str, str | int]
    _journal: Journal | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        self.file = SweepFile(self.folder / FOLDER / DATA / FILE, self.request, self.about)
        self.holds_work = False
        self._made_for_it = [folder for folder in (self.folder, *self.folder.parents) if not folder.exists()]

    def check(self, command: str) -> None:
        """Raise LinkproofError where the folder has unfinished work of another ``command``, or too little room."""
        header = self.folder / FOLDER / HEADER
        begun = header.read_text(encoding="utf-8", errors="replace").partition("\n")[0] if header.is_file() else command
        if begun.split()[:2] != command.split()[:2]:
            raise LinkproofError(
                f"expected a folder of its own, got '{self.folder}' with unfinished work of `{begun}`: finish that, or "
                "give another folder"
            )
        self.file.check()

    def begin(self, journal: Journal) -> dict[int, Summary]:
        """Make the file, or find what is in it: summaries of blocks by number; ``request`` then takes their path."""
        self._journal = journal
        kept = journal.kept()
        path = kept.pop(PATH, None)
        finished = replace(self.file, path=self.folder / FILE)
        if kept and len(kept) == len(self.request.blocks) and not self.file.is_whole and finished.is_whole:
            os.replace(finished.path, self._made())  # all was done but to forget the journal
        if not kept or path is None or not self.file.is_whole:
            journal.clear()
            self._made()
            self.file.create()
            journal.keep(PATH, self.request.path.encode())
            return {}
        self.request = replace(self.request, path=path.decode())
        self.holds_work = True
        return {int(key): Summary.decoded(piece) for key, piece in kept.items()}

    def keep(self, number: int, first: int, found: Array, summary: Summary) -> None:
        """Write a block, then note that it is written."""
        assert self._journal is not None
        self.file.write(first, found)
        self._journal.keep(str(number), summary.encoded())
        self.holds_work = True

    def finish(self) -> None:
        """Put the file in its place."""
        assert self._journal is not None
        os.replace(self.file.path, self.folder / FILE)
        self._journal.clear()

    def forget(self) -> None:
        """Leave the folder as it was."""
        if self._journal is not None:
            self._journal.clear()
        with contextlib.suppress(OSError):  # another command may have written there
            for folder in self._made_for_it:
                folder.rmdir()

    def _made(self) -> Path:
        self.file.path.parent.mkdir(parents=True, exist_ok=True)
        return self.file.path
