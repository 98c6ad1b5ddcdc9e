"""The line of a key in a linkage file, and how messages show keys and values."""

import pytest

from analytic.description.diagnosis import Source, readable, shown
from tests.analytic.linkages import file_text

TEXT = file_text("keys-written-in-every-way")
LINES = {
    **{"title": 1, "units/length": 3, "units/mass": 3, "note": 4, "links/a.b/mass": 5, "links/a.b/points/A = 2/1": 7},
    **{"date": 8, "links/crank/mass": 10, "links/crank/inertia": 9, "links/crank/points/A/1": 11},
    **{"links/long rod/points/B/0": 14, "links/long rod/slides/point": 15, "forces/0": 16},
    **{"forces/0/law": 17, "forces/0/law/angle/1/0": 19, "forces/1": 20, "forces/1/parts/0": 21, "forces/1/point": 20},
    **{"forces/1/parts/1/x/y": 23, "sketch": 1},
}
LINES_OF_A_VARIANT = {"links/crank/mass": 25, "links/long rod/mass": 27, "links/long rod/points/A": 13}


@pytest.mark.parametrize("path", LINES)
def test_the_line_of_a_key_however_it_is_written(path):
    assert Source("mine.toml", TEXT).line(path.split("/")) == LINES[path]


@pytest.mark.parametrize("path", LINES_OF_A_VARIANT)
def test_the_line_of_a_key_of_a_variant(path):
    assert Source("mine.toml", TEXT, "light").line(path.split("/")) == LINES_OF_A_VARIANT[path]


def test_a_message_stands_behind_file_and_line():
    source = Source("mine.toml", TEXT)
    assert source.place("links.crank.mass: too heavy: 3 kg") == "mine.toml:10: links.crank.mass: too heavy: 3 kg"
    assert source.place("links.crank.inertia is missing: add it").startswith("mine.toml:9: links.crank.inertia is")


def test_keys_count_from_one_and_values_are_shown_as_in_toml_and_cut_short():
    assert readable(["forces", "0", "force", "1"]) == "forces #1.force #2"
    assert (shown(True), shown("a"), shown(1.5), shown([1, 2])) == ("true", "'a'", "1.5", "[1, 2]")
    assert shown("x" * 100) == "'" + "x" * 59 + "..."
