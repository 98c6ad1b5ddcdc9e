"""``linkproof watch``: the page of a linkage file, rebuilt when the file changes, and saved back to it."""

from __future__ import annotations

import hashlib
import secrets
import sys
import webbrowser
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from mimetypes import guess_type
from pathlib import Path
from socket import SHUT_RDWR, socket
from tempfile import TemporaryDirectory
from threading import Lock, Thread
from typing import Final

from analytic.description import loading
from analytic.errors import LinkproofError
from analytic.files import read_file
from comparisons.designer.building import page_sheet
from comparisons.trials.runs.files import write_file
from reports.api.linkages import resolve
from reports.api.motions import requested_results
from reports.api.options import Motion
from reports.document import html
from reports.document.parts import Page, Paragraph
from reports.document.terminal import show
from reports.mechanism.page import page


def watch(mechanism: str, motion: Motion, *, opens: bool) -> None:
    """Serve the page of a linkage file until Ctrl-C, and open it in a browser if ``opens``.

    ``mechanism`` is the file's path. Prints the page's address on stderr; a fault in the file and an impossible motion
    are shown on the page. Raises LinkproofError for an installed linkage or a file that cannot be read, and where there
    is no browser to open.
    """
    file = _WatchedFile(mechanism, motion)
    try:
        browser = webbrowser.get() if opens else None
    except webbrowser.Error as error:
        raise LinkproofError("no browser on this machine: add --no-open, and open the printed address") from error
    with PageServer(file.page, file.save) as server:
        show(f"{server.address}\nThe page follows {mechanism}; Ctrl-C ends it.", stderr=True)
        if browser:
            Thread(target=browser.open, args=(server.address,), daemon=True).start()
        with suppress(KeyboardInterrupt):
            server.serve_forever()


class _WatchedFile:
    """A linkage file; the state of a page is a digest of the file that it shows."""

    def __init__(self, mechanism: str, motion: Motion) -> None:
        """Watch a user's own linkage file, ``mechanism``, its path; ``motion`` is that of the page.

        Raises LinkproofError for an installed linkage or a file that cannot be read.
        """
        if loading.read(mechanism).is_known:
            raise LinkproofError(
                f"expected a file of your own, got '{mechanism}', which is installed; copy it and name the copy"
            )
        self.motion, self.path = motion, Path(mechanism)
        self._lock, self._files = Lock(), {"state": b""}
        self._shown: Page | None = None  # of the file when it was last without a fault
        self._fault = ""

    def page(self) -> Mapping[str, bytes]:
        """The page's files by name, for the linkage file as it is now, with the file's digest as "state".

        They are built anew, and kept, only when the file has changed.
        """
        with self._lock:
            state = self._file_digest()
            if state.encode() != self._files["state"]:
                self._files = self._build_files(state)
            return self._files

    def save(self, text: str, state: str) -> None:
        """Replace the file by a page's text, if its ``state`` is still current; raises LinkproofError if not.

        So too if the file has a fault, the text is no TOML, or the file cannot be written. Line ends stay those of the
        file.
        """
        with self._lock:
            if self._file_digest() != state:
                raise LinkproofError(
                    f"{self.path.name} has changed since this page was built: nothing was written; copy what you "
                    "need, then reload the page"
                )
            if self._fault:
                raise LinkproofError(f"{self.path.name} has a fault, so nothing was written: correct it in an editor")
            loading.tables(text, self.path.name)
            ends = "\r\n" if b"\r\n" in read_file(self.path, "a linkage file") else "\n"
            write_file(self.path, text.replace("\n", ends).encode())

    def _file_digest(self) -> str:
        """The SHA-256 digest of the file's content in hexadecimal; "no file" if it cannot be read."""
        with suppress(LinkproofError):
            return hashlib.sha256(read_file(self.path, "a linkage file")).hexdigest()
        return "no file"

    def _build_files(self, state: str) -> dict[str, bytes]:
        """The page's files by name, with this ``state``; a fault in the linkage file is shown above the last good page.

        "state" is one of them. Keeps the fault, "" without one, and the page if it has none.
        """
        name = self.path.name
        self._fault = ""
        try:
            case, _ = requested_results(resolve(self.path, self.motion)[0], self.motion)
            self._shown = replace(page(page_sheet(case)), sections=())  # whose figures would not follow
        except LinkproofError as error:
            self._fault = str(error)
        shown = self._shown or Page("", name, name, "The page follows the file.", (), ())
        if self._fault:
            note = (Paragraph("Below is the linkage before this fault.", "small"),) if self._shown else ()
            shown = replace(shown, parts=(Paragraph(self._fault, "banner"), *note, *shown.parts))
        with TemporaryDirectory() as place:
            folder = Path(place)
            html.write_assets(folder)
            html.write(replace(shown, file="index.html", state=state), folder, ())
            files = [path for path in folder.rglob("*") if path.is_file()]
            contents = {file.relative_to(folder).as_posix(): file.read_bytes() for file in files}
        return {**contents, "state": state.encode()}


