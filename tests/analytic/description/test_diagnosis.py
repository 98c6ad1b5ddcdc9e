"""Faults are found again in the file: the line, the key, counted as a reader counts."""

import tomllib

import pytest

from analytic.description.diagnosis import Source, readable, shown
from analytic.description.loading import find
from tests.analytic.linkages import CATALOGUE, FOLDER, MADE_UP

TEXT = """title = "sample"          # 1
units = { length = "mm" } # 2
crank = "crank"           # 3

[links.crank]             # 5
mass = 1                  # 6
points.A = [1, 2]         # 7

[links."long rod"]        # 9
points = { A = [0, 0], B = [  # 10
  1, 0] }                 # 11
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
        (["sketch"], None, 1),
    ],
)
def test_lines(keys, variant, line):
    assert Source("mine.toml", TEXT, variant).line(keys) == line


def test_a_reader_counts_from_one():
    assert readable(["forces", "0", "force", "1"]) == "forces #1.force #2"


def test_a_message_is_put_behind_file_and_line():
    source = Source("mine.toml", TEXT)
    assert source.place("links.crank.mass: too heavy: 3 kg") == "mine.toml:6: links.crank.mass: too heavy: 3 kg"
    assert source.place("links.crank.inertia is missing: add it").startswith("mine.toml:5: links.crank.inertia is")


def test_values_are_shown_as_the_file_has_them_and_cut_short():
    assert (shown(True), shown("a"), shown(1.5), shown([1, 2])) == ("true", "'a'", "1.5", "[1, 2]")
    assert shown("x" * 100) == "'" + "x" * 59 + "..."


AWKWARD = r"""# [links.no]
title = '''a = 1
[links]''' # 3
note = "b = [\"" # 4
links."a.b" = { mass = 1, points = { "A = 2" = [
  1, # 6
  2 ] } }
date = 2025-01-01 10:00:00
text = '''
c = 3'''
[[forces]] # 11
[forces.law] # 12
angle = [[1, 2],
  [3, 4]]
[[ forces ]] # 15
[[forces.parts]] # 16
[[forces.parts]] # 17
x.y = 1
"""


@pytest.mark.parametrize(
    ("path", "line"),
    [
        *[("title", 2), ("note", 4), ("links", 5), ("links.a.b.mass", 5), ("links.a.b.points.A = 2.1", 7), ("date", 8)],
        *[("forces", 11), ("forces.0", 11), ("forces.0.law", 12), ("forces.0.law.angle.1.0", 14), ("forces.1", 15)],
        *[("forces.1.parts.0", 16), ("forces.1.parts.1.x", 18), ("forces.1.parts.1.x.y", 18), ("forces.1.point", 15)],
    ],
)
def test_every_way_of_writing_a_key_is_read(path, line):
    assert Source("mine.toml", AWKWARD).line(path.split(".")) == line


@pytest.mark.parametrize("name", [name for name, _ in CATALOGUE] + list(MADE_UP))
def test_keys_of_a_linkage_file_have_their_line(name):
    text = find(name if name not in MADE_UP else str(FOLDER / f"{name}.toml")).read_text(encoding="utf-8")
    paths = list(_paths(tomllib.loads(text)))
    for path in paths[:: len(paths) // 4]:
        named = [key for key in path.split(".") if not key.isdigit()]
        line = Source(name, text).line(path.split("."))
        assert path[-1].isdigit() or named[-1] in text.splitlines()[line - 1]


def _paths(value, path=()):
    """Dotted paths of all keys and elements of a TOML document."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, part in inner:
        yield ".".join((*path, str(key)))
        yield from _paths(part, (*path, str(key)))
