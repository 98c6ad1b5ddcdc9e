"""Tables of designs, read in pieces, are what was written; what is wrong with one is told by line and column."""

import numpy as np
import pytest

from analytic.errors import LinkproofError
from comparisons.designs import space as spaces
from comparisons.designs.space import read_table
from tests.comparisons.designs.sweeps import SIX_BAR


def test_a_long_table_is_read_in_blocks(tmp_path, monkeypatch):
    values = np.random.default_rng(0).uniform(1.0, 2.0, (2, 103))
    rows = [f"{a!r},{b!r}" for a, b in values.T.tolist()]
    rows.insert(50, "")  # lines without a design count for nothing
    file = tmp_path / "designs.csv"
    file.write_text("\ufeffrod.B.x [cm], rod.mass \n" + "\n".join(rows), encoding="utf-8")
    monkeypatch.setattr(spaces, "ROWS", 10)
    space = read_table(file, SIX_BAR)
    truth = values * np.array([[10.0], [1.0]])
    assert (space.count, space.shape, space.dimensions) == (103, (103,), ("design",))
    np.testing.assert_array_equal(space.ends, np.stack([truth.min(axis=1), truth.max(axis=1)], axis=1))
    for first, last in ((0, 103), (0, 1), (9, 11), (10, 20), (45, 75), (102, 103)):
        np.testing.assert_array_equal(space.shown(first, last), truth[:, first:last])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("\n1,2\n", "expected a head that names parameters"),
        ("rod.B.x\n \n", "expected a head that names parameters and a row per design"),
        ("rod.B.q\n1\n", "did you mean 'rod.B."),
        ("rod.B.x [kg]\n1\n", "unknown length unit 'kg'"),
        ("rod.B.x,rod.B.x\n1,2\n", "got rod.B.x twice"),
        ("rod.B.x,rod.mass\n1,2\n3\n4,5\n", "in line 3, column rod.mass, got nothing"),
        ("rod.B.x,rod.mass\n1,2\n3,4,5\n", "expected nothing in line 3, column 3, which has no name, got '5"),
        ("rod.B.x\n1\ntwo\n", "expected a finite number in line 3, column rod.B.x, got 'two'"),
        ("rod.B.x\nTrue\n", "got 'True'"),
        ("\ufeffrod.B.x [cm];rod.mass\r\n17,2;0,1\r\n", "got semicolons"),
        ("rod.B.x,\n175,\n", "got nothing over column 2"),
        ("rod.B.x\n1\n\n1e999\n", "in line 4, column rod.B.x, got '1e999'"),
    ],
)
def test_what_is_no_table_is_told(tmp_path, text, words):
    file = tmp_path / "designs.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(LinkproofError) as told:
        read_table(file, SIX_BAR)
    assert words in str(told.value)


def test_a_file_that_cannot_be_read_is_told(tmp_path):
    (tmp_path / "latin.csv").write_bytes("rod.B.x\n1\nü\n".encode("latin1"))
    (tmp_path / "head.csv").write_bytes("rö\n1\n".encode("latin1"))
    for name, words in (("none.csv", "No such file"), ("latin.csv", "UTF-8"), ("head.csv", "UTF-8")):
        with pytest.raises(LinkproofError, match=words):
            read_table(tmp_path / name, SIX_BAR)
