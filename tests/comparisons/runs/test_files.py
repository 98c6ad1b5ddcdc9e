"""Files appear whole or not at all."""

import os
import stat
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from analytic.errors import LinkproofError
from comparisons.runs.files import check_writable, write_file, write_text


def test_text_replaces_what_was_there(tmp_path):
    path = tmp_path / "new" / "file.txt"
    write_text(path, "one")
    write_text(path, "two")
    assert path.read_text() == "two"
    assert [p.name for p in path.parent.iterdir()] == ["file.txt"]


def test_a_failed_write_leaves_the_old_file_and_no_litter(tmp_path):
    path = tmp_path / "file.txt"
    write_text(path, "old")

    def fail(target):
        target.write_text("half")
        raise RuntimeError("power cut")

    with pytest.raises(RuntimeError):
        write_file(path, fail)
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["file.txt"]


def test_a_place_that_cannot_be_written_is_the_users_to_mend(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(LinkproofError, match="cannot write"):
        write_text(tmp_path / "file" / "inside.txt", "x")


def test_places_are_tried_before_the_work_starts(tmp_path):
    (tmp_path / "file").write_text("")
    for path in (tmp_path, tmp_path / "file" / "inside.txt"):
        with pytest.raises(LinkproofError, match="give another place"):
            check_writable(path)
    check_writable(tmp_path / "new" / "folder" / "r.json")
    assert [p.name for p in tmp_path.iterdir()] == ["file"]


def test_a_link_stays_and_its_target_is_replaced(tmp_path):
    (tmp_path / "old").write_text("old")
    for link, target in (("link", "old"), ("dangling", "new")):
        (tmp_path / link).symlink_to(target)
        check_writable(tmp_path / link)
        write_text(tmp_path / link, "text")
        assert (tmp_path / link).is_symlink()
        assert (tmp_path / target).read_text() == "text"
    (tmp_path / "loop").symlink_to("loop")
    for attempt in (check_writable, lambda path: write_text(path, "text")):
        with pytest.raises(LinkproofError, match=r"cannot write .*loop"):
            attempt(tmp_path / "loop")
    assert (tmp_path / "loop").is_symlink()
    assert len(list(tmp_path.iterdir())) == 5


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes here")
def test_a_named_pipe_is_written_into_and_one_that_nobody_reads_is_refused(tmp_path):
    pipe, text = tmp_path / "pipe.csv", "a line\n" * 50_000  # more than a pipe holds
    os.mkfifo(pipe)
    check_writable(pipe)
    with pytest.raises(LinkproofError, match=r"cannot write .*nobody reads from it"):
        write_text(pipe, text)
    reader = os.open(pipe, os.O_RDWR)  # a writer too: so it waits for the other one
    writing = threading.Thread(target=write_text, args=(pipe, text), daemon=True)
    writing.start()
    heard = b""
    while len(heard) < len(text):
        heard += os.read(reader, 1 << 16)
    writing.join()
    os.close(reader)
    assert heard.decode() == text
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert [p.name for p in tmp_path.iterdir()] == ["pipe.csv"]


def test_a_device_that_is_full_is_one_sentence(tmp_path):
    device = tmp_path / "full"
    try:
        os.mknod(device, stat.S_IFCHR | 0o666, os.makedev(1, 7))  # a node of our own of what /dev/full is
        os.close(os.open(device, os.O_WRONLY))
    except (AttributeError, OSError):
        pytest.skip("no device can be made here")
    check_writable(device)
    with pytest.raises(LinkproofError, match=r"cannot write .*full': No space left on device"):
        write_text(device, "text")
    assert stat.S_ISCHR(device.stat().st_mode)


@pytest.mark.skipif(not Path("/proc/self/fd").is_dir(), reason="no /proc here")
def test_where_this_process_prints_is_written_into(tmp_path):
    script = (
        "from pathlib import Path; from comparisons.runs.files import check_writable, write_text\n"
        "path = Path('/proc/self/fd/1'); print('before', flush=True); check_writable(path); write_text(path, 'text')\n"
        "print(' after')"
    )
    with (tmp_path / "out").open("w") as out:
        subprocess.run([sys.executable, "-c", script], stdout=out, check=True)
    assert (tmp_path / "out").read_text() == "before\ntext after\n"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout == "before\ntext after\n"
