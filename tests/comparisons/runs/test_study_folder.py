"""A study comes back as it was saved, or is refused in one sentence: never a traceback, never a changed number."""

import random
import shutil
import subprocess
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter
from typing_extensions import TypedDict

from analytic.errors import LinkproofError
from comparisons.runs.study import SUMS, has_study, load_study, save_study


class Form(TypedDict):
    """A document."""

    command: str
    sizes: list[int]


FORM = TypeAdapter[Any](Form)
TOLD = {"command": "linkproof bench", "sizes": [1, 2]}
RECORDS = [(f"run {n}", {"error": n / 7.0}, {"Mkr": np.linspace(0.0, n, 5)}) for n in range(4)]


@pytest.fixture
def folder(tmp_path):
    save_study(tmp_path, "bench", TOLD, iter(RECORDS))
    return tmp_path


def read(folder):
    return load_study(folder, "bench", FORM, lambda row, curves: (row["key"], row["error"], curves["Mkr"].tobytes()))


def test_what_is_saved_is_read_back_and_replaced_as_a_whole(folder):
    document, rows = read(folder)
    assert document == TOLD
    assert list(rows) == [(key, row["error"], curves["Mkr"].tobytes()) for key, row, curves in RECORDS]
    save_study(folder, "bench", TOLD, RECORDS[:1])
    assert len(read(folder)[1]) == 1
    assert [path.name for path in folder.iterdir()] == ["bench"]
    assert has_study(folder, "bench")
    assert not has_study(folder, "stress")


def test_a_save_that_fails_leaves_the_study_before(folder):
    def failing():
        yield RECORDS[0]
        raise KeyboardInterrupt

    before = read(folder)
    with pytest.raises(KeyboardInterrupt):
        save_study(folder, "bench", TOLD, failing())
    assert read(folder) == before


@pytest.mark.skipif(shutil.which("sha256sum") is None, reason="no sha256sum here")
def test_the_checksums_are_those_of_sha256sum(folder):
    done = subprocess.run(["sha256sum", "-c", SUMS], cwd=folder / "bench", capture_output=True, text=True, check=True)
    assert done.stdout.count(": OK") == 3


def damaged(content, chance):
    """Bytes changed, cut out, put in or cut off at a random place."""
    place, length = chance.randrange(len(content)), chance.choice([1, 3, 40])
    instead = {
        "changed": bytes(chance.randrange(256) for _ in range(length)),
        "cut out": b"",
        "put in": content[place : place + 1] + bytes(length),
    }
    return content[:place] if chance.random() < 0.1 else (
        content[:place] + chance.choice(list(instead.values())) + content[place + length :]
    )  # fmt: skip


def outcome(folder):
    try:
        return str(read(folder))
    except LinkproofError as error:
        return str(error)


def test_whatever_is_damaged_is_refused_in_one_sentence(folder):
    chance, whole = random.Random(11), read(folder)
    for _ in range(100):
        path = chance.choice(sorted((folder / "bench").iterdir()))
        content = path.read_bytes()
        other = damaged(content, chance)
        path.write_bytes(other)
        found = outcome(folder)
        assert found == str(whole) or ("\n" not in found and found.endswith("run bench with --out again"))
        assert found != str(whole) or other == content or path.name == SUMS  # a line added to the sums
        path.write_bytes(content)


@pytest.mark.parametrize("name", [SUMS, "curves.npy"])
def test_a_file_that_is_missing_is_missed(folder, name):
    (folder / "bench" / name).unlink()
    with pytest.raises(LinkproofError, match=r"run bench with --out again|expected the folder given to bench --out"):
        read(folder)


@pytest.mark.parametrize(
    ("told", "words"),
    [
        ({**TOLD, "sizes": ["x"]}, r"sizes\.0: Input should be a valid integer"),
        ({"command": "c"}, "sizes: Field required"),
        ({**TOLD, "format": 9}, "bench' was made by another version of linkproof: run bench with --out again"),
    ],
)
def test_a_document_of_another_form_is_refused_by_its_key(tmp_path, told, words):
    save_study(tmp_path, "bench", told, RECORDS)
    with pytest.raises(LinkproofError, match=words):
        read(tmp_path)


def test_an_empty_folder_is_refused_with_the_cure(tmp_path):
    with pytest.raises(LinkproofError, match="expected the folder given to bench --out"):
        load_study(tmp_path, "bench", FORM, dict)
