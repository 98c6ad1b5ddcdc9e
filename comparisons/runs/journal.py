"""The journal of a request in hand: every finished piece of work in a file of its own, so that a kill costs none."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
from dataclasses import dataclass, field
from itertools import zip_longest
from pathlib import Path

from analytic.errors import LinkproofError
from comparisons.runs.files import Claim, claim, write_file

FOLDER = "unfinished"
HEADER = "request.txt"
_NAME_LENGTH = 100


@dataclass(frozen=True)
class Journal:
    """What is kept of a request in ``folder/unfinished`` until it is finished.

    ``request`` is the text that tells it from any other: first the command that began it, then, line by line, all
    else that decides its results, such as versions. From its first use on no other process may use the folder.
    """

    folder: Path
    request: str
    _claims: list[Claim] = field(default_factory=list, compare=False, repr=False)

    @property
    def place(self) -> Path:
        """The folder of the pieces."""
        return self.folder / FOLDER

    def kept(self) -> dict[str, bytes]:
        """Payloads kept so far, by key. What is torn or left over from another request is removed.

        Raises LinkproofError if the work begun there is another request's.
        """
        self._claim()
        self._check_header()
        found = {}
        for path in sorted(self.place.iterdir()) if self.place.is_dir() else ():
            if path.name == HEADER or not path.is_file():
                continue
            piece = self._piece(path.read_bytes())
            if piece is None or path != self._path(piece[0]):
                path.unlink()
            else:
                found[piece[0]] = piece[1]
        return found

    def keep(self, key: str, payload: bytes) -> None:
        """Keep one finished piece of work under its key, in one step; a piece already kept there is replaced."""
        self._claim()
        if not (self.place / HEADER).is_file():
            _write(self.place / HEADER, self.request.encode())
        title = {"key": key, "request": _digest(self.request.encode()), "digest": _digest(payload)}
        _write(self._path(key), json.dumps(title).encode() + b"\n" + payload)

    def clear(self) -> None:
        """Forget everything that is kept, of whatever request; a kill leaves all of it or nothing."""
        if self.folder.is_dir():
            self._claim()
        leaving = self.place.with_name(f".{FOLDER}")
        if leaving.is_dir():
            shutil.rmtree(leaving)
        if self.place.is_dir():
            self.place.rename(leaving)
            shutil.rmtree(leaving)

    def _claim(self) -> None:
        if not self._claims:
            self._claims.append(claim(self.folder))

    def _path(self, key: str) -> Path:
        """A file name that can be read, is allowed everywhere and differs for every key."""
        readable = re.sub(r"[^A-Za-z0-9._-]+", "-", key).strip("-.")[:_NAME_LENGTH]
        return self.place / f"{readable}.{_digest(key.encode())[:16]}"

    def _piece(self, content: bytes) -> tuple[str, bytes] | None:
        """Key and payload of a file's content; None if it is torn or not of this request."""
        line, _, payload = content.partition(b"\n")
        try:
            title = json.loads(line)
            key, request, digest = title["key"], title["request"], title["digest"]
        except (ValueError, KeyError, TypeError):
            return None
        if not isinstance(key, str) or request != _digest(self.request.encode()) or digest != _digest(payload):
            return None
        return key, payload

    def _check_header(self) -> None:
        header = self.place / HEADER
        begun = header.read_text(encoding="utf-8", errors="replace") if header.is_file() else self.request
        lines = zip_longest(begun.splitlines(), self.request.splitlines(), fillvalue="nothing")
        different = [(then, now) for then, now in lines if then != now]
        if not different:
            return
        expected, got = different[0]
        raise LinkproofError(
            f"expected the request that was begun in '{self.folder}': `{expected}`, got `{got}`; repeat it, or leave "
            "out --resume to start anew"
        )


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _write(path: Path, content: bytes) -> None:
    """Write a file in one step that a power failure does not undo by halves."""

    def fill(temporary: Path) -> None:
        with temporary.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())

    write_file(path, fill)
