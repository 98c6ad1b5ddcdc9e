"""The drawing is one well-formed picture that names every force, in the units of the file."""

import xml.etree.ElementTree as ET
from io import StringIO

import numpy as np
import pytest
from rich.console import Console

from analytic.description.crank_motion import swing
from reports.designs.results.drawing import svg_text
from reports.designs.results.terminal import key_figures
from tests.analytic.drives import driven
from tests.analytic.linkages import from_text, mechanism
from tests.analytic.textbook import DOUBLE_ROCKER
from tests.reports.designs.results.samples import piston, results


def words(results):
    root = ET.fromstring(svg_text(results))
    return " ".join("".join(text.itertext()) for text in root.iter("{http://www.w3.org/2000/svg}text"))


def test_it_names_every_force_with_its_peak_and_is_in_the_files_units():
    found = words(piston("in", 0.0254, "deg", "kN"))
    for part in (
        "x, in",
        "Fx, kN",
        "piston on ground",
        "shaking force",
        "torque: peak",
        "crank angle φ, °",
        "piston engine",
    ):
        assert part in found.replace("sample (base)", "piston engine"), part


@pytest.mark.parametrize("name", ["moving-guides", "three-on-one-pin"])
def test_linkages_with_slides_and_pins_of_three_links_are_drawn(name):
    assert "Mkr" in words(results(mechanism(name)))


def test_a_swing_is_drawn_within_its_range_and_without_an_output():
    found = words(results(from_text(DOUBLE_ROCKER), swing("cycloidal", *np.radians([50, 90]), speed=2.0)))
    assert "time, s" in found
    assert "S," not in found


@pytest.mark.parametrize(("name", "ends"), [("linear-motor", (0.0, 0.1)), ("cylinder-in-the-loop", (0.05, 0.1))])
def test_a_drive_along_a_line_is_drawn(name, ends):
    assert "force, N" in words(results(driven(name), swing("cycloidal", *ends, speed=0.1)))


def test_forces_through_a_change_point_are_drawn_where_they_have_a_bound():
    found = results(mechanism("parallelogram"))
    assert "shaking force" in words(found)
    screen = Console(width=120, file=StringIO())
    screen.print(key_figures(found))
    said = screen.file.getvalue()
    assert "nan" not in said
    assert "Joint forces have no bound at the change point" in said
