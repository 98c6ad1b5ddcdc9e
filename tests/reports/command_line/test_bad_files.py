"""Every option, argument and function with a path, given what is no such file: a sentence and exit code 2, soon."""

import os
import resource
import signal
from contextlib import contextmanager
from pathlib import Path

import pytest

from analytic.errors import LinkproofError
from tests.commands import linkproof as command
from tests.commands import process, refused

SECONDS, MEMORY = 10, 300 << 20  # on a busy machine, and beyond what is used already
LINKAGE = "four-bar.toml"
TOLERANCES = 'results = ["Mkr.peak"]\nspeed = 1000\n[tolerances]\n"rocker.C.x" = 0.1\n'

READ = {
    "linkage of check": (".toml", "check {}"),
    "linkage of list": (".toml", "list {}"),
    "linkage of results": (".toml", "results {}"),
    "linkage of watch": (".toml", "watch {} --no-open"),
    "linkage of sweep": (".toml", "sweep {} --vary rocker.C.x=10:20:3"),
    "linkage of optimise": (".toml", "optimise {} --minimise Mkr.peak --over rocker.C.x=10:20"),
    "linkage of tolerance": (".toml", "tolerance {} tolerances.toml"),
    "linkage of judge": (".toml", "judge {} results.csv"),
    "linkage of compare": (".toml", "compare {} --engine direct --jobs 0"),
    "linkage of compare --script": (".toml", "compare {} --engine mujoco --script run.py"),
    "linkage of bench": (".toml", "bench {} --engine direct"),
    "tolerances": (".toml", "tolerance juki-mf7923d {}"),
    "results": (".csv", "judge juki-mf7923d {}"),
    "results, a workbook": (".xlsx", "judge juki-mf7923d {}"),
    "results of MATLAB": (".mat", "judge juki-mf7923d {}"),
    "map": (".txt", "judge juki-mf7923d results.csv --map {}"),
    "limits": (".toml", "compare juki-mf7923d --engine direct --jobs 0 --limits {}"),
    "recorded results": (".csv", "compare juki-mf7923d --engine direct --jobs 0 --against {}"),
    "designs": (".csv", "sweep juki-mf7923d --table {}"),
}
WRITTEN = {
    "saved CSV": (".csv", "results juki-mf7923d --save {}"),
    "saved picture": (".svg", "check juki-mf7923d --save {}"),
    "saved linkage": (".toml", "optimise juki-mf7923d --minimise Mkr.peak --over needle_bar.mass=70:80 --save {}"),
    "saved errors": (".csv", "compare juki-mf7923d --engine direct --jobs 0 --save {}"),
    "recorded": (".csv", "compare juki-mf7923d --engine direct --jobs 0 --record {}"),
    "JUnit": (".xml", "compare juki-mf7923d --engine direct --jobs 0 --junit {}"),
    "script": (".py", "compare juki-mf7923d --engine mujoco --script {}"),
    "new": (".toml", "new {}"),
}
FOLDERS = {
    "folder of results": ("", "results juki-mf7923d --out {}"),
    "folder of judge": ("", "judge juki-mf7923d results.csv --out {}"),
    "folder of compare": ("", "compare juki-mf7923d --engine direct --jobs 0 --out {}"),
    "folder of compare alone": ("", "compare --out {}"),
    "folder of bench alone": ("", "bench --out {}"),
    "folder of stress alone": ("", "stress --out {}"),
}


def _device(path):
    path.symlink_to("/dev/zero")


def _no_permission(path):
    path.write_text("a")
    path.chmod(0)


NO_FILE = {
    "pipe": os.mkfifo,
    "device": _device,
    "link to itself": lambda path: path.symlink_to(path.name),
    **({"no permission": _no_permission} if os.geteuid() else {}),  # root may read everything
    "name of 300 bytes": None,
}
NO_CONTENT = {"empty": "", "brackets": "a = " + "[" * 3000, "control characters": 'title = "\x1b[2J\x07"\n\x01,\x02\n'}
CASES = [
    *((place, bad) for place in READ for bad in ("folder", *NO_FILE, *NO_CONTENT)),
    *((place, bad) for place in WRITTEN for bad in ("folder", *NO_FILE)),
    *((place, bad) for place in FOLDERS for bad in (*NO_FILE, "empty")),
]
ALLOWED = {("linkage of watch", bad) for bad in NO_CONTENT}  # its page shows the fault


