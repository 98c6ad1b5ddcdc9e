"""Cutting bodies leaves their mass, mass centre and inertia, and puts mass centres where grooves want them."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analytic.description.crank_motion import crank_motion
from analytic.description.linkage import GROUND
from comparisons.case import scene
from engines.mechanics.states import with_ground
from engines.pymunk_adapter.layout import BodyPart, exact_layout, plain_layout, split_point_mass, split_rail
from engines.scene import Prescribed
from tests.analytic.linkages import MADE_UP, mechanism

ROUNDING = 1e-9  # relative; a point mass may be a millionth of its body

LENGTHS = st.floats(-0.5, 0.5)
WEIGHTS = st.floats(1e-3, 10.0)
PARTS = st.builds(
    lambda m, r, x, y: BodyPart("", m, m * r * r, (x, y)), WEIGHTS, st.floats(0.005, 0.5), LENGTHS, LENGTHS
)


def _sums(parts):
    """Mass, mass centre and inertia about it of several parts of one body."""
    mass = sum(part.mass for part in parts)
    centre = sum(part.mass * np.array(part.offset) for part in parts) / mass
    inertia = sum((p.inertia or 0.0) + p.mass * np.sum((np.array(p.offset) - centre) ** 2) for p in parts)
    return mass, *centre, inertia


@given(PARTS, st.tuples(LENGTHS, LENGTHS), st.sampled_from([split_point_mass, split_rail]))
def test_the_pieces_together_are_the_body(part, place, cut):
    if math.dist(place, part.offset) < 1e-6:
        return
    pieces = cut(part, place)
    assert _sums(pieces) == pytest.approx(_sums([part]), rel=ROUNDING, abs=ROUNDING)
    assert all(piece.mass > 0.0 for piece in pieces)
    assert pieces[0].inertia >= 0.3 * part.inertia
    assert pieces[1].offset == pytest.approx(place, abs=ROUNDING)


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


@pytest.mark.parametrize("name", MADE_UP)
def test_the_parts_of_a_body_move_and_weigh_as_the_body(name):
    model = _scene(name)
    layout = exact_layout(model)
    pins = [pin for pin in model.pins if GROUND in (pin.first, pin.second)]
    pivots = {pin.first: pin.first_anchor for pin in pins} | {pin.second: pin.second_anchor for pin in pins}
    lifts = {load.body: load.force.values for load in layout.scene.forces[len(model.forces) :]}
    for body in model.bodies:
        pieces = [part for part in layout.parts if part.owner == body.name]
        mass, x, y, inertia = _sums(pieces)
        if pieces[0].inertia is None:
            assert (mass, x, y) == pytest.approx((body.mass, 0.0, 0.0), rel=ROUNDING, abs=ROUNDING)
            continue
        pivot = np.array(pivots.get(body.name, (0.0, 0.0)))  # about a fixed point the moments alone matter
        moment = mass * ((x, y) - pivot)
        assert moment == pytest.approx(-body.mass * pivot, abs=ROUNDING * body.mass)
        about = inertia + mass * np.sum(((x, y) - pivot) ** 2)
        assert about == pytest.approx(body.inertia + body.mass * pivot @ pivot, rel=ROUNDING)
        weight = np.multiply(mass, model.gravity) + lifts.get(body.name, (0.0, 0.0))
        assert weight == pytest.approx(np.multiply(body.mass, model.gravity), rel=1e-6)


@pytest.mark.parametrize("name", MADE_UP)
@pytest.mark.parametrize("cut", [exact_layout, plain_layout])
def test_the_parts_fit_their_joints_and_keep_the_scenes(name, cut):
    model = _scene(name)
    layout = cut(model)
    equations, tangent = layout.equations, layout.tangent(model)
    pose = equations.start()
    arms = equations.arms(pose)
    assert np.abs(equations.openings(equations.residual(pose, arms))).max() < ROUNDING
    rate = with_ground(np.column_stack(tangent)[None]) / equations.metres
    along = (equations.jacobian(arms) @ equations.gather(rate)[..., None])[0, :, 0]
    assert along == pytest.approx(equations.crank_unit(1)[0], abs=1e-6)
    names = {joint.name for joint in (*layout.scene.pins, *layout.scene.guided)}
    cut_off = {body.name for body in layout.scene.bodies[layout.carried :]}
    assert names - cut_off == {joint.name for joint in (*model.pins, *model.guided)}
    assert layout.freedom == 1
