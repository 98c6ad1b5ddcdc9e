"""Instants of a motion: the axis, both sides of a jump, the first passing of an angle, what is outside."""

import math

import numpy as np
import pytest

from analytic.description.crank_motion import RPM, CrankMotion, Segment, crank_motion, swing
from analytic.errors import LinkproofError
from comparisons.datasheet.curves import Instants
from tests.reports.designs.samples import SPEED, TURN

RUN_UP = crank_motion("run-up", speed=600 * RPM, ramp_time=0.1, hold_time=0.1, start_angle=math.radians(20))


def at(motion, *angles):
    return Instants(motion).times_of_angles(np.array(angles, dtype=float), "°", math.radians(1.0))


def test_the_axis_is_phi_at_constant_speed_and_time_otherwise():
    assert (Instants(TURN).axis, Instants(RUN_UP).axis) == ("phi", "time")
    assert Instants(swing("cycloidal", 0.1, 1.0, speed=3.0)).axis == "time"
    assert Instants(TURN).grid * SPEED == pytest.approx(np.radians(np.linspace(0.0, 360.0, 721)))


def test_both_sides_of_a_jump_are_instants_of_the_grid():
    grid = Instants(RUN_UP).grid
    (place,) = np.flatnonzero(grid == 0.1)
    assert grid[place - 1] == np.nextafter(0.1, 0.0)
    assert RUN_UP.acceleration(grid[place - 1 : place + 1]) == pytest.approx([600 * RPM / 0.1, 0.0])


def test_angles_are_taken_modulo_a_turn_and_under_a_run_up_at_their_first_passing():
    assert at(TURN, 0, 30, 390, -30) * SPEED == pytest.approx(np.radians([0, 30, 30, 330]))
    # φ = 20° + ½ ε t² up to 200° at 0.1 s, then 3600°/s: 90° is passed on the ramp, 10° a turn later.
    on_ramp = math.sqrt(2 * math.radians(90 - 20) / (600 * RPM / 0.1))
    assert at(RUN_UP, 90, 10, 20) == pytest.approx([on_ramp, 0.1 + 170 / 3600, 0.0], rel=1e-12)


def test_a_crank_that_turns_back_passes_an_angle_where_it_first_gets_there():
    back = swing("constant-speed", math.radians(80), math.radians(20), speed=math.radians(60))
    assert at(back, 80, 50, 20) == pytest.approx([0.0, 0.5, 1.0], abs=1e-9)


def test_what_the_motion_does_not_pass_is_refused_with_its_range():
    with pytest.raises(LinkproofError, match=r"--at: expected what the motion passes, from 20° to 80°.*got 90°"):
        at(swing("cycloidal", math.radians(20), math.radians(80), speed=1.0), 30, 90)
    with pytest.raises(LinkproofError, match=r"--time: expected instants from 0 to 0.2 s, the motion's, got 0.3"):
        Instants(RUN_UP).checked_times(np.array([0.1, 0.3]))
    assert Instants(RUN_UP).checked_times(np.array([0.2])) == [0.2]


def test_a_travel_has_no_period():
    there = Instants(swing("constant-speed", 0.0, 0.01, speed=0.02), turns=False)
    assert len(there.grid) == 721
    assert there.times_of_angles(np.array([0.0, 5.0, 10.0]), " mm", 1e-3) == pytest.approx([0.0, 0.25, 0.5])
    with pytest.raises(LinkproofError, match=r"from 0 mm to 10 mm, got 11 mm"):
        there.times_of_angles(np.array([11.0]), " mm", 1e-3)


def test_a_short_stroke_between_long_dwells_is_seen():
    pieces = [(0.0, 5.0, (0.0,)), (5.0, 5.01, (0.0, 0.0, 3e4, -2e6)), (5.01, 20.0, (1.0,))]
    grid = Instants(CrankMotion("index", tuple(Segment(*piece) for piece in pieces))).grid
    assert np.count_nonzero((grid > 5.0) & (grid < 5.01)) > 100
    assert len(grid) < 400
