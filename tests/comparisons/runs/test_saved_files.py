"""Files appear whole or not at all; records and journals come back to the last bit."""

import os
import signal
import stat
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from analytic.errors import LinkproofError
from comparisons.runs import files
from comparisons.runs.files import CURVES, RECORDS, RecordFile, check_writable, write_file, write_text
from comparisons.runs.study import COMMAND, HEADER, Journal


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


KILLED = """
import os, pathlib, signal, sys
from comparisons.runs import files
from comparisons.runs.files import write_file
def write(target):
    target.write_text("half")
    os.kill(os.getpid(), signal.SIGKILL)
write_file(pathlib.Path(sys.argv[1]), write)
"""


@pytest.mark.skipif(not hasattr(os, "O_TMPFILE"), reason="files have names here")
def test_a_kill_in_the_middle_leaves_the_old_file_and_no_litter(tmp_path):
    path = tmp_path / "picture.svg"
    write_text(path, "old")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run([sys.executable, "-c", KILLED, str(path)], env=environment, check=False)
    assert done.returncode == -signal.SIGKILL
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("picture.svg", "old")]


def test_a_system_without_nameless_files_writes_too(tmp_path, monkeypatch):
    monkeypatch.setattr(files, "_open_nameless_file", lambda _: None)
    write_text(tmp_path / "file.txt", "text")
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("file.txt", "text")]


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
def test_what_is_no_file_is_refused_and_stays(tmp_path):
    os.mkfifo(tmp_path / "pipe.csv")
    for path in (tmp_path / "pipe.csv", tmp_path):
        for attempt in (check_writable, lambda path: write_text(path, "text")):
            with pytest.raises(LinkproofError, match=r"cannot write .*expected a file"):
                attempt(path)
    assert stat.S_ISFIFO((tmp_path / "pipe.csv").stat().st_mode)
    assert [p.name for p in tmp_path.iterdir()] == ["pipe.csv"]


VALUES = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text()
ROWS = st.dictionaries(st.text(), VALUES, max_size=4)
ARRAYS = st.dictionaries(st.text(), arrays(float, array_shapes(min_side=0, max_dims=2, max_side=4)), max_size=3)


@settings(max_examples=8)
@given(st.dictionaries(st.text(), st.tuples(ROWS, ARRAYS), max_size=5))
def test_records_come_back_to_the_last_bit(written):
    with tempfile.TemporaryDirectory() as folder:
        file = RecordFile(Path(folder))
        for key, (row, curves) in written.items():
            file.append(key, {f"own {name}": value for name, value in row.items()}, curves)
        file.finish()
        found = RecordFile(Path(folder))
        assert found.keys == list(written)
        for key, (row, curves) in written.items():
            back, arrays_back = found.read(key)
            assert repr({name: back[f"own {name}"] for name in row}) == repr(row)
            assert {name: one.tobytes() for name, one in arrays_back.items()} == {
                name: one.tobytes() for name, one in curves.items()
            }
        whole = sum(one.size for _, curves in written.values() for one in curves.values())
        if written:
            assert np.load(Path(folder) / CURVES, mmap_mode=None).shape == (whole,)


@pytest.fixture
def file(tmp_path):
    found = RecordFile(tmp_path)
    for number in range(3):
        found.append(f"run {number}", {"number": number}, {"S": np.full(4, float(number))})
    return found


@pytest.mark.parametrize("cut", [1, 60])
def test_a_torn_end_is_cut_off_before_more_is_written(file, tmp_path, cut):
    content = (tmp_path / RECORDS).read_bytes()
    (tmp_path / RECORDS).write_bytes(content[:-cut])
    with (tmp_path / CURVES).open("ab") as curves:
        curves.write(b"torn")
    found = RecordFile(tmp_path)
    assert found.keys == ["run 0", "run 1"]
    found.append("run 3", {}, {"S": np.array([5.0])})
    assert RecordFile(tmp_path).keys == ["run 0", "run 1", "run 3"]
    np.testing.assert_array_equal(RecordFile(tmp_path).read("run 3")[1]["S"], [5.0])


@pytest.mark.parametrize(
    "damage",
    [
        lambda text: text.replace('"number": 1', '"number": 2'),
        lambda text: text.replace('"S": [4, [4]]', '"S": [9, [900]]'),
        lambda text: text.replace('"S": [4, [4]]', '"S": "x"'),
    ],
)
def test_a_record_whose_checksum_does_not_match_is_none(file, tmp_path, damage):
    text = (tmp_path / RECORDS).read_text()
    assert damage(text) != text
    (tmp_path / RECORDS).write_text(damage(text))
    assert RecordFile(tmp_path).keys == ["run 0", "run 2"]


def test_a_number_of_a_curve_that_has_changed_takes_its_record_with_it(file, tmp_path):
    content = bytearray((tmp_path / CURVES).read_bytes())
    content[-1] ^= 1
    (tmp_path / CURVES).write_bytes(content)
    assert RecordFile(tmp_path).keys == ["run 0", "run 1"]


REQUEST = "linkproof compare juki-mf7923d\nnumpy 2.0"


def kept(folder, request=REQUEST):
    """Number by key of what a journal holds."""
    records = Journal(folder, request).records
    return {key: records.row(key)["number"] for key in records.keys}


def keep(folder, key="run", number=1, request=REQUEST):
    journal = Journal(folder, request)
    journal.keep(key, {"number": number})
    return journal


def test_records_come_back_and_a_second_one_of_a_key_replaces_the_first(tmp_path):
    for number, key in enumerate(["a/b", "a-b", "", "/", "x" * 300, "a/b"]):
        keep(tmp_path, key, number)
    assert kept(tmp_path) == {"a/b": 5, "a-b": 1, "": 2, "/": 3, "x" * 300: 4}
    assert len(list(tmp_path.rglob("*.*"))) == 4  # however many records there are


OTHER = """
import sys
from pathlib import Path
from analytic.errors import LinkproofError
from comparisons.runs.study import Journal
try:
    Journal(Path(sys.argv[1]), "another").records
except LinkproofError as error:
    sys.exit(str(error))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no lock there")
def test_another_process_has_no_access_before_the_journal_is_cleared(tmp_path):
    command = [sys.executable, "-c", OTHER, str(tmp_path)]
    journal = keep(tmp_path)
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert "another linkproof command is writing to" in done.stderr
    assert kept(tmp_path) == {"run": 1}
    journal.clear()
    del journal
    assert list(tmp_path.iterdir()) == []
    assert subprocess.run(command, capture_output=True, text=True, check=False).stderr == ""


@pytest.mark.parametrize(
    ("now", "told"),
    [
        (
            "linkproof compare none\nnumpy 2.0",
            "`linkproof compare juki-mf7923d`, now `linkproof compare none`",
        ),
        ("linkproof compare juki-mf7923d", "`numpy 2.0`, now `nothing`"),
        (REQUEST + "\nnumba 0.60", "`nothing`, now `numba 0.60`"),
    ],
)
def test_what_another_request_or_version_has_begun_is_removed(tmp_path, now, told):
    keep(tmp_path)
    assert Journal(tmp_path, now).other_request() == told
    assert kept(tmp_path) == {"run": 1}
    assert kept(tmp_path, now) == {}
    assert Journal(tmp_path, now).other_request() == ""


def test_records_of_another_request_without_its_header_are_removed(tmp_path):
    old = keep(tmp_path, request="linkproof compare rimoldi-164")
    (old.place / HEADER).unlink()
    assert kept(tmp_path) == {}
    assert {path.name for path in old.place.iterdir()} == {HEADER, COMMAND}
