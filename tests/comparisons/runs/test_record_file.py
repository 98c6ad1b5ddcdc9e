"""Records and arrays come back to the last bit; what is torn or damaged counts as not there."""

import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from comparisons.runs.record_file import CURVES, RECORDS, RecordFile

VALUES = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text()
ROWS = st.dictionaries(st.text(), VALUES, max_size=4)
ARRAYS = st.dictionaries(st.text(), arrays(float, array_shapes(min_side=0, max_dims=2, max_side=4)), max_size=3)


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


def test_a_record_written_again_replaces_the_first(file, tmp_path):
    file.append("run 1", {"number": 7})
    assert RecordFile(tmp_path).row("run 1")["number"] == 7
    assert RecordFile(tmp_path).keys == ["run 0", "run 1", "run 2"]


@pytest.mark.parametrize("cut", [1, 30, 60])
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
        lambda text: text.replace('"S": [4, [4]]', '"S": [0, [4]]'),
        lambda text: text.replace('"S": [4, [4]]', '"S": [9, [900]]'),
        lambda text: text.replace('"S": [4, [4]]', '"S": "x"'),
        lambda text: text.replace('"S": [4, [4]]', '"S": [-4, [4]]'),
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


def test_what_is_not_finite_is_never_written(file, tmp_path):
    with pytest.raises(ValueError, match="Out of range float"):
        file.append("run 3", {"error": float("nan")})
    assert RecordFile(tmp_path).keys == ["run 0", "run 1", "run 2"]
