"""The drawing is one well-formed picture that names every force, in the units of the file."""

import xml.etree.ElementTree as ET
from io import BytesIO, StringIO

import numpy as np
import PIL.Image
import pytest
from rich.console import Console

from analytic.description.crank_motion import swing
from analytic.errors import LinkproofError
from reports.charts.draw import picture
from reports.designs.results_drawing import results_figure
from reports.designs.results_terminal import printed
from tests.analytic.linkages import driven, from_text, mechanism
from tests.analytic.textbook import DOUBLE_ROCKER
from tests.reports.designs.samples import IMPERIAL, piston_text, shown, shown_piston


def words(sheet, figure=None):
    root = ET.fromstring(picture(results_figure(sheet, figure), "svg"))
    return " ".join("".join(text.itertext()) for text in root.iter("{http://www.w3.org/2000/svg}text"))


def test_it_names_every_force_with_its_peak_and_is_in_the_files_units():
    found = words(shown_piston(*IMPERIAL))
    for part in ("x, in", "Fx, kN", "piston on ground", "shaking force", "torque: peak", "crank angle φ, °", "sample"):
        assert part in found, part


def test_a_swing_is_drawn_within_its_range_and_without_an_output():
    found = words(shown(from_text(DOUBLE_ROCKER), swing("cycloidal", *np.radians([50, 90]), speed=2.0)))
    assert "time, s" in found
    assert "S," not in found


def test_a_drive_along_a_line_is_drawn():
    assert "force, N" in words(shown(driven("linear-motor"), swing("cycloidal", 0.0, 0.1, speed=0.1)))


def test_without_masses_the_output_alone_is_drawn():
    light = "\n".join(line for line in piston_text().splitlines() if not line.startswith(("mass", "inertia")))
    found = words(shown(from_text(light)))
    assert "S: peak 0.1000 m" in found
    assert "torque" not in found


def test_forces_through_a_change_point_are_drawn_where_they_have_a_bound():
    found = shown(mechanism("parallelogram"))
    assert "shaking force" in words(found)
    screen = Console(width=120, file=StringIO())
    screen.print(printed(found))
    text = screen.file.getvalue()
    assert "nan" not in text
    assert "Joint forces have no bound at the change point" in text


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("curves", "y, in"),
        ("torque", "Mkr, N mm"),
        ("forces", "|F|, kN"),
        ("transmission", "transmission angle, deg"),
    ],
)
def test_one_figure_has_the_width_of_a_papers_column_and_units_on_its_axes(name, expected):
    found = shown_piston(*IMPERIAL)
    root = ET.fromstring(picture(results_figure(found, name), "svg"))
    assert float(root.get("width").removesuffix("pt")) == pytest.approx(85.0 / 25.4 * 72.0, abs=0.01)
    assert expected in words(found, name)
    assert name == "curves" or "crank angle φ, °" in words(found, name)
    assert "sample (base)" not in words(found, name)


def test_pictures_of_every_kind_are_the_same_each_time():
    found = shown_piston()
    for kind, start in (("png", b"\x89PNG"), ("pdf", b"%PDF")):
        first, second = (picture(results_figure(found, "torque"), kind) for _ in range(2))
        assert first == second
        assert first.startswith(start)
    width, height = PIL.Image.open(BytesIO(picture(results_figure(found, "torque"), "png"))).size
    assert (width, height > 300) == (1003, True)  # 85 mm at 300 dots to the inch


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("torqe", "unknown figure 'torqe': did you mean 'torque'?"),
        ("torque", "--figure torque: expected a linkage that has what it shows, got 'sample'"),
    ],
)
def test_a_figure_that_a_linkage_lacks_is_refused_in_one_sentence(name, sentence):
    light = "\n".join(line for line in piston_text().splitlines() if not line.startswith(("mass", "inertia", "output")))
    with pytest.raises(LinkproofError) as error:
        results_figure(shown(from_text(light)), name)
    assert str(error.value).startswith(sentence)
