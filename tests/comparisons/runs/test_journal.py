"""What a journal keeps comes back whole, and nothing else does."""

import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from analytic.errors import LinkproofError
from comparisons.runs.journal import HEADER, Journal

REQUEST = "linkproof compare juki-mf7923d\nnumpy 2.0"


def pieces(journal):
    return [path for path in journal.place.iterdir() if path.name != HEADER]


@given(st.dictionaries(st.text(), st.binary(max_size=200), max_size=8))
def test_what_is_kept_comes_back(kept):
    with tempfile.TemporaryDirectory() as folder:
        for key, payload in kept.items():
            Journal(Path(folder), REQUEST).keep(key, payload)
        assert Journal(Path(folder), REQUEST).kept() == kept


def test_names_alike_are_told_apart(tmp_path):
    journal = Journal(tmp_path, REQUEST)
    keys = ["a/b", "a-b", "a b", "A/b", "", "/", "x" * 300, "x" * 301]
    for key in keys:
        journal.keep(key, key.encode())
    assert journal.kept() == {key: key.encode() for key in keys}
    assert len({path.name.lower() for path in pieces(journal)}) == len(keys)


def test_a_piece_kept_again_replaces_the_first(tmp_path):
    journal = Journal(tmp_path, REQUEST)
    journal.keep("run", b"first")
    journal.keep("run", b"second")
    assert journal.kept() == {"run": b"second"}


def test_a_folder_among_the_pieces_is_left_alone(tmp_path):
    journal = Journal(tmp_path, REQUEST)
    journal.keep("run", b"payload")
    (journal.place / "folder").mkdir()
    assert journal.kept() == {"run": b"payload"}


def test_a_header_with_a_newline_more_is_of_the_same_request(tmp_path):
    journal = Journal(tmp_path, REQUEST)
    journal.keep("run", b"payload")
    (journal.place / HEADER).write_text(REQUEST + "\n")
    assert journal.kept() == {"run": b"payload"}


def test_a_header_that_is_no_text_is_another_request(tmp_path):
    journal = Journal(tmp_path, REQUEST)
    journal.keep("run", b"payload")
    (journal.place / HEADER).write_bytes(b"\xff\xfe" + REQUEST.encode())
    with pytest.raises(LinkproofError, match="leave out --resume"):
        journal.kept()


OTHER = """
import sys
from pathlib import Path
from analytic.errors import LinkproofError
from comparisons.runs.journal import Journal
try:
    getattr(Journal(Path(sys.argv[1]), "another"), sys.argv[2])()
except LinkproofError as error:
    sys.exit(str(error))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no lock there")
@pytest.mark.parametrize("use", ["kept", "clear"])
def test_another_process_is_kept_out_until_the_journal_is_done_with(tmp_path, use):
    command = [sys.executable, "-c", OTHER, str(tmp_path), use]
    journal = Journal(tmp_path, REQUEST)
    journal.keep("run", b"payload")
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert "another linkproof command is writing to" in done.stderr
    assert Journal(tmp_path, REQUEST).kept() == {"run": b"payload"}
    journal.clear()
    del journal
    assert subprocess.run(command, capture_output=True, text=True, check=False).stderr == ""


@pytest.mark.parametrize("left", [0.0, 0.3, 0.9])
def test_a_torn_piece_is_removed(tmp_path, left):
    journal = Journal(tmp_path, REQUEST)
    journal.keep("whole", b"payload")
    journal.keep("torn", b"payload" * 100)
    (path,) = (path for path in pieces(journal) if path.name.startswith("torn"))
    content = path.read_bytes()
    path.write_bytes(content[: int(left * len(content))])
    assert journal.kept() == {"whole": b"payload"}
    assert not path.exists()


def test_a_flipped_bit_is_noticed(tmp_path):
    journal = Journal(tmp_path, REQUEST)
    journal.keep("run", b"payload")
    (path,) = pieces(journal)
    path.write_bytes(path.read_bytes()[:-1] + b"D")
    assert journal.kept() == {}


def test_another_request_is_refused_with_the_command_that_was_begun(tmp_path):
    Journal(tmp_path, REQUEST).keep("run", b"payload")
    with pytest.raises(LinkproofError) as told:
        Journal(tmp_path, "linkproof compare rimoldi-164\nnumpy 2.0").kept()
    assert str(told.value) == (
        f"expected the request that was begun in '{tmp_path}': `linkproof compare juki-mf7923d`, got `linkproof "
        "compare rimoldi-164`; repeat it, or leave out --resume to start anew"
    )
    assert Journal(tmp_path, REQUEST).kept() == {"run": b"payload"}


@pytest.mark.parametrize(
    ("now", "told"),
    [
        ("linkproof compare juki-mf7923d\nnumpy 2.1", "`numpy 2.0`, got `numpy 2.1`"),
        ("linkproof compare juki-mf7923d", "`numpy 2.0`, got `nothing`"),
        (REQUEST + "\nnumba 0.60", "`nothing`, got `numba 0.60`"),
    ],
)
def test_another_version_is_another_request(tmp_path, now, told):
    Journal(tmp_path, REQUEST).keep("run", b"payload")
    with pytest.raises(LinkproofError) as error:
        Journal(tmp_path, now).kept()
    assert told in str(error.value)


def test_pieces_of_another_request_without_its_header_are_removed(tmp_path):
    old = Journal(tmp_path, "linkproof compare rimoldi-164")
    old.keep("run", b"old")
    (old.place / HEADER).unlink()
    assert Journal(tmp_path, REQUEST).kept() == {}
    assert pieces(old) == []


def test_clearing_forgets_every_request(tmp_path):
    Journal(tmp_path, REQUEST).keep("run", b"payload")
    Journal(tmp_path, "another").clear()
    assert list(tmp_path.iterdir()) == []
    Journal(tmp_path, "another").clear()


def test_nothing_is_written_before_something_is_kept(tmp_path):
    assert Journal(tmp_path / "new", REQUEST).kept() == {}
    assert list(tmp_path.rglob("*")) == [tmp_path / "new"]


def test_a_folder_that_cannot_be_written_is_the_users_to_mend(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(LinkproofError, match="cannot write"):
        Journal(tmp_path / "file", REQUEST).keep("run", b"payload")
