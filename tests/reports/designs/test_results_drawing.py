"""The drawing is one well-formed picture that names every force, in the units of the file."""

import io
import xml.etree.ElementTree as ET
from io import BytesIO, StringIO

import ezdxf
import numpy as np
import PIL.Image
import pytest
from ezdxf.lldxf.validator import is_valid_layer_name
from rich.console import Console

from analytic.description.crank_motion import swing
from analytic.errors import LinkproofError
from reports.charts.draw import picture
from reports.designs.results_drawing import results_figure
from reports.designs.results_dxf import dxf
from reports.designs.results_terminal import printed
from tests.analytic.linkages import driven, from_text, mechanism
from tests.analytic.textbook import DOUBLE_ROCKER
from tests.reports.designs.samples import IMPERIAL, SPEED, TURN, piston_text, results, shown, shown_piston


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


# The scheme in one position as a DXF whose joints are where the closed form has them.


def drawn(found):
    angle = None if found.chosen is None else float(found.chosen["phi"][0])
    return ezdxf.read(io.StringIO(dxf(found.linkage, found.positions, angle)))


def places(document):
    """Where the points and circles are, and the names beside them."""
    space = document.modelspace()
    names = [text.dxf.text for text in space.query("TEXT")]
    points = dict(zip(names, [np.array(point.dxf.location)[:2] for point in space.query("POINT")], strict=True))
    return points, [np.array(circle.dxf.center)[:2] for circle in space.query("CIRCLE")]


CASES = [
    *((mechanism(name), TURN, 217.3) for name in ("rimoldi-164", "moving-guides", "spring-and-damper", "scotch-yoke")),
    (driven("cylinder-in-the-loop"), swing("cycloidal", 0.05, 0.1, speed=0.1), None),
]


@pytest.mark.parametrize(("own", "motion", "degrees"), CASES)
def test_joints_are_where_the_table_at_this_angle_has_them(own, motion, degrees):
    time = 0.3 * motion.duration if degrees is None else np.radians(degrees) / SPEED
    found = results(own, motion, np.array([time]))
    points, circles = places(drawn(found))
    moving = {name for link in own.linkage.links.values() for name in link.points} - set(own.linkage.ground)
    assert moving <= set(points)
    for point in moving:
        table = [found.table[f"point:{point}:{axis}"][0] / found.unit("S").size for axis in "xy"]
        assert points[point] == pytest.approx(table, abs=1e-9), point
    spots = np.array([*points.values()])
    assert circles
    assert max(float(np.min(np.hypot(*(spots - circle).T))) for circle in circles) == 0.0


def test_without_an_angle_it_is_drawn_as_sketched_in_the_files_unit_with_its_guide_and_a_layer_for_each_link():
    """The piston engine of 2 in and 8 in, sketched at 30°."""
    text = piston_text("in", 0.0254, "deg").replace("angle = 0\n", "angle = 30\n")
    document = drawn(results(from_text(text)))
    crank, rod = 0.05 / 0.0254, 0.2 / 0.0254
    a = crank * np.array([np.sqrt(0.75), 0.5])
    b = np.array([a[0] + np.sqrt(rod**2 - a[1] ** 2), 0.0])
    points, circles = places(document)
    assert document.units == ezdxf.units.IN
    for name, place in {"O": (0.0, 0.0), "A": a, "B": b}.items():
        assert points[name] == pytest.approx(place, abs=1e-12)
    assert len(circles) == 3
    lines = {line.dxf.layer: line for line in document.modelspace().query("LINE")}
    assert set(lines) == {"ground", "crank", "rod"}
    guide = sorted([lines["ground"].dxf.start.x, lines["ground"].dxf.end.x])
    assert guide == pytest.approx([rod - crank, rod + crank])
    assert {"ground", "crank", "rod", "piston", "joints", "names"} <= {one.dxf.name for one in document.layers}
    assert not document.audit().errors


@pytest.mark.parametrize("name", ["rod/*?", "Crank", "joints", "%%c", " "])
def test_layers_and_texts_have_only_characters_that_a_drawing_allows(name):
    text = piston_text().replace("[links.rod]", f'[links."{name}"]').replace("A = [", f'"{name}" = [')
    document = drawn(results(from_text(text)))
    layers = [layer.dxf.name for layer in document.layers]
    assert all(map(is_valid_layer_name, layers))
    assert len({layer.casefold() for layer in layers}) == len(layers)
    assert len({line.dxf.layer for line in document.modelspace().query("LINE")}) == 3
    assert not any("%%" in text.dxf.text for text in document.modelspace().query("TEXT"))
    assert not document.audit().errors
