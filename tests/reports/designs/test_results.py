"""The results of a linkage as tables, CSV, JSON and workbook, as a picture, and as a DXF of one position."""

import csv
import io
import json
import xml.etree.ElementTree as ET

import numpy as np
import pandas
import pytest

from analytic.description.crank_motion import swing
from analytic.description.units import UNITS
from analytic.errors import LinkproofError
from comparisons.designer.curves import Instants
from comparisons.filejudge.reading import read_results
from reports.charts.draw import picture
from reports.designs.results import csv_table, document, printed
from reports.designs.results_drawing import results_figure
from reports.document.terminal import rendered
from tests.analytic.linkages import FOLDER, driven, from_text, mechanism
from tests.commands import linkproof
from tests.reports.designs.samples import (
    CRANK,
    IMPERIAL,
    MASS,
    ROD,
    SPEED,
    TURN,
    engine,
    piston,
    piston_text,
    results,
    shown,
    shown_piston,
)

ezdxf = pytest.importorskip("ezdxf")
openpyxl = pytest.importorskip("openpyxl")
dxf, dxf_units = (getattr(pytest.importorskip("reports.designs.results_dxf"), name) for name in ("dxf", "UNITS"))
workbook = pytest.importorskip("reports.designs.results_workbook").workbook


def table(results):
    head, *rows = csv.reader(io.StringIO(csv_table(results)))
    return dict(zip(head, np.array(rows, dtype=float).T, strict=True))


def test_json_is_one_object_in_si_whatever_the_units_of_the_file():
    metric, imperial = (document(piston(*units)) for units in ((), IMPERIAL))
    assert list(metric) == ["conditions", "axis", "units", "values", "peaks", "figures", "warnings"]
    assert metric["axis"] == "phi"
    assert set(metric["values"]) == set(metric["units"]) == set(metric["peaks"])
    assert metric["units"] == imperial["units"]
    assert metric["units"]["joint_force:A:x"] == "N"
    expected = "phi omega epsilon Mkr Peq Teq Jeq S v a time point:B:x point:B:vx point:B:ay link:rod:alpha"
    assert {*expected.split(), "joint_force:piston on ground:y"} <= set(metric["values"])
    for name, values in metric["values"].items():
        scale = 1e-11 * max(map(abs, values)) + 1e-9
        assert imperial["values"][name] == pytest.approx(values, abs=scale), name
        assert imperial["peaks"][name]["value"] == pytest.approx(metric["peaks"][name]["value"], abs=scale), name


def test_chosen_instants_are_the_rows_and_peaks_are_those_of_the_whole_motion():
    all_of_it = document(piston())
    some = document(results(engine(), chosen=np.array([0.01, 0.02])))
    assert len(some["values"]["Mkr"]) == 2
    assert some["peaks"] == all_of_it["peaks"]


def test_the_curves_of_a_workbook_are_the_numbers_of_the_plain_table():
    found = piston(*IMPERIAL)
    read, expected = pandas.read_excel(io.BytesIO(workbook(found)), "curves"), table(found)
    assert list(read) == list(expected)
    for name, values in expected.items():
        assert read[name].to_numpy() == pytest.approx(values, rel=1e-14), name


def test_the_key_figures_of_a_workbook_are_those_of_the_table():
    """Figures of the piston engine by its formulas, in inches, kN and N mm."""
    read = pandas.read_excel(io.BytesIO(workbook(piston(*IMPERIAL))), "key figures")
    rows = read.set_index(["figure", "signal"])
    assert list(read) == ["figure", "signal", "value", "unit", "at φ [deg]", "at time [s]", "at open end"]
    accelerated = MASS * SPEED**2 * CRANK * (1.0 + CRANK / ROD)  # N, at the top dead centre
    for figure, value, unit, place in (
        (("stroke", "S"), 2.0 * CRANK / 0.0254, "in", None),
        (("shaking force on ground", "shaking_force:magnitude"), accelerated * 1e-3, "kN", 0.0),
        (("signed mean", "omega"), 1000.0, "rpm", None),
    ):
        row = rows.loc[figure]
        assert row["value"] == pytest.approx(value, rel=1e-9)
        assert row["unit"] == unit
        assert place is None or row["at φ [deg]"] == pytest.approx(place, abs=1e-6)


def test_no_name_is_a_formula_of_a_workbook():
    name = "=1+1"
    found = results(from_text(piston_text().replace("A = [", f'"{name}" = [')))
    book = openpyxl.load_workbook(io.BytesIO(workbook(found)))
    cells = [cell for sheet in book for row in sheet.iter_rows() for cell in row]
    assert {cell.data_type for cell in cells} == {"s", "n"}
    assert any(str(cell.value).startswith(f"{name} on ") for cell in cells)


def test_the_table_is_read_back_as_the_signals_it_was_written_from(tmp_path):
    """By the reader of other tools' files, which takes names and units from the headers."""
    found = piston(*IMPERIAL)
    (tmp_path / "t.csv").write_text(csv_table(found, ","), encoding="utf-8")
    read = read_results([tmp_path / "t.csv"], found.linkage, ())
    signals = document(found)["values"]
    assert {column.header for column, _ in read.not_judged} <= {"shaking_force:magnitude [kN]"}
    assert len(read.signals) > 40
    for one in read.signals:
        expected = np.array(signals[one.name])
        assert one.values == pytest.approx(expected, rel=1e-12, abs=1e-12 * np.max(np.abs(expected))), one.name


