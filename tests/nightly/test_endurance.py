"""compare, bench and stress, killed at random moments and repeated, lose no run, make none twice and leave nothing."""

import os
import random
import shutil
import sqlite3
import subprocess
import sys
import time
from collections import Counter
from contextlib import closing, suppress
from pathlib import Path
from signal import SIGINT, SIGKILL, SIGTERM
from tempfile import TemporaryDirectory

import pytest

from comparisons.trials.runs.files import STORE
from comparisons.trials.runs.store import UNFINISHED
from tests.commands import COMMAND, ROOT, stored_runs
from tests.comparisons.faults import wait_for

COMMANDS = (
    "compare juki-mf7923d teaching-four-bar --regime all --engine direct --setting all --jobs 2 --speed 60",
    "bench juki-mf7923d --quick --engine direct",
    "stress units --quick --engine direct --jobs 2",
)
KILLS, RUNS, PAUSE = 7, 4, 0.06  # of each command by each signal; after at most so many further runs, and s on average
ENDED = (0, 1)  # exit codes of a command that nobody kills


def stored(folder):
    """How often each run is in a folder: among those of one study, of a command that is finished or is not."""
    query = "SELECT kind, key FROM runs JOIN studies ON study = studies.id"
    with closing(sqlite3.connect(f"file:{folder / STORE}?mode=rw", uri=True)) as file:
        return Counter(file.execute(query).fetchall())


def processes(folder):
    """Processes that have been told to put their temporary files into a folder."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):  # another user's, or ended meanwhile
            found += [entry.name] * (f"TMPDIR={folder}".encode() in (entry / "environ").read_bytes())
    return found


@pytest.fixture
def temporary():
    """A folder whose name is short enough for sockets in it."""
    with TemporaryDirectory() as folder:
        yield folder


@pytest.mark.nightly
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")
@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("by", [SIGKILL, SIGTERM, SIGINT])
def test_kills_at_random_moments_lose_double_and_leave_nothing(tmp_path, temporary, command, by):
    chance, out, kills, known = random.Random(7), tmp_path / "out", 0, set()
    environment = os.environ | {"PYTHONPATH": str(ROOT), "TMPDIR": temporary}
    words = [*COMMAND, *command.split(), "--quiet", "--out", str(out)]
    while kills < KILLS:
        with subprocess.Popen(words, env=environment, stderr=subprocess.PIPE, text=True) as running:
            runs = len(known) + chance.randint(1, RUNS)
            assert wait_for(lambda: running.poll() is not None or stored_runs(out) >= runs)  # noqa: B023
            time.sleep(chance.expovariate(1.0 / PAUSE))
            running.send_signal(by)
            said = running.stderr.read()
        assert running.returncode in (*ENDED, -SIGKILL if by == SIGKILL else 130), said
        assert "Traceback" not in said
        assert wait_for(lambda: not processes(temporary))
        found = stored(out)
        assert set(found.values()) == {1}
        kills += running.returncode not in ENDED
        unfinished = {key for kind, key in found if kind == UNFINISHED}
        if unfinished:
            assert known <= unfinished
            known = unfinished
        else:  # it has ended, but for its pages
            assert {kind for kind, _ in found} == {command.split()[0]}
            shutil.rmtree(out)
            known = set()
