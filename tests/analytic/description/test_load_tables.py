"""Loads of a linkage file: what is wrong with them is told, and their listing order does not matter."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from analytic.description.loading import parse
from analytic.dynamics.reduced import generalised_force
from analytic.kinematics.mechanism import Mechanism
from tests.analytic.faults import JUKI, message_of
from tests.analytic.tolerances import EPS

FORCE = '\n[[forces]]\npoint = "D"\nlink = "coupler"\nforce = [1, 2]\n'
SPRING = '\n[[springs]]\nbetween = ["A", "O1"]\nlinks = ["coupler", "ground"]\nstiffness = 3\n'

# What is added to the end of the file, and what the message then says.
FAULTS = {
    "force on either link": (
        FORCE.replace('link = "coupler"\n', ""),
        "forces #1: expected one link to take the load, got",
    ),
    "force on another link": (
        FORCE.replace("coupler", "crank"),
        "forces #1: expected a body that carries 'D' (coupler, needle",
    ),
    "force at no point": (FORCE.replace('"D"', '"E"'), "forces #1: unknown point 'E'"),
    "force without angles": (FORCE.replace("[1, 2]", "[[1, 2], [3, 4]]"), "got 2 values and no angles; add angle"),
    "force in quotes": (
        FORCE + FORCE.replace("2]", '"2"]'),
        "forces #2.force #2: expected [x, y], or a list of such pairs",
    ),
    "two angles": (
        FORCE.replace("[1, 2]", "[[1, 2], [3, 4]]\nangle = [0, 9]"),
        "at least 3 of each, got 2 values and 2 angles",
    ),
    "unsorted angles": (
        FORCE.replace("[1, 2]", "[[1, 2], [3, 4], [5, 6]]\nangle = [0, 90, 80]"),
        "forces #1.angle: expected increasing angles that span less than one turn, since the law repeats with the turn",
    ),
    "a whole turn of angles": (
        FORCE.replace("[1, 2]", "[[1, 2], [3, 4], [1, 2]]\nangle = [0, 90, 360]"),
        "got 0 to 360 in steps of 90 and more; sort them, and leave out a last one that repeats the first",
    ),
    "lines between one value": (
        FORCE + 'interpolation = "linear"\n',
        "forces #1.interpolation: expected a list of values over angle = [...] beside it, got one value; leave it out",
    ),
    "unknown interpolation": (
        FORCE + 'interpolation = "cubic"\n',
        "forces #1.interpolation: expected 'spline' or 'linear': what joins the values over the angle",
    ),
    "torque on nothing": (
        '\n[[torques]]\nlink = "cranck"\ntorque = 3\n',
        "torques #1: unknown link 'cranck': did you mean",
    ),
    "spring on one link": (
        SPRING.replace('"ground"', '"coupler"').replace("O1", "D"),
        "got both on 'coupler', where nothing",
    ),
    "spring negative": (
        SPRING.replace("3", "-3"),
        "springs #1.stiffness: expected a finite stiffness of zero or more, got -3",
    ),
    "spring on the wrong link": (
        SPRING.replace("coupler", "needle_bar"),
        "expected a body that carries 'A' (coupler, crank)",
    ),
    "damper on one link": (
        '\n[[dampers]]\nbetween = ["crank", "crank"]\ncoefficient = 3\n',
        "got 'crank' twice; correct one",
    ),
    "damper on three": (
        '\n[[dampers]]\nbetween = ["a", "b", "c"]\ncoefficient = 3\n',
        "expected a pair of names [one, two]",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_in_a_load(fault):
    added, expected = FAULTS[fault]
    assert expected in message_of(JUKI + added)


def _loads(text):
    return parse(JUKI + text, "sample", "sample.toml")


def test_a_load_may_name_its_link_or_leave_it_where_there_is_only_one():
    one = _loads('\n[[forces]]\npoint = "O1"\nforce = [1, 2]\n')
    assert one.forces == ()  # a force on the ground does no work
    two = _loads(FORCE)
    assert (two.forces[0].link, two.forces[0].point) == ("coupler", "D")
    assert np.array_equal(two.forces[0].force(0.3), [1.0, 2.0])


def test_units_of_loads():
    units = 'force = "kN", torque = "N*mm", stiffness = "N/mm", damping = "N*s/mm", turn_damping = "N*mm*s" }'
    text = JUKI.replace('angle = "deg" }', f'angle = "deg", {units}') + FORCE + SPRING + "length = 5\ndamping = 2\n"
    text += '\n[[torques]]\nlink = "crank"\ntorque = [1, 2, 3]\nangle = [0, 90, 180]\n'
    text += '\n[[dampers]]\nbetween = ["crank", "ground"]\ncoefficient = 3\n'
    linkage = parse(text, "sample", "sample.toml")
    spring = linkage.springs[0]
    assert np.array_equal(linkage.forces[0].force(0.0), [1000.0, 2000.0])
    assert linkage.torques[0].torque(np.radians([0.0, 90.0, 180.0]))[0] == pytest.approx(
        [1e-3, 2e-3, 3e-3], rel=4 * EPS
    )
    assert (spring.stiffness, spring.length, spring.damping) == pytest.approx((3000.0, 0.005, 2000.0))
    assert linkage.dampers[0].coefficient == pytest.approx(3e-3)


@pytest.mark.parametrize("joined", ["linear", "spline"])
def test_a_table_is_joined_by_lines_or_by_a_spline_and_drives_the_crank_by_it(joined):
    phi, values = np.radians([10.0, 95.0, 200.0, 300.0]), np.array([1.0, -3.0, 2.0, 0.5])
    text = '\n[[torques]]\nlink = "crank"\ntorque = [1, -3, 2, 0.5]\nangle = [10, 95, 200, 300]\n'
    loaded, bare = (Mechanism(_loads(one)) for one in (f'{text}interpolation = "{joined}"\n', ""))
    at = np.linspace(0.0, 2.0 * np.pi, 720)
    torque = generalised_force(loaded.sweep(at)) - generalised_force(bare.sweep(at))
    through = CubicSpline([*phi, phi[0] + 2.0 * np.pi], [*values, values[0]], bc_type="periodic")
    true = through(at) if joined == "spline" else np.interp(at, phi, values, period=2.0 * np.pi)
    assert torque == pytest.approx(true, abs=1e-12)


def test_loads_are_sorted():
    forces = [FORCE, FORCE.replace("[1, 2]", "[0, 2]"), FORCE.replace('"D"', '"A"')]
    one, two = (_loads("".join(texts)).forces for texts in (forces, reversed(forces)))
    assert [(f.point, f.force.values.tolist()) for f in one] == [(f.point, f.force.values.tolist()) for f in two]