# A page served to the browsers of this machine alone: its address has a token, and only a click on it writes.


HOST: Final = "127.0.0.1"
MOST: Final = 4_000_000  # bytes of a text that is saved
MOST_OPEN: Final = 32  # requests at a time: one more ends the oldest
PATIENCE: Final = 10.0  # s without a byte of a request
HEADERS: Final = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "frame-ancestors 'none'",
    "Cross-Origin-Resource-Policy": "same-origin",
    "X-Content-Type-Options": "nosniff",
}


class PageServer(ThreadingHTTPServer):
    """Serves the files that ``page`` gives by name, on a free port of this machine.

    Among them are index.html and "state", by which a page notices that it has changed. ``address`` leads to it.
    ``save`` gets a text and the state of the page that it comes from; the LinkproofError that it raises is shown there.
    """

    def __init__(self, page: Callable[[], Mapping[str, bytes]], save: Callable[[str, str], None]) -> None:
        """Listen on a free port of this machine, under an address that cannot be guessed.

        ``page`` and ``save`` are those of the class.
        """
        self.page, self.save = page, save
        self._open: dict[socket, None] = {}
        super().__init__((HOST, 0), _Request)
        self.site = f"http://{HOST}:{self.server_port}"
        self.folder = f"/{secrets.token_urlsafe(24)}/"
        self.address = self.site + self.folder

    def process_request(self, request: socket, client_address: object) -> None:  # type: ignore[override]
        """Answer a request in a thread of its own; with more than ``MOST_OPEN`` open ones, end the oldest."""
        self._open[request] = None
        if len(self._open) > MOST_OPEN:
            with suppress(OSError):  # it has just ended
                oldest = next(iter(self._open))
                del self._open[oldest]
                oldest.shutdown(SHUT_RDWR)
        super().process_request(request, client_address)

    def shutdown_request(self, request: socket) -> None:  # type: ignore[override]
        """Close the connection of a request and no longer count it as open."""
        self._open.pop(request, None)
        super().shutdown_request(request)

    def handle_error(self, request: object, client_address: object) -> None:
        """Print an error of the server on stderr, unless a browser has only disconnected or was too slow."""
        if not isinstance(sys.exception(), ConnectionError | TimeoutError):
            super().handle_error(request, client_address)  # type: ignore[arg-type]


class _Request(BaseHTTPRequestHandler):
    """A request to a ``PageServer``: GET for a file of the page, POST to save a text; ``timeout`` is in s."""

    server: PageServer
    timeout = PATIENCE

    def do_GET(self) -> None:
        """Send a file of the page, index.html for its folder, 404 if there is no such file.

        A request that is not from this page gets 403.
        """
        name = self._requested_file()
        if name is not None:
            content = self.server.page().get(name or "index.html")
            status = HTTPStatus.NOT_FOUND if content is None else HTTPStatus.OK
            self._send_response(status, content or b"", guess_type(name or "index.html")[0] or "text/plain")

    def do_POST(self) -> None:
        """Save the text that a page sends to "save" and answer 200, or 409 with the reason if that fails.

        The state of the page is in the header If-Match. Refuses a request that is not from this page with 403; one to
        another name, without an Origin or a length, or longer than ``MOST`` bytes with 400.
        """
        name, length = self._requested_file(), self.headers.get("Content-Length", "")
        if name is None:
            return
        is_short = length.isascii() and length.isdecimal() and len(length) <= len(str(MOST)) and int(length) <= MOST
        if name != "save" or "Origin" not in self.headers or not is_short:
            self._send_response(HTTPStatus.BAD_REQUEST)
            return
        try:
            self.server.save(self.rfile.read(int(length)).decode(), self.headers.get("If-Match", ""))
        except (LinkproofError, UnicodeDecodeError) as error:
            self._send_response(HTTPStatus.CONFLICT, str(error).encode())
        else:
            self._send_response(HTTPStatus.OK)

    def _requested_file(self) -> str | None:
        """The requested file's name, "" for the folder; None, after sending 403, for a request not from this page."""
        folder, site, headers = self.server.folder, self.server.site, self.headers
        is_known = secrets.compare_digest(self.path[: len(folder)].encode(), folder.encode())
        if is_known and (headers.get_all("Host"), headers.get("Origin", site)) == ([site[len("http://") :]], site):
            return self.path.partition("?")[0].removeprefix(folder)
        self._send_response(HTTPStatus.FORBIDDEN)
        return None

    def _send_response(self, status: HTTPStatus, content: bytes = b"", kind: str = "text/plain") -> None:
        """Send a status and content, of a MIME ``kind`` in UTF-8, with the headers of every answer."""
        self.send_response(status)
        own = {"Content-Type": f"{kind}; charset=utf-8", "Content-Length": str(len(content))}
        for name, value in (HEADERS | own).items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *_: object) -> None:
        """Log nothing, unlike the base class, which prints every request."""
