"""A page served to the browsers of this machine alone: its address has a token, and only a click on it writes.

Pages of other sites can send requests to any port of this machine. They do not know the token; a name that leads here
(DNS rebinding) is refused by the host of the request, a form or a script of another site by its origin.
"""

from __future__ import annotations

import secrets
import sys
from collections.abc import Callable, Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from mimetypes import guess_type
from typing import Final

from analytic.errors import LinkproofError

HOST: Final = "127.0.0.1"
MOST: Final = 4_000_000  # bytes of a text that is saved
HEADERS: Final = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "frame-ancestors 'none'",
    "Cross-Origin-Resource-Policy": "same-origin",
    "X-Content-Type-Options": "nosniff",
}


class PageServer(ThreadingHTTPServer):
    """Serves the files that ``page`` gives by name, on a free port of this machine.

    Among them are index.html and "state", by which a page notices that it has changed. ``address`` leads to it.
    ``save`` gets a text and the state of the page that it comes from; what it raises is shown on that page.
    """

    def __init__(self, page: Callable[[], Mapping[str, bytes]], save: Callable[[str, str], None]) -> None:
        self.page, self.save = page, save
        super().__init__((HOST, 0), _Request)
        self.site = f"http://{HOST}:{self.server_port}"
        self.folder = f"/{secrets.token_urlsafe(24)}/"
        self.address = self.site + self.folder

    def handle_error(self, request: object, client_address: object) -> None:
        """Print an error of the server, but for a browser that has disconnected."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)  # type: ignore[arg-type]


class _Request(BaseHTTPRequestHandler):
    server: PageServer

    def do_GET(self) -> None:
        """A file of the page."""
        name = self._name()
        if name is not None:
            content = self.server.page().get(name or "index.html")
            status = HTTPStatus.NOT_FOUND if content is None else HTTPStatus.OK
            self._send_response(status, content or b"", guess_type(name or "index.html")[0] or "text/plain")

    def do_POST(self) -> None:
        """The text that a click on the page saves."""
        name, length = self._name(), self.headers.get("Content-Length", "")
        if name is None:
            return
        if name != "save" or "Origin" not in self.headers or not length.isdecimal() or int(length) > MOST:
            self._send_response(HTTPStatus.BAD_REQUEST)
            return
        try:
            self.server.save(self.rfile.read(int(length)).decode(), self.headers.get("If-Match", ""))
        except (LinkproofError, UnicodeDecodeError) as error:
            self._send_response(HTTPStatus.CONFLICT, str(error).encode())
        else:
            self._send_response(HTTPStatus.OK)

    def _name(self) -> str | None:
        """The file that is requested; None where the request is refused: it is not this page's, nor a reader's own."""
        folder, site, headers = self.server.folder, self.server.site, self.headers
        is_known = secrets.compare_digest(self.path[: len(folder)].encode(), folder.encode())
        if is_known and (headers.get_all("Host"), headers.get("Origin", site)) == ([site[len("http://") :]], site):
            return self.path.partition("?")[0].removeprefix(folder)
        self._send_response(HTTPStatus.FORBIDDEN)
        return None

    def _send_response(self, status: HTTPStatus, content: bytes = b"", kind: str = "text/plain") -> None:
        self.send_response(status)
        own = {"Content-Type": f"{kind}; charset=utf-8", "Content-Length": str(len(content))}
        for name, value in (HEADERS | own).items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *_: object) -> None:
        """Nothing: requests are not news."""
