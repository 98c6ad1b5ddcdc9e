"""The program finds the Assur groups itself, and refuses by name what it cannot take apart."""

import math

import pytest

from analytic.description.loading import parse
from analytic.errors import StructureError
from analytic.kinematics.structure import grashof, loose_points, mobility
from tests.analytic.linkages import DOUBLE_ROCKER, MADE_UP, four_bar, from_text, mechanism

HEAD = """
title = "sample"
source = "made up for the tests"
units = { length = "m", mass = "kg", inertia = "kg*m^2", angle = "deg" }
crank = "crank"
ground = { O = [0, 0], P = [3, 0], R = [6, 0] }
"""


def _links(**points):
    """Links by their points; each gets a mass and an inertia."""
    return "".join(
        f"[links.{name}]\npoints = {{ {', '.join(f'{p} = [{x}, {y}]' for p, (x, y) in named.items())} }}\n"
        "mass = 1\ninertia = 1\n"
        for name, named in points.items()
    )


CRANK = {"O": (0, 0), "A": (1, 0)}


@pytest.mark.parametrize(
    ("name", "kinds"),
    [
        ("juki-mf7923d", ["RRP"]),
        ("rimoldi-164", ["RRR", "RRP"]),
        ("spring-and-damper", ["RRR"]),
        ("slot-without-mass", ["RPR"]),
        ("ground-pin-in-slot", ["RPR"]),
        ("scotch-yoke", ["RPP"]),
        ("shaper", ["RPR", "PRP"]),
        ("carried-slider", ["RRR", "RRP"]),
        ("moving-guides", ["RRR", "RPP", "PRP"]),
        ("three-on-one-pin", ["RRP", "RRR", "RRP"]),
    ],
)
def test_groups_of_known_linkages(name, kinds):
    assert [dyad.kind for dyad in mechanism(name).structure.dyads] == kinds


def test_every_body_is_placed_once_and_after_its_hosts():
    for name in MADE_UP:
        structure = mechanism(name).structure
        placed = ["ground", structure.pivot.far]
        for dyad in structure.dyads:
            assert {dyad.first_joint.near, dyad.second_joint.near} <= {*placed}
            placed += dyad.links
        assert sorted(placed) == sorted(["ground", *structure.bodies])
    formula = mechanism("rimoldi-164").structure.formula
    assert formula == "I (crank) -> rocker + rod (RRR) -> link + needle_bar (RRP)"


SLIDING = 'slides = { point = "O", through = [0, 0], along = [1, 0] }\n'
THREE_SLIDES = (
    _links(crank=CRANK)
    + 'slides = { point = "A", on = "one", through = [0, 0], along = [1, 0] }\n[links.one]\nmass = 1\ninertia = 1\n'
    + 'slides = { point = "K", on = "two", through = [0, 0], along = [0, 1] }\n[links.two]\nmass = 1\n'
    + 'slides = { point = "L", through = [0, 0], along = [1, 0] }\n'
)
CHAIN = _links(
    crank=CRANK, rod={"A": (0, 0), "B": (2, 0)}, next={"B": (0, 0), "C": (2, 0)}, last={"C": (0, 0), "P": (2, 0)}
)
TWO_PINS = {"B": (2, 0), "C": (2, 1)}
FAULTS = [
    (
        _links(crank={"A": (1, 0)}, rod={"A": (0, 0), "P": (3, 0)}),
        r"expected one pin to the ground, or .* got none; give",
    ),
    (_links(crank={"O": (0, 0), "P": (3, 0)}), r"and no other joint to it, got pin 'O', pin 'P'"),
    (_links(crank=CRANK) + SLIDING, r"or .* joint to it, got pin 'O', slide of 'ground' and 'crank'"),
    (
        CHAIN,
        r"'sample': expected mobility 1, got 2 = 3·4 links - 2·5 pins and slides; add a joint to 'last', 'next', 'rod'",
    ),
    (
        _links(crank=CRANK, stray={"Q": (0, 0), "S": (2, 0)}),
        r"add a joint to 'stray' \(.* on one link only: 'Q', 'S'\)",
    ),
    (THREE_SLIDES, r"held by three sliding joints \(PPP\), which fix no position"),
    (
        _links(crank=CRANK, rod={"A": (0, 0), "P": (2, 0)}),
        r"'rod' of 'sample' is held by too many joints \(pin 'A', pin 'P'\), so the linkage is locked",
    ),
    (
        _links(crank=CRANK, rod={"A": (0, 0), **TWO_PINS}, rocker={"P": (0, 0), **TWO_PINS}),
        r"'rocker', 'rod' of 'sample' are held by too many joints \(pin 'A', pin 'B', pin 'C', pin 'P'\)",
    ),
]


@pytest.mark.parametrize(("links", "message"), FAULTS)
def test_links_that_form_no_groups_are_refused_by_name(links, message):
    with pytest.raises(StructureError, match=message):
        from_text(HEAD + links)


def _grashof(sample):
    return grashof(sample.linkage, sample.structure)


def test_the_count_written_out():
    assert (
        mobility(mechanism("slot-without-mass").linkage).formula
        == "1 = 3·2 links - 2·2 pins and slides - 1 pin in slots"
    )
    loose = parse(DOUBLE_ROCKER.replace("C = [60, 0]", "c = [60, 0]"), "loose", "loose.toml")
    assert mobility(loose).formula == "3 = 3·3 links - 2·3 pins and slides"
    assert loose_points(loose) == ("C", "c")


@pytest.mark.parametrize(
    ("lengths", "angle", "kind"),
    [
        ((60, 20, 60, 45), 60, "Grashof crank-rocker (shortest + longest 0.08 m, the other two 0.105 m; the crank is"),
        ((20, 60, 45, 60), 60, "Grashof double-crank"),
        ((60, 45, 20, 60), 60, "Grashof double-rocker"),
        ((60, 60, 45, 20), 30, "Grashof rocker-crank"),
        ((60, 25, 60, 25), 60, "change-point four-bar (shortest + longest 0.085 m, the other two 0.085 m)"),
        ((80, 50, 50, 50), 60, "four-bar in which nothing turns fully, a triple rocker (shortest + longest 0.13 m"),
    ],
)
def test_classes_of_four_bars(lengths, angle, kind):
    assert _grashof(from_text(four_bar(*(0.001 * length for length in lengths), math.radians(angle)))).startswith(kind)