def test_joint_forces_without_bound_at_change_points_leave_those_elsewhere():
    quarters = Instants(TURN).times_of_angles(np.array([0.0, 90.0, 180.0]), "°", np.radians(1.0))
    found = results(mechanism("parallelogram"), chosen=quarters)
    rows = [row.split() for row in rendered(*printed(found)).splitlines()]
    start = next(number for number, row in enumerate(rows) if row[:2] == ["force", "in"])
    assert [row[-3:] for row in rows[start + 1 : start + 4]] == [["–"] * 3, ["0", "19.83", "19.83"], ["–"] * 3]
    assert "Joint forces have no bound at the change point" in rendered(*printed(found))


def test_rounding_is_no_result_of_a_released_crank():
    """A treadle's wheel turns by the foot's force alone: the drive gives no torque, and S is least at 0."""
    done = linkproof("results", FOLDER / "designer" / "treadle.toml", "--regime", "foot", "--json")
    document = json.loads(done.stdout)
    drive = document["figures"]["drive"]
    assert {one["value"] for one in drive if one["signal"] != "omega"} == {0.0}
    assert {one["what"] for one in drive} == {"peak torque", "peak speed", "RMS torque", "signed mean"}
    assert [one["phi"] for one in drive if one["what"] == "peak torque"] == [None] * 3
    assert not any(document["values"]["Mkr"] + document["values"]["Peq"])
    assert {one["what"]: one["value"] for one in document["figures"]["output"]}["least S"] == 0.0
    assert document["peaks"]["Mkr"]["value"] == document["peaks"]["Peq"]["value"] == 0.0


def words(sheet, figure=None):
    root = ET.fromstring(picture(results_figure(sheet, figure), "svg"))
    return " ".join("".join(text.itertext()) for text in root.iter("{http://www.w3.org/2000/svg}text"))


LIGHT = "\n".join(line for line in piston_text().splitlines() if not line.startswith(("mass", "inertia")))


@pytest.mark.parametrize(
    ("linkage", "motion", "drawn", "absent"),
    [
        (lambda: driven("linear-motor"), swing("cycloidal", 0.0, 0.1, speed=0.1), "force, N", "torque"),
        (lambda: from_text(LIGHT), TURN, "S: peak 0.1000 m", "torque"),
    ],
    ids=["drive along a line", "no masses"],
)
def test_what_a_linkage_has_not_is_not_drawn(linkage, motion, drawn, absent):
    found = words(shown(linkage(), motion))
    assert drawn in found
    assert absent not in found


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("curves", "y, in"),
        ("forces", "|F|, kN"),
    ],
)
def test_one_figure_has_the_width_of_a_papers_column_and_units_on_its_axes(name, expected):
    found = shown_piston(*IMPERIAL)
    root = ET.fromstring(picture(results_figure(found, name), "svg"))
    assert float(root.get("width").removesuffix("pt")) == pytest.approx(85.0 / 25.4 * 72.0, abs=0.01)
    assert expected in words(found, name)
    assert name == "curves" or "crank angle φ, °" in words(found, name)
    assert "sample (base)" not in words(found, name)


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("torqe", "unknown figure 'torqe': did you mean 'torque'?"),
        ("torque", "--figure torque: expected a linkage that has what it shows, got 'sample'"),
    ],
)
def test_a_figure_that_a_linkage_lacks_is_refused_in_one_sentence(name, sentence):
    light = "\n".join(line for line in LIGHT.splitlines() if not line.startswith("output"))
    with pytest.raises(LinkproofError) as error:
        results_figure(shown(from_text(light)), name)
    assert str(error.value).startswith(sentence)


def drawn(found):
    angle = None if found.chosen is None else float(found.chosen["phi"][0])
    return ezdxf.read(io.StringIO(dxf(found.linkage, found.positions, angle)))


def places(document):
    """Where the points and circles are, and the names beside them."""
    space = document.modelspace()
    names = [text.dxf.text for text in space.query("TEXT")]
    points = dict(zip(names, [np.array(point.dxf.location)[:2] for point in space.query("POINT")], strict=True))
    return points, [np.array(circle.dxf.center)[:2] for circle in space.query("CIRCLE")]


@pytest.mark.parametrize(
    ("own", "motion", "degrees"),
    [
        (mechanism("moving-guides"), TURN, 217.3),
        (driven("cylinder-in-the-loop"), swing("cycloidal", 0.05, 0.1, speed=0.1), None),
    ],
)
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


def test_a_drawing_has_a_unit_for_every_length_of_a_file():
    assert {*UNITS["length"]} == {*dxf_units}


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
    assert all(map(ezdxf.lldxf.validator.is_valid_layer_name, layers))
    assert len({layer.casefold() for layer in layers}) == len(layers)
    assert len({line.dxf.layer for line in document.modelspace().query("LINE")}) == 3
    assert not any("%%" in text.dxf.text for text in document.modelspace().query("TEXT"))
    assert not document.audit().errors
