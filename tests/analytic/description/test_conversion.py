"""From a file to a linkage: SI units, joints from shared names, defaults, loads in a fixed order."""

import math
import re

import numpy as np
import pytest

from analytic.description.linkage import GROUND
from analytic.description.loading import load, parse
from tests.analytic.linkages import JUKI, from_text, mechanism, message_of, text_of
from tests.analytic.tolerances import EPS

FORCE = '\n[[forces]]\npoint = "D"\nlink = "coupler"\nforce = [1, 2]\n'
SPRING = '\n[[springs]]\nbetween = ["A", "O1"]\nlinks = ["coupler", "ground"]\nstiffness = 3\nlength = 5\ndamping = 2\n'
TORQUE = '\n[[torques]]\nlink = "crank"\ntorque = [1, -3, 2, 0.5]\nangle = [10, 95, 200, 300]\n'
DAMPER = '\n[[dampers]]\nbetween = ["crank", "ground"]\ncoefficient = 3\n'


def _with(added):
    return parse(JUKI + added, "sample", "sample.toml")


def test_points_of_one_name_are_pinned_together():
    linkage = mechanism("three-on-one-pin").linkage
    assert {pin.point: pin.links for pin in linkage.pins} == {
        "A": ("crank", "left_rod", "right_rod"),
        "B": ("link", "right_rod", "rocker"),
        "D": ("left_piston", "left_rod"),
        "E": ("link", "tool"),
        "O": ("crank", "ground"),
        "O2": ("ground", "rocker"),
    }
    assert [slot.name for slot in mechanism("shaper").linkage.slots] == ["A in rocker", "F in rocker"]


def test_everything_is_in_si_units():
    linkage = mechanism("spring-and-damper").linkage
    crank, angle = linkage.links["crank"], math.radians(75.0)
    assert (crank.mass, crank.inertia) == pytest.approx((0.31, 41e-6), rel=4 * EPS)
    assert crank.centre == pytest.approx((0.002, -0.001), rel=4 * EPS)
    assert linkage.sketch_angle == pytest.approx(math.radians(30.0), rel=4 * EPS)
    assert linkage.links["rocker"].points["B"] == pytest.approx((0.033 * math.cos(angle), 0.033 * math.sin(angle)))
    assert linkage.output.along == pytest.approx((0.6, 0.8), rel=4 * EPS)


def test_loads_are_in_si_units():
    units = 'force = "kN", torque = "N*mm", stiffness = "N/mm", damping = "N*s/mm", turn_damping = "N*mm*s" }'
    text = JUKI.replace('angle = "deg" }', f'angle = "deg", {units}') + FORCE + SPRING + TORQUE + DAMPER
    linkage = parse(text, "sample", "sample.toml")
    spring = linkage.springs[0]
    assert np.array_equal(linkage.forces[0].force(0.0), [1000.0, 2000.0])
    assert linkage.torques[0].torque(np.radians([10.0, 95.0]))[0] == pytest.approx([1e-3, -3e-3], rel=4 * EPS)
    assert (spring.stiffness, spring.length, spring.damping) == pytest.approx((3000.0, 0.005, 2000.0))
    assert linkage.dampers[0].coefficient == pytest.approx(3e-3)


def test_a_slider_has_its_point_at_its_origin_and_the_output_along_it_by_default():
    assert mechanism("juki-mf7923d").linkage.links["needle_bar"].points == {"D": (0.0, 0.0)}
    assert mechanism("carried-slider").linkage.links["slider"].points["D"] == pytest.approx((-0.003, 0.002))
    output = mechanism("scotch-yoke").linkage.output
    assert (output.link, output.along) == ("yoke", (1.0, 0.0))


def test_a_link_without_a_mass_has_no_inertia_and_a_point_mass_has_zero():
    text = text_of("double-crank")
    bare = from_text(re.sub(r"(?m)^(mass|centre|inertia) .*\n", "", text)).linkage
    assert {(link.mass, link.inertia) for link in bare.links.values()} == {(0.0, 0.0)}
    assert bare.is_massless
    assert not mechanism("double-crank").linkage.is_massless
    points = from_text(re.sub(r"(?m)^inertia .*$", "inertia = 0", text)).linkage.links
    assert {link.inertia for link in points.values()} == {0.0}
    assert "links.coupler.inertia is missing" in message_of(re.sub(r"(?m)^inertia .*$", "", text))
    assert mechanism("juki-mf7923d").linkage.links["needle_bar"].inertia is None  # it does not turn


def test_a_direction_of_any_length_is_scaled_and_a_tiny_number_is_zero():
    guide = (
        from_text(text_of("scotch-yoke").replace("along = [1, 0] }", "along = [1e200, 0] }")).linkage.sliders[0].guide
    )
    assert (guide.along, guide.host) == ((1.0, 0.0), GROUND)
    text = JUKI.replace("centre  = [0.5, 0]", "centre = [0.5, 1e-200]")
    assert parse(text, "sample", "sample.toml").links["crank"].centre[1] == 0.0


def test_a_force_on_the_ground_is_left_out_and_loads_keep_their_order():
    on_ground = '\n[[forces]]\npoint = "O1"\nforce = [1, 2]\n'
    forces = _with(on_ground + FORCE + FORCE.replace('"D"', '"A"')).forces
    assert [(force.point, force.number) for force in forces] == [("D", 1), ("A", 2)]


def test_sizes_of_a_linkage():
    rimoldi = mechanism("rimoldi-164").linkage
    assert (rimoldi.shortest_length(), rimoldi.extent()) == pytest.approx((0.012, 0.175))
    assert rimoldi.local("O2", "ground") == pytest.approx((0.016, 0.175))
    assert rimoldi.local("O2", "rocker") == (0.0, 0.0)
    text = text_of("scotch-yoke").replace("points  = { O = [0, 0], A = [20, 0] }", "points = { O = [-20, 0] }")
    text = text.replace('{ point = "A", on = "yoke", through', '{ point = "Y", on = "crank", through')
    points = from_text(text.replace("through = [0, 0], along = [0, 1]", "through = [7, 0], along = [0, 1]")).linkage
    assert points.shortest_length() == points.extent() == pytest.approx(0.02)  # no link has two points
    inches = from_text(text_of("spring-and-damper").replace('length = "mm"', 'length = "in"')).linkage
    assert (load("juki-mf7923d").written(0.0155), inches.written(0.0254)) == ("15.5 mm", "1 in")
