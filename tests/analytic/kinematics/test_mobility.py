"""Grübler's count and Grashof's classes of linkages that are known by name."""

import math

import pytest

from analytic.description.loading import parse
from analytic.kinematics.structure import grashof, loose_points, mobility
from tests.analytic.linkages import EVERY, from_text, mechanism
from tests.analytic.textbook import DOUBLE_ROCKER, four_bar


def _grashof(sample):
    return grashof(sample.linkage, sample.structure)


def test_every_linkage_that_works_has_mobility_1():
    for name, variant in EVERY:
        count = mobility(mechanism(name, variant).linkage)
        assert count.degrees == 3 * count.links - 2 * count.joints - count.slots == 1


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


def test_other_linkages_have_no_class():
    assert _grashof(mechanism("juki-mf7923d")) is None
    assert _grashof(mechanism("rimoldi-164")) is None