def made(folder, suffix, bad):
    """The path of a bad file in a folder."""
    if bad == "name of 300 bytes":
        return folder / ("n" * (300 - len(suffix)) + suffix)
    path = folder / f"bad{suffix}"
    if bad == "folder":
        path.mkdir()
    elif bad in NO_FILE:
        NO_FILE[bad](path)
    else:
        path.write_text(NO_CONTENT[bad])
    return path


class LateError(BaseException):
    """Nothing takes it for an error of its own."""


@contextmanager
def time_limit(seconds, clock=signal.ITIMER_REAL, alarm=signal.SIGALRM):
    """Raise LateError after so many seconds of a clock, which sends the signal ``alarm``."""

    def late(*_):
        raise LateError

    before = signal.signal(alarm, late)
    signal.setitimer(clock, seconds)
    try:
        yield
    finally:
        signal.setitimer(clock, 0)
        signal.signal(alarm, before)


@contextmanager
def bounded():
    """Little time and memory: beyond it the test fails."""
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, hard))
    try:
        with time_limit(SECONDS):
            yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tolerances.toml").write_text(TOLERANCES)
    (tmp_path / "results.csv").write_text("time [s],S [mm]\n0,1\n1,2\n2,3\n")
    return tmp_path


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="pipes and devices of Linux")
@pytest.mark.parametrize(("place", "bad"), [case for case in CASES if case not in ALLOWED])
def test_a_command_refuses_it_in_a_sentence(folder, place, bad):
    suffix, words = (READ | WRITTEN | FOLDERS)[place]
    path = made(folder, suffix, bad)
    with bounded():
        sentence = refused(*(str(path) if word == "{}" else word for word in words.split()))
    assert "\x1b" not in sentence


@pytest.mark.parametrize(
    "entry",
    [
        "index.html",
        "figures",
        "assets/linkproof.js",
        "linkproof.sqlite",
        "linkproof.sqlite-journal",
    ],
)
def test_nothing_is_written_through_a_link_in_a_results_folder(folder, entry):
    victim = folder / "victim"
    victim.mkdir()
    (victim / "precious.txt").write_text("mine")
    is_file = Path(entry).suffix
    link = folder / "out" / entry
    link.parent.mkdir(parents=True)
    link.symlink_to(victim / "precious.txt" if is_file else victim)
    for words in ("results juki-mf7923d", "compare juki-mf7923d --engine direct --jobs 0", "compare"):
        assert f"'out/{entry}' is a link" in refused(*words.split(), "--out", "out")
    assert [(path.name, path.read_text()) for path in victim.iterdir()] == [("precious.txt", "mine")]
    assert link.is_symlink()


@pytest.mark.usefixtures("folder")
def test_pages_that_cannot_be_written_are_an_error_after_the_results(monkeypatch):
    def full(*_, **__):
        raise LinkproofError("cannot write 'out/index.html': no space")

    monkeypatch.setattr("reports.site.write_site", full)
    words = ["compare", "juki-mf7923d", "--engine", "direct", "--quantity", "Mkr", "--jobs", "0", "--out", "out"]
    for done in (command(*words), command("compare", "--out", "out")):
        assert (done.returncode, "1 passed" in done.stdout) == (2, True)
        assert "the results are saved in 'out', but no pages are written: cannot write 'out/index.html'" in done.stderr


@pytest.mark.nightly
def test_a_home_that_cannot_be_written_is_no_news(tmp_path):
    home = {"HOME": "/proc", "XDG_CONFIG_HOME": "", "XDG_CACHE_HOME": "", "MPLCONFIGDIR": ""}
    done = process("check", "juki-mf7923d", "--save", tmp_path / "scheme.svg", **home)
    assert (done.returncode, done.stderr) == (0, f"wrote {tmp_path / 'scheme.svg'}\n")
