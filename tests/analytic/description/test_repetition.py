"""Repeated parts: the same linkage as when all is written out, and faults that name the copy and the line."""

import dataclasses

import pytest

from analytic.description.loading import parse
from analytic.description.repetition import _number
from analytic.errors import DescriptionError
from analytic.kinematics.mechanism import Mechanism
from tests.analytic.chains import chain_of_dyads

HEAD = """title = "repeated"
units = { length = "mm", mass = "kg", inertia = "kg*m^2", angle = "deg" }
crank = "crank"
gravity = [0, -9.81]
ground = { O0 = [0, 0] }
sketch = { angle = 90 }
links.crank = { points = { O0 = [0, 0], P0 = [20, 0] }, mass = 0.1, inertia = 1e-5 }
"""
CHAIN = """[repeat.four_bars]
count = 40
ground = { "O{n}" = ["{100*n}", 0] }
sketch = { points = { "P{n}" = ["{100 * n}", 45] } }
[repeat.four_bars.links."coupler{n}"]
points = { "P{n-1}" = [0, 0], "P{n}" = [100, 0] }
mass = 0.1
centre = [50, 0]
inertia = 1e-5
[repeat.four_bars.links."rocker{n}"]
points = { "O{n}" = [0, 0], "P{n}" = [45, 0] }
mass = 0.1
inertia = 1e-5
"""
FAN = """[repeat.fan]
count = 10
ground = { "O{n}" = { radius = 60, angle = "{-40 + 10*n}" } }
links."coupler{n}" = { points = { P0 = [0, 0], "P{n}" = ["{60 + n/2}", 0] }, mass = "{0.1*n}", inertia = 1e-5 }
links."rocker{n}" = { points = { "O{n}" = [0, 0], "P{n}" = [25, 0] }, mass = 0.1, inertia = 1e-5 }
sketch.points = { "P{n}" = [60, "{10*n}"] }
forces = [{ point = "P{n}", link = "rocker{n}", force = [0, "{-n}"] }]
"""


def linkage(text, variant=None):
    return parse(HEAD + text, "repeated", "repeated.toml", variant)


def test_forty_four_bars_are_those_written_out():
    short, long = linkage(CHAIN), parse(chain_of_dyads(40), "chain", "chain.toml")
    same = {"title": "", "name": "", "source": "", "text": ""}
    assert dataclasses.replace(short, **same) == dataclasses.replace(long, **same)


def test_formulas_stand_in_any_part():
    fan = linkage(FAN)
    assert len(Mechanism(fan).structure.dyads) == 10
    assert fan.links["coupler7"].mass == pytest.approx(0.7)
    assert fan.links["coupler7"].points["P7"] == (0.0635, 0.0)
    assert sorted((force.link, force.force.values[1]) for force in fan.forces)[-1] == ("rocker9", -9.0)


def test_a_variant_may_change_the_number_of_copies_and_one_of_them():
    variant = "[variants.short.repeat.four_bars]\ncount = 2\n[variants.short.links.rocker2]\nmass = 7\n"
    short = linkage(CHAIN + variant, "short")
    assert list(short.links) == ["coupler1", "coupler2", "crank", "rocker1", "rocker2"]
    assert short.links["rocker2"].mass == 7.0


# A part of the text, what replaces it, the words whose line is at fault, and a part of the message.
FAULTS = [
    ("mass = 0.1\ncentre", 'mass = "{3-n}"\ncentre', '"{3-n}"', "links.coupler4.mass: expected a"),
    ("centre", "center", "center", "links.coupler1.center: unknown key 'center': did you mean 'centre'?"),
    ('"rocker{n}"', "rocker", "mass = 0.1\ninertia = 1e-5\n", "expected a name of its own for copy 2, got 'links.rock"),
    ("count = 40\n", "", "[repeat", "repeat.four_bars: expected count = a whole number of copies"),
    ("count = 40", "count = 0", "count", "repeat.four_bars.count: expected count = a whole number"),
    ("count = 40", "count = 100000", "count", "from 1 to 1000, got 100000; give one"),
    ("count = 40", "gravty = [0, 0]\ncount = 40", "gravty", "unknown key 'gravty': "),
    ('"{100*n}"', '"{100*m}"', "100*m", "expected numbers made of n in braces, such as {n-1} or {60*n}"),
    ("P{n-1}", "P{n/2}", "P{n/2}", "repeat.four_bars.links.coupler{n}.points.P{n/2}: expected numbers"),
    ('"{100*n}"', '"{1/(n-1)}"', "1/(n", "got '{1/(n-1)}'; correct it"),
    ('"{100*n}"', '"{9**9**9}"', "9**9", "expected numbers made of n"),
    ('"{100*n}"', "\"{__import__('os')}\"", "import", "expected numbers made of n"),
    ("[repeat.four_bars]", "[repeat]", "[repeat]", "repeat: expected tables [repeat.NAME]"),
]


@pytest.mark.parametrize(("old", "new", "at_fault", "words"), FAULTS)
def test_a_fault_names_the_copy_and_the_line(old, new, at_fault, words):
    text = CHAIN.replace(old, new, 1)
    with pytest.raises(DescriptionError) as caught:
        linkage(text)
    place = text.rindex(at_fault) if new == "rocker" else text.index(at_fault)
    assert str(caught.value).startswith(f"repeated.toml:{(HEAD + text[:place]).count(chr(10)) + 1}: ")
    assert words in str(caught.value)


@pytest.mark.parametrize(("n", "a", "b", "c"), [(1, 3, -99, 7), (1000, -12, 45, 99), (17, 0, 0, 3)])
def test_formulas_are_arithmetic(n, a, b, c):
    assert _number(f"{a}*n + ({b} - n)/{c}", n) == a * n + (b - n) / c
