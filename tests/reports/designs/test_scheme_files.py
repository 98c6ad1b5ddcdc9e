"""The scheme in one position as a DXF whose joints are where the closed form has them."""

import io

import ezdxf
import numpy as np
import pytest
from ezdxf.lldxf.validator import is_valid_layer_name

from analytic.description.crank_motion import swing
from reports.designs.results_dxf import dxf
from tests.analytic.linkages import driven, from_text, mechanism
from tests.reports.designs.samples import SPEED, TURN, piston_text, results


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
