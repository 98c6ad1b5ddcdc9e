"""Faults are found again in the file: the line, the key, counted as a reader counts."""

import pytest

from analytic.description.diagnosis import Source, line_of, readable, shown

TEXT = """title = "sample"          # 1
units = { length = "mm" } # 2
crank = "crank"           # 3

[links.crank]             # 5
mass = 1                  # 6
points.A = [1, 2]         # 7

[links."long rod"]        # 9
points = { A = [0, 0],    # 10
  B = [1, 0] }            # 11
mass = 2                  # 12
slides = { point = "A" }  # 13

[[forces]]                # 15
point = "A"               # 16

[[forces]]                # 18
point = "B"               # 19

[variants.light.links]    # 21
crank = { mass = 3 }      # 22
[variants.light.links."long rod"]
mass = 4                  # 24
"""


@pytest.mark.parametrize(
    ("keys", "variant", "line"),
    [
        (["title"], None, 1),
        (["units", "length"], None, 2),
        (["units", "mass"], None, 2),  # missing there: the table it belongs to
        (["links", "crank", "mass"], None, 6),
        (["links", "crank", "inertia"], None, 5),
        (["links", "crank", "points", "A", "1"], None, 7),
        (["links", "long rod", "mass"], None, 12),
        (["links", "long rod", "points", "B", "0"], None, 11),
        (["links", "long rod", "slides", "point"], None, 13),
        (["forces", "0", "point"], None, 16),
        (["forces", "1", "point"], None, 19),
        (["forces", "1", "force"], None, 18),
        (["links", "crank", "mass"], "light", 22),
        (["links", "long rod", "mass"], "light", 24),
        (["links", "long rod", "points", "A"], "light", 10),
        (["sketch"], None, None),
    ],
)
def test_lines(keys, variant, line):
    assert line_of(TEXT, keys, variant) == (f", line {line}" if line else "")


def test_a_reader_counts_from_one():
    assert readable(["forces", "0", "force", "1"]) == "forces #1.force #2"


def test_a_message_is_put_behind_file_and_line():
    source = Source("mine.toml", TEXT)
    assert source.place("links.crank.mass: too heavy: 3 kg") == "mine.toml, line 6: links.crank.mass: too heavy: 3 kg"
    assert source.place("links.crank.inertia is missing: add it").startswith(
        "mine.toml, line 5: links.crank.inertia is"
    )


def test_values_are_shown_as_the_file_has_them_and_cut_short():
    assert (shown(True), shown("a"), shown(1.5), shown([1, 2])) == ("true", "'a'", "1.5", "[1, 2]")
    assert shown("x" * 100) == "'" + "x" * 59 + "..."
