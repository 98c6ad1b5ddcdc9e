"""Cutting bodies leaves their mass, mass centre and inertia, and puts mass centres where grooves want them."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analytic.description.crank_motion import crank_motion
from analytic.description.linkage import GROUND
from comparisons.reference.start_state import scene
from engines.mechanics.start_check import start_misfit
from engines.pymunk_adapter.layout import (
    BodyPart,
    exact_layout,
    plain_layout,
    with_centre,
    without_point,
    without_rail,
)
from engines.scene import Free, Prescribed
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


@pytest.mark.parametrize("name", [name for name in MADE_UP if name != "parallelogram"])
@pytest.mark.parametrize("drive", [Prescribed(crank_motion(start_angle=0.3)), Free(0.0, 1.0)])
def test_a_body_at_its_pivot_has_the_moments_of_the_body_that_it_stands_for(name, drive):
    model = scene(mechanism(name), drive, (), start_angle=0.3)
    layout = exact_layout(model)
    pins = [pin for pin in model.pins if GROUND in (pin.first, pin.second)]
    pivots = {pin.first: pin.first_anchor for pin in pins} | {pin.second: pin.second_anchor for pin in pins}
    lifts = {load.body: load.force.values for load in layout.scene.forces if load not in model.forces}
    assert (layout.flywheel > 0.0) is isinstance(drive, Prescribed)
    for number, body in enumerate(model.bodies):
        pieces = [part for part in layout.parts if part.owner == number]
        wheel = layout.flywheel if body.name == model.crank else 0.0
        mass, x, y, inertia = _sums(
            [dataclasses.replace(pieces[0], inertia=(pieces[0].inertia or wheel) - wheel), *pieces[1:]]
        )
        if pieces[0].offset != pivots.get(body.name):
            expected = (body.mass, 0.0, 0.0, body.inertia if layout.parts[number].inertia else inertia)
            assert (mass, x, y, inertia) == pytest.approx(expected, rel=ROUNDING, abs=ROUNDING)
            continue
        pivot = np.array(pivots[body.name])
        assert mass * ((x, y) - pivot) == pytest.approx(-body.mass * pivot, abs=ROUNDING * body.mass)
        about = inertia + mass * np.sum(((x, y) - pivot) ** 2)
        assert about == pytest.approx(body.inertia + body.mass * pivot @ pivot, rel=ROUNDING)
        lift = lifts.get(body.name, (0.0, 0.0))
        assert lift == pytest.approx(np.multiply(body.mass - mass, model.gravity), rel=ROUNDING)


def test_every_joint_of_the_scene_has_its_hold():
    for name in MADE_UP:
        if name != "parallelogram":
            model = _scene(name)
            joints = {joint.name for joint in (*model.pins, *model.sliders, *model.slots)}
            for layout in (exact_layout(model), plain_layout(model)):
                assert {hold.name for hold in layout.holds} - layout.inner == joints


@pytest.mark.parametrize("name", MADE_UP)
def test_the_parts_are_a_scene_that_fits_its_joints_from_the_start(name):
    layout = exact_layout(_scene(name))
    assert start_misfit(layout.scene) is None
    assert len(layout.scene.bodies) == len(layout.parts) == layout.carried + len(layout.inner)
