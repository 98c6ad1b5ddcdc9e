"""linkproof watch: a page of this machine's own, which follows its file; nothing else reads it or writes."""

import socket
import webbrowser
from http.client import HTTPConnection
from unittest.mock import Mock
from urllib.parse import urlsplit

import pytest

from analytic.description.loading import load
from tests.commands import refused, watching

STEADY = "# my own\n" + load("teaching-four-bar").text


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    """A file and the address of its page."""
    file = tmp_path_factory.mktemp("watched") / "mine.toml"
    file.write_text(STEADY, encoding="utf-8")
    with watching(file) as address:
        yield file, urlsplit(address)


@pytest.fixture
def watched(served):
    """The same, the file as it was at first."""
    served[0].write_text(STEADY, encoding="utf-8")
    return served


def answer(place, method="GET", name="", headers=(), body=None):
    """Status, headers and text of a request; a header of None is left out."""
    headers = {"Host": place.netloc, **dict(headers)}
    connection = HTTPConnection(place.hostname, place.port)
    connection.putrequest(method, name if name.startswith("/") else place.path + name, skip_host=True)
    for key, value in {"Content-Length": len(body or "") if method == "POST" else None, **headers}.items():
        if value is not None:
            connection.putheader(key, str(value))
    connection.endheaders((body or "").encode())
    found = connection.getresponse()
    return found.status, found.headers, found.read().decode(errors="replace")


def state(place):
    """The headers of a page that shows the file as it is."""
    return {"Origin": f"http://{place.netloc}", "If-Match": answer(place, name="state")[2]}


@pytest.mark.parametrize(
    ("method", "name", "headers", "status"),
    [
        ("GET", "", {"Host": "evil.example"}, 403),  # a name that leads here
        ("GET", "", {"Origin": "http://evil.example"}, 403),
        ("GET", "/", {}, 403),
        ("GET", "state", {"Origin": "null"}, 403),  # a page from the disk, or in a frame
        ("GET", "/" + "0" * 32 + "/state", {}, 403),
        ("GET", "mine.toml", {}, 404),
        ("GET", "%2e%2e/%2e%2e/etc/passwd", {}, 404),
        ("OPTIONS", "save", {}, 501),  # what a browser would send before a request of another site
        ("POST", "/save", {}, 403),
        ("POST", "mine.toml", {}, 400),
        ("POST", "save", {"Content-Length": None}, 400),
        ("POST", "save", {"Host": "evil.example"}, 403),
        ("POST", "save", {"Origin": "http://evil.example"}, 403),
        ("POST", "save", {"Origin": None}, 400),
        ("POST", "save", {"If-Match": "0" * 64}, 409),
        ("POST", "save", {"Content-Length": 10**9}, 400),
        ("POST", "save", {"Content-Length": "1" * 5000}, 400),
    ],
)
def test_nothing_but_its_own_page_reads_or_writes(watched, method, name, headers, status):
    file, place = watched
    given = {**(state(place) if method == "POST" else {}), **headers}
    code, _, text = answer(place, method, name, given, "title = 'theirs'" if method == "POST" else None)
    assert code == status
    assert "my own" not in text
    assert file.read_text(encoding="utf-8") == STEADY


def test_a_page_may_not_be_framed_embedded_or_kept(watched):
    code, headers, text = answer(watched[1])
    assert code == 200
    assert "linkproof-state" in text
    assert headers["Cache-Control"] == "no-store"
    assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]
    assert headers["Cross-Origin-Resource-Policy"] == "same-origin"
    assert "Access-Control-Allow-Origin" not in headers


def test_it_saves_over_the_file_that_it_shows_and_over_no_other(watched):
    file, place = watched
    file.write_bytes(STEADY.replace("\n", "\r\n").encode())
    before = state(place)
    heavier = STEADY.replace("my own", "mine again")
    assert answer(place, "POST", "save", before, heavier)[0] == 200
    assert file.read_bytes() == heavier.replace("\n", "\r\n").encode()
    code, _, text = answer(place, "POST", "save", before, STEADY)
    assert (code, "mine.toml has changed since this page was built: nothing was written" in text) == (409, True)
    code, _, text = answer(place, "POST", "save", state(place), "title = 'half")
    assert (code, "mine.toml:1: not valid TOML" in text) == (409, True)
    assert file.read_bytes() == heavier.replace("\n", "\r\n").encode()


def test_a_fault_in_the_file_is_on_the_page_with_its_line(watched):
    file, place = watched
    file.write_text(STEADY.replace("# my own", '"<b>not" = 1'), encoding="utf-8")
    text = answer(place)[2]
    assert "mine.toml:1:" in text
    assert "&lt;b&gt;not" in text
    assert "<b>not" not in text
    assert 'data-kind="live"' in text  # the linkage as it was
    code, _, reason = answer(place, "POST", "save", state(place), STEADY)
    assert (code, "mine.toml has a fault" in reason) == (409, True)
    file.unlink()
    assert "does not exist" in answer(place)[2]
    code, _, reason = answer(place, "POST", "save", state(place), STEADY)
    assert (code, "nothing was written" in reason, file.exists()) == (409, True, False)


def test_many_half_sent_requests_keep_nobody_else_out(watched):
    place = watched[1]
    half = [socket.create_connection((place.hostname, place.port)) for _ in range(100)]
    for one in half:
        one.sendall(b"POST /save HTTP/1.1\r\nContent-Length: 9\r\n")
    assert answer(place, name="state")[0] == 200
    half[0].settimeout(60)
    assert half[0].recv(1) == b""  # the oldest has been ended
    for one in half:
        one.close()


def test_what_cannot_be_watched_is_refused_in_a_sentence(tmp_path, monkeypatch):
    file = tmp_path / "mine.toml"
    file.write_text(STEADY, encoding="utf-8")
    assert "does not exist" in refused("watch", tmp_path / "none.toml", "--no-open")
    assert "expected a file of your own" in refused("watch", "juki-mf7923d", "--no-open")
    monkeypatch.setattr("webbrowser.get", Mock(side_effect=webbrowser.Error))
    assert "no browser on this machine" in refused("watch", file)
