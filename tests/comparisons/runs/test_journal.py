"""What a journal keeps comes back whole, and nothing else does."""

import subprocess
import sys

import pytest

from analytic.errors import LinkproofError
from comparisons.runs.journal import HEADER, Journal

REQUEST = "linkproof compare juki-mf7923d\nnumpy 2.0"


def kept(folder, request=REQUEST):
    """Number by key of what a journal holds."""
    records = Journal(folder, request).records
    return {key: records.row(key)["number"] for key in records.keys}


def keep(folder, key="run", number=1, request=REQUEST):
    journal = Journal(folder, request)
    journal.keep(key, {"number": number})
    return journal


def test_what_is_kept_comes_back_and_a_record_kept_again_replaces_the_first(tmp_path):
    for number, key in enumerate(["a/b", "a-b", "", "/", "x" * 300, "a/b"]):
        keep(tmp_path, key, number)
    assert kept(tmp_path) == {"a/b": 5, "a-b": 1, "": 2, "/": 3, "x" * 300: 4}
    assert len(list(tmp_path.rglob("*.*"))) == 3  # however many records there are


def test_a_header_with_a_newline_more_is_of_the_same_request(tmp_path):
    journal = keep(tmp_path)
    (journal.place / HEADER).write_text(REQUEST + "\n")
    assert kept(tmp_path) == {"run": 1}


def test_a_header_that_is_no_text_is_another_request(tmp_path):
    journal = keep(tmp_path)
    (journal.place / HEADER).write_bytes(b"\xff\xfe" + REQUEST.encode())
    with pytest.raises(LinkproofError, match="leave out --resume"):
        kept(tmp_path)


OTHER = """
import sys
from pathlib import Path
from analytic.errors import LinkproofError
from comparisons.runs.journal import Journal
try:
    journal = Journal(Path(sys.argv[1]), "another")
    journal.clear() if sys.argv[2] == "clear" else journal.records
except LinkproofError as error:
    sys.exit(str(error))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no lock there")
@pytest.mark.parametrize("use", ["records", "clear"])
def test_another_process_is_kept_out_until_the_journal_is_done_with(tmp_path, use):
    command = [sys.executable, "-c", OTHER, str(tmp_path), use]
    journal = keep(tmp_path)
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert "another linkproof command is writing to" in done.stderr
    assert kept(tmp_path) == {"run": 1}
    journal.clear()
    del journal
    assert subprocess.run(command, capture_output=True, text=True, check=False).stderr == ""


def test_another_request_is_refused_with_the_command_that_was_begun(tmp_path):
    keep(tmp_path)
    with pytest.raises(LinkproofError) as told:
        kept(tmp_path, "linkproof compare rimoldi-164\nnumpy 2.0")
    assert str(told.value) == (
        f"expected the request that was begun in '{tmp_path}': `linkproof compare juki-mf7923d`, got `linkproof "
        "compare rimoldi-164`; repeat it, or leave out --resume to start anew"
    )
    assert kept(tmp_path) == {"run": 1}


@pytest.mark.parametrize(
    ("now", "told"),
    [
        ("linkproof compare juki-mf7923d\nnumpy 2.1", "`numpy 2.0`, got `numpy 2.1`"),
        ("linkproof compare juki-mf7923d", "`numpy 2.0`, got `nothing`"),
        (REQUEST + "\nnumba 0.60", "`nothing`, got `numba 0.60`"),
    ],
)
def test_another_version_is_another_request(tmp_path, now, told):
    keep(tmp_path)
    with pytest.raises(LinkproofError) as error:
        kept(tmp_path, now)
    assert told in str(error.value)


def test_records_of_another_request_without_its_header_are_removed(tmp_path):
    old = keep(tmp_path, request="linkproof compare rimoldi-164")
    (old.place / HEADER).unlink()
    assert kept(tmp_path) == {}
    assert [path.name for path in old.place.iterdir()] == [HEADER]


def test_clearing_forgets_every_request(tmp_path):
    keep(tmp_path)
    Journal(tmp_path, "another").clear()
    assert list(tmp_path.iterdir()) == []
    Journal(tmp_path, "another").clear()


def test_a_folder_that_cannot_be_written_is_the_users_to_mend(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(LinkproofError, match="cannot write"):
        keep(tmp_path / "file")
