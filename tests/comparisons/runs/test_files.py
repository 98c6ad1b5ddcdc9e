"""Files appear whole or not at all."""

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
