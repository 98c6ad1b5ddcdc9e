"""``linkproof watch``: the page of a linkage file, rebuilt when the file changes, and saved back to it."""

from __future__ import annotations

import hashlib
import webbrowser
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Lock, Thread

from analytic.description import loading
from analytic.errors import LinkproofError
from comparisons.datasheet.building import page_sheet
from comparisons.runs.files import write_bytes
from reports.document import html
from reports.document.parts import Page, Paragraph, Widget
from reports.document.terminal import show
from reports.live.server import PageServer
from reports.mechanism.page import page
from reports.requests.case import requested_results
from reports.requests.motion_options import WatchOptions


def watch(options: WatchOptions) -> None:
    """Serve the page of a file until Ctrl-C."""
    file = _WatchedFile(options)
    try:
        browser = webbrowser.get() if options.opens else None
    except webbrowser.Error as error:
        raise LinkproofError("no browser on this machine: add --no-open, and open the printed address") from error
    with PageServer(file.page, file.save) as server:
        show(f"page: {server.address}; Ctrl-C ends it", stderr=True)
        if browser:
            Thread(target=browser.open, args=(server.address,), daemon=True).start()
        with suppress(KeyboardInterrupt):
            server.serve_forever()


class _WatchedFile:
    """A linkage file; the state of a page is a digest of the file that it shows."""

    def __init__(self, options: WatchOptions) -> None:
        if loading.read(options.mechanism).is_known:
            raise LinkproofError(
                f"expected a file of your own, got '{options.mechanism}', which is installed; copy it and name the copy"
            )
        self.options, self.path = options, Path(options.mechanism)
        self._lock, self._files = Lock(), {"state": b""}

    def page(self) -> Mapping[str, bytes]:
        """The files of the page of the file as it is now, and its state."""
        with self._lock:
            state = self._file_digest()
            if state.encode() != self._files["state"]:
                self._files = self._build_files(state)
            return self._files

    def save(self, text: str, state: str) -> None:
        """Replace the file that a page of ``state`` shows; its line ends stay. Raises LinkproofError."""
        with self._lock:
            if self._file_digest() != state:
                raise LinkproofError(
                    f"{self.path.name} has changed since this page was built: nothing was written; copy what you "
                    "need, then reload the page"
                )
            loading.tables(text, self.path.name)
            ends = "\r\n" if b"\r\n" in self.path.read_bytes() else "\n"
            write_bytes(self.path, text.replace("\n", ends).encode())

    def _file_digest(self) -> str:
        with suppress(OSError):
            return hashlib.sha256(self.path.read_bytes()).hexdigest()
        return "no file"

    def _build_files(self, state: str) -> dict[str, bytes]:
        """The files of the page of the linkage, or of the error in its file."""
        name = self.path.name
        try:
            case, _ = requested_results(loading.load(self.options.mechanism, self.options.variant), self.options)
            shown = page(page_sheet(case))
        except LinkproofError as error:
            shown = Page("", name, name, "The page follows the file.", (Paragraph(str(error), "verdict"),), ())
        if any(isinstance(part, Widget) for part in shown.parts):
            shown = replace(shown, sections=())  # its figures would not follow
        with TemporaryDirectory() as place:
            folder = Path(place)
            html.write_assets(folder)
            html.write(replace(shown, file="index.html", state=state), folder, ())
            files = [path for path in folder.rglob("*") if path.is_file()]
            byteses = {file.relative_to(folder).as_posix(): file.read_bytes() for file in files}
        return {**byteses, "state": state.encode()}
