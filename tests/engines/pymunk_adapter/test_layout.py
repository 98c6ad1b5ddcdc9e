"""Cutting bodies leaves their mass, mass centre and inertia, and puts mass centres where grooves want them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analytic.description.crank_motion import crank_motion
from analytic.description.linkage import GROUND
from comparisons.reference.start_state import scene
from engines.mechanics.states import body_numbers
from engines.pymunk_adapter.layout import (
    BodyPart,
    Gear,
    exact_layout,
    plain_layout,
    with_centre,
    without_point,
    without_rail,
)
from engines.pymunk_adapter.stepping import geared
from engines.scene import Prescribed
from engines.start_check import start_misfit
from tests.analytic.linkages import MADE_UP, mechanism

ROUNDING = 1e-9  # relative; a point mass may be a millionth of its body

LENGTHS = st.floats(-0.5, 0.5)
WEIGHTS = st.floats(1e-3, 10.0)
PARTS = st.builds(
    lambda m, r, x, y: BodyPart(0, m, m * r * r, (x, y)), WEIGHTS, st.floats(0.005, 0.5), LENGTHS, LENGTHS
)


def _sums(parts):
    """Mass, mass centre and inertia about it of several parts of one body."""
    mass = sum(part.mass for part in parts)
    centre = sum(part.mass * np.array(part.offset) for part in parts) / mass
    inertia = sum((p.inertia or 0.0) + p.mass * np.sum((np.array(p.offset) - centre) ** 2) for p in parts)
    return mass, *centre, inertia


@given(PARTS, st.tuples(LENGTHS, LENGTHS), st.sampled_from([without_point, without_rail, with_centre]))
def test_the_pieces_together_are_the_body(part, place, cut):
    if math.dist(place, part.offset) < 1e-6:
        return
    pieces = cut(part, place)
    assert _sums(pieces) == pytest.approx(_sums([part]), rel=ROUNDING, abs=ROUNDING)
    assert all(piece.mass > 0.0 for piece in pieces)
    assert pieces[0].inertia >= 0.3 * part.inertia
    where = pieces[0] if cut is with_centre else pieces[1]
    assert where.offset == pytest.approx(place, abs=ROUNDING)


def _scene(name):
    return scene(mechanism(name), Prescribed(crank_motion(start_angle=0.3)), ())


@pytest.mark.parametrize("name", [name for name in MADE_UP if name != "parallelogram"])
def test_every_groove_has_the_mass_centres_it_needs(name):
    model = _scene(name)
    layout = exact_layout(model)
    turning = {body.name for body in layout.scene.bodies if body.inertia is not None}
    for groove in layout.scene.guided:
        if groove.host in turning:
            (x, y), (along_x, along_y) = groove.through, groove.along
            assert abs(along_x * y - along_y * x) < ROUNDING
        if groove.body in turning:
            assert math.hypot(*groove.anchor) < ROUNDING
    for number, body in enumerate(model.bodies):
        pieces = [part for part in layout.parts if part.owner == number]
        expected = (body.mass, 0.0, 0.0, body.inertia if layout.parts[number].inertia else _sums(pieces)[3])
        assert _sums(pieces) == pytest.approx(expected, rel=ROUNDING, abs=ROUNDING)


def test_nothing_is_cut_that_need_not_be():
    for name in ("juki-mf7923d", "rimoldi-164", "double-crank"):
        exact, plain = exact_layout(_scene(name)), plain_layout(_scene(name))
        assert (exact.parts, exact.holds) == (plain.parts, plain.holds)
    assert len(exact_layout(_scene("ground-pin-in-slot")).parts) == len(_scene("ground-pin-in-slot").bodies) + 1


def test_every_joint_of_the_scene_has_its_hold():
    for name in MADE_UP:
        if name != "parallelogram":
            model = _scene(name)
            joints = {joint.name for joint in (*model.pins, *model.sliders, *model.slots)}
            for layout in (exact_layout(model), plain_layout(model)):
                assert {hold.name for hold in layout.holds} - layout.inner == joints


def test_parts_that_gears_join_are_told_together_and_every_part_once():
    for name in MADE_UP:
        layout = exact_layout(_scene(name))
        together = geared(layout)
        assert sorted(number for parts in together for number in parts) == list(range(len(layout.parts)))
        group = {number: parts for parts in together for number in parts}
        numbers, gears = body_numbers(layout.scene), [hold for hold in layout.holds if isinstance(hold, Gear)]
        joined = {frozenset((numbers[gear.body], numbers[gear.host])) for gear in gears if gear.host != GROUND}
        for first in range(len(layout.parts)):
            for second in range(first):
                linked = frozenset((first, second)) in joined
                assert not linked or group[first] is group[second]
        assert len(together) >= len(layout.parts) - len(joined)
    assert any(len(parts) > 1 for name in MADE_UP for parts in geared(exact_layout(_scene(name))))


@pytest.mark.parametrize("name", MADE_UP)
def test_the_parts_are_a_scene_that_fits_its_joints_from_the_start(name):
    layout = exact_layout(_scene(name))
    assert start_misfit(layout.scene) is None
    assert len(layout.scene.bodies) == len(layout.parts) == layout.carried + len(layout.inner)
