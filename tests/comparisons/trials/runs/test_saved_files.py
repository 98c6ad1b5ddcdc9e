"""Files appear whole or not at all."""

import os
import signal
import stat
import subprocess
import sys

import pytest

from analytic.errors import LinkproofError
from comparisons.trials.runs.files import check_writable, write_file


def test_a_failed_write_leaves_the_old_file_and_no_litter(tmp_path):
    path = tmp_path / "file.txt"
    write_file(path, "old")

    def fail(target):
        target.write_text("half")
        raise RuntimeError("power cut")

    with pytest.raises(RuntimeError):
        write_file(path, fail)
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["file.txt"]


KILLED = """
import os, pathlib, signal, sys
from comparisons.trials.runs.files import write_file
def write(target):
    target.write_text("half")
    os.kill(os.getpid(), signal.SIGKILL)
write_file(pathlib.Path(sys.argv[1]), write)
"""


def test_a_kill_in_the_middle_leaves_the_old_file_and_litter_that_the_next_write_removes(tmp_path):
    path = tmp_path / "picture.svg"
    write_file(path, "old")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run([sys.executable, "-c", KILLED, str(path)], env=environment, check=False)
    assert done.returncode == -signal.SIGKILL
    (litter,) = {*tmp_path.iterdir()} - {path}
    assert (path.read_text(), litter.read_text()) == ("old", "half")
    (tmp_path.parent / "precious").write_text("mine")
    litter.unlink()
    litter.symlink_to(tmp_path.parent / "precious")
    write_file(path, "new")
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("picture.svg", "new")]
    assert (tmp_path.parent / "precious").read_text() == "mine"


def test_a_link_stays_and_its_target_is_replaced(tmp_path):
    (tmp_path / "old").write_text("old")
    for link, target in (("link", "old"), ("dangling", "new")):
        (tmp_path / link).symlink_to(target)
        check_writable(tmp_path / link)
        write_file(tmp_path / link, "text")
        assert (tmp_path / link).is_symlink()
        assert (tmp_path / target).read_text() == "text"
    (tmp_path / "loop").symlink_to("loop")
    for attempt in (check_writable, lambda path: write_file(path, "text")):
        with pytest.raises(LinkproofError, match=r"cannot write .*loop"):
            attempt(tmp_path / "loop")
    assert (tmp_path / "loop").is_symlink()
    assert len(list(tmp_path.iterdir())) == 5


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_what_is_no_file_is_refused_and_stays(tmp_path):
    os.mkfifo(tmp_path / "pipe.csv")
    for path in (tmp_path / "pipe.csv", tmp_path):
        for attempt in (check_writable, lambda path: write_file(path, "text")):
            with pytest.raises(LinkproofError, match=r"cannot write .*expected a file"):
                attempt(path)
    assert stat.S_ISFIFO((tmp_path / "pipe.csv").stat().st_mode)
    assert [p.name for p in tmp_path.iterdir()] == ["pipe.csv"]


@pytest.mark.skipif(os.name != "posix", reason="permissions of POSIX")
def test_a_new_file_follows_the_umask_and_an_old_one_keeps_its_permissions(tmp_path):
    before = os.umask(0o027)
    try:
        write_file(tmp_path / "new", "text")
    finally:
        os.umask(before)
    (tmp_path / "own").touch(mode=0o600)
    write_file(tmp_path / "own", "text")
    assert [stat.S_IMODE((tmp_path / name).stat().st_mode) for name in ("new", "own")] == [0o640, 0o600]
