"""A sweep that is killed and resumed leaves, byte for byte, the file of one that was not."""

import subprocess
import sys

import pytest

from analytic.errors import LinkproofError
from comparisons.designs.sweep import sweep as sweeps
from comparisons.designs.sweep.saved_sweep import SavedSweep
from comparisons.designs.sweep.sweep import sweep
from comparisons.runs.journal import Journal
from tests.comparisons.designs.sweeps import request

# Runs one sweep after the other, each killed at the next call that touches a file, until one ends by itself.
KILLED = """
import os, signal, sys
from pathlib import Path
from comparisons.designs.sweep import sweep as sweeps
from comparisons.designs.sweep.saved_sweep import SavedSweep
from comparisons.runs.journal import Journal
from tests.comparisons.designs.sweeps import request
sweeps.PLACES = 8 * 7
folder, asked, kills = Path(sys.argv[1]), request(), 0
while True:
    child = os.fork()
    if not child:
        left = kills % int(sys.argv[2]) + 1
        def count(event, _):
            global left
            if event in ("open", "os.rename", "os.remove", "os.mkdir", "os.rmdir", "os.truncate", "os.chmod"):
                left -= 1
                if not left:
                    os.kill(os.getpid(), signal.SIGKILL)
        sys.addaudithook(count)
        saved = SavedSweep(asked, folder, {})
        done = saved.begin(Journal(folder, "linkproof sweep"))
        sweeps.sweep(asked, keep=saved.keep, done=done)
        saved.finish()
        os._exit(0)
    if os.waitpid(child, 0)[1] == 0:
        break
    kills += 1
print(kills)
"""


def made(folder):
    """The file of an uninterrupted sweep."""
    saved = SavedSweep(request(), folder, {})
    assert saved.begin(Journal(folder, "linkproof sweep")) == {}
    sweep(saved.request, keep=saved.keep)
    saved.finish()
    assert [path.name for path in folder.iterdir()] == ["sweep.nc"]
    return (folder / "sweep.nc").read_bytes()


@pytest.mark.skipif(sys.platform == "win32", reason="forks")
@pytest.mark.parametrize("apart", [400, 60])
def test_a_sweep_killed_again_and_again_leaves_the_same_file(tmp_path, monkeypatch, apart):
    monkeypatch.setattr(sweeps, "PLACES", 8 * 7)
    command = [sys.executable, "-c", KILLED, str(tmp_path / "killed"), str(apart)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert int(done.stdout) > 10
    assert (tmp_path / "killed" / "sweep.nc").read_bytes() == made(tmp_path / "whole")
    assert [path.name for path in (tmp_path / "killed").iterdir()] == ["sweep.nc"]


def test_unfinished_work_of_another_command_is_left_alone(tmp_path):
    Journal(tmp_path, "linkproof compare juki-mf7923d").keep("run", b"")
    saved = SavedSweep(request(), tmp_path, {})
    with pytest.raises(LinkproofError, match="unfinished work of `linkproof compare juki-mf7923d`"):
        saved.check("linkproof sweep rimoldi-164")


def test_another_request_is_not_resumed(tmp_path):
    saved = SavedSweep(request(), tmp_path, {})
    saved.begin(Journal(tmp_path, "linkproof sweep one"))
    sweep(saved.request, keep=saved.keep)
    saved.check("linkproof sweep two")
    with pytest.raises(LinkproofError, match="expected the request that was begun"):
        SavedSweep(request(), tmp_path, {}).begin(Journal(tmp_path, "linkproof sweep two"))


def test_what_is_forgotten_leaves_nothing(tmp_path):
    for folder in (tmp_path / "new", tmp_path):
        saved = SavedSweep(request(), folder, {})
        saved.begin(Journal(folder, "linkproof sweep"))
        saved.forget()
    assert list(tmp_path.iterdir()) == []
