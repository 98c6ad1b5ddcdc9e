"""``sweep``, ``optimise`` and ``tolerance`` as a designer meets them: tables, files, one sentence for every fault."""

import json
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pandas
import pytest
import xarray

import linkproof as package
from analytic.description.loading import load
from tests.analytic.linkages import FOLDER, path_of
from tests.commands import linkproof, refused

PRESS = FOLDER / "designer" / "press.toml"
VARY = ("rod.B.x=160:18cm:5", "rod.mass=100g:0.2:3")
PLAIN = {"vary": VARY, "quantity": ("Mkr.peak", "stroke")}


def swept(*save, **options):
    pairs = [
        (name, value)
        for name, values in {**PLAIN, **options}.items()
        for value in (values if isinstance(values, tuple) else (values,))
    ]
    words = [word for name, value in [*pairs, *(("save", file) for file in save)] for word in (f"--{name}", value)]
    return linkproof("sweep", "rimoldi-164", *words)


def test_every_file_of_a_sweep_has_the_same_values_and_the_summary_counts_assembled_designs(tmp_path):
    csv, nc, summary, picture = (tmp_path / f"sweep.{kind}" for kind in ("csv", "nc", "json", "svg"))
    done = swept(csv, nc, summary, picture)
    assert done.stderr == "".join(f"wrote {file}\n" for file in (csv, nc, summary, picture))
    assert done.stdout.splitlines()[1] == (
        "15 (5 × 3) designs, of which 9 (60 %) assemble at every angle: rod.B.x from 170 to 180 mm, rod.mass from 0.1 "
        "to 0.2 kg"
    )
    table = pandas.read_csv(csv)
    assert [*table] == ["rod.B.x [mm]", "rod.mass [kg]", "Mkr.peak [N*m]", "stroke [mm]"]
    with xarray.open_dataset(nc) as dataset:
        assert dataset.sizes == {"rod.B.x": 5, "rod.mass": 3}
        assert (dataset["stroke"].attrs, dataset["rod.mass"].attrs) == ({"units": "mm"}, {"units": "kg"})
        np.testing.assert_allclose(dataset["stroke"].values.ravel(), table["stroke [mm]"], rtol=1e-14)
        assert dataset.attrs["command"] == (
            "linkproof sweep rimoldi-164 --vary rod.B.x=160:18cm:5 --vary rod.mass=100g:0.2:3 --quantity Mkr.peak "
            "--quantity stroke"
        )
        assert (dataset.attrs["angles"], dataset.attrs["refined"]) == (180, 0)
    document = json.loads(summary.read_text())
    assert (document["designs"], document["assembled"]) == (15, 9)
    least, largest = document["figures"]["stroke"]["least"], document["figures"]["Mkr.peak"]["largest"]
    row = table.loc[table["stroke [mm]"].idxmin()]
    assert [*least["at"].values(), least["value"]] == pytest.approx([*row.iloc[:2], row["stroke [mm]"]], rel=1e-14)
    assert largest["value"] == pytest.approx(table["Mkr.peak [N*m]"].abs().max(), rel=1e-14)
    assert ET.parse(picture).getroot().tag.endswith("svg")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"vary": ("speed=-10:10:3",)}, "speed: expected finite numbers other than 0, got 0"),
        ({"vary": ("rod.mass=-1:1:3",)}, "rod.mass: expected finite numbers, none negative, got -1"),
        ({"vary": (), "table": Path("designs.csv")}, "which does not exist"),
        ({"vary": ("rod.B.x=100:110:3",)}, "expected designs that assemble, got none of 3, for 'rimoldi-164' cannot"),
        (
            {"vary": ("rod.B.x=170:180:100000", "rod.mass=1:2:101")},
            "expected 2e+07 values at most, designs times figures, got 10100000 × 2: vary less",
        ),
    ],
)
def test_bad_input_of_a_sweep_is_a_sentence_and_writes_nothing(tmp_path, monkeypatch, options, words):
    monkeypatch.chdir(tmp_path)
    done = swept(Path("t.csv"), **options)
    assert (done.returncode, done.stdout) == (2, "")
    assert words in done.stderr
    assert not list(tmp_path.rglob("*.*"))


PEAK = ("rimoldi-164", "--minimise", "Mkr.peak")
ROD = ("--over", "rod.B.x=172:178")


def optimised(*words):
    done = linkproof("optimise", *words)
    assert done.returncode == 0, done.stderr
    return done


def saved(file):
    """The JSON in a file, with its numbers and figures by name."""
    document = json.loads(file.read_text(encoding="utf-8"))
    numbers, figures = ({row["name"]: row for row in document[part]} for part in ("numbers", "figures"))
    return document, numbers, figures


def test_tables_files_and_json_of_an_optimum_have_the_same_figures(tmp_path):
    best, results, curves = (tmp_path / f"best.{kind}" for kind in ("toml", "json", "svg"))
    words = (*PEAK, *ROD, "--over", "rocker.B.x=±10%", "--keep", "stroke")
    done = optimised(*words, *(word for file in (best, results, curves) for word in ("--save", file)))
    document, numbers, figures = saved(results)
    new = load(best)
    for link in ("rod", "rocker"):
        assert new.links[link].points["B"][0] == pytest.approx(numbers[f"{link}.B.x"]["written"], rel=1e-15)
        assert numbers[f"{link}.B.x"]["before"] == load("rimoldi-164").links[link].points["B"][0]
    assert figures["stroke"]["after"] == pytest.approx(figures["stroke"]["before"], rel=1e-9)
    assert document["search"]["residual"] < 1e-6
    for text in (
        "least Mkr.peak; rimoldi-164 (as-built): constant-speed, 1000 rpm counter-clockwise",
        f"{figures['Mkr.peak']['after']:.6g}", "minimised",
        f"{100.0 * figures['Mkr.peak']['change']:+.2f} %", "kept at 30.98", "joint_force:O1.peak", "Jeq.mean",
        "transmission_angle:rocker + rod (RRR).min", "exact derivatives",
    ):  # fmt: skip
        assert text in done.stdout
    assert "Mkr" in curves.read_text(encoding="utf-8")
    assert f"linkproof compare {best}" in done.stdout
    repeated = json.loads(optimised(*document["command"].replace("'", "").split()[2:], "--json", "-q").stdout)
    assert repeated == document


def test_the_speed_may_be_varied_and_is_printed_since_no_file_has_it(tmp_path):
    best, results = tmp_path / "best.toml", tmp_path / "best.json"
    words = (*PEAK, "--no-gravity", "--speed", "-1000", "--over", "speed=±20%")
    done = optimised(*words, "--save", best, "--save", results)
    assert saved(results)[2]["Mkr.peak"]["change"] == pytest.approx(0.8**2 - 1.0, rel=1e-9)  # at the lower bound
    assert "It is the best design at 800 rpm: a linkage file has no speed." in done.stdout
    assert f"linkproof compare {best} --speed -800 --no-gravity" in done.stdout
    assert load(best).links == load("rimoldi-164").links


def test_a_number_that_a_kept_figure_determines_leaves_nothing_to_vary():
    done = optimised(*PEAK, *ROD, "--keep", "stroke")
    assert "Nothing is left to vary: stroke alone determines rod.B.x." in done.stdout
    assert "Optimality" not in done.stdout
    assert "improvement" not in done.stdout
    (row,) = (line for line in done.stdout.splitlines() if line.startswith("rod.B.x"))
    assert row.split()[-2:] == ["0.00", "%"]


def test_lengths_are_rounded_and_the_cost_is_printed(tmp_path):
    words = (*PEAK, *ROD, "--over", "rocker.B.x=20:23", "--over", "rod.mass=0.1:0.2", "--keep", "stroke")
    files = [tmp_path / name for name in ("exact.json", "round.json", "round.toml")]
    assert "Rounded" not in optimised(*words, "--save", files[0]).stdout
    done = optimised(*words, "--round", "0.1mm", "--save", files[1], "--save", files[2])
    new = load(files[2])
    for link in ("rod", "rocker"):
        tenths = 1e4 * new.links[link].points["B"][0]
        assert tenths == pytest.approx(round(tenths), abs=1e-9)
    exact, rounded = (saved(file)[2] for file in files[:2])
    cost = rounded["Mkr.peak"]["after"] / exact["Mkr.peak"]["after"] - 1.0
    missed = 1e3 * abs(rounded["stroke"]["after"] - exact["stroke"]["after"])
    costs = f"Rounded: lengths are multiples of 0.1mm, which costs {100.0 * cost:+.2f} % of the aim; it misses"
    assert costs in done.stdout
    assert f"stroke by {missed:#.4g} mm." in done.stdout


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (PEAK, "expected numbers to vary, got none"),
        ((*PEAK, "--over", "speed=0:2"), "--over speed: expected bounds above 0, got '0:2'"),
        ((*PEAK, *ROD, "--maximise", "stroke"), "got both"),
        ((*PEAK, "--over", "rod.B.x=174.9999999999:175.0000000001"), "the bounds are so close together that Mkr.peak"),
        pytest.param(  # which is looked for everywhere
            (*PEAK, *ROD, "--keep", "stroke=50:51"),
            "expected a design with stroke from 50 to 51 mm, got none within",
            marks=pytest.mark.nightly,
        ),
        ((*PEAK, "--over", "rod.B.x=10:18"), "expected designs that can be assembled at every angle, got none"),
        (("rimoldi-164", "--minimise", "stroke", "--over", "rod.mass=0.1:0.2"), "which does not; choose others"),
        ((*PEAK, *ROD, "--round", "0"), "--round: expected a positive length, got '0'"),
        ((*PEAK, "--over", "rod.mass=0.1:0.2", "--round", "1"), "--round: expected a length among the numbers"),
    ],
)
def test_bad_input_of_an_optimisation_is_one_sentence_before_anything_is_written(words, sentence, tmp_path):
    assert sentence in refused("optimise", *words, "--save", tmp_path / "best.toml")
    assert not (tmp_path / "best.toml").exists()


TOLERANCES = """results = ["Mkr.peak", "stroke"]
speed = 900
[tolerances]
"rod.B.x" = 0.05
"rocker.C.y" = { plus_minus = 0.05, distribution = "uniform" }
"rod.mass" = "5g"
"""


@pytest.fixture
def tolerances(tmp_path):
    path = tmp_path / "tolerances.toml"
    path.write_text(TOLERANCES, encoding="utf-8")
    return path


def test_tables_files_and_python_have_the_same_numbers_of_tolerances(tmp_path, tolerances):
    files = [word for name in ("json", "csv", "svg") for word in ("--save", tmp_path / f"a.{name}")]
    done = linkproof("tolerance", "rimoldi-164", tolerances, "--no-gravity", "--samples", 50, *files)
    assert (done.returncode, done.stderr) == (0, "".join(f"wrote {file}\n" for file in files[1::2]))
    lines = done.stdout.splitlines()
    assert lines[0] == (
        "rimoldi-164 (as-built): constant-speed, 900 rpm counter-clockwise, φ from 0° to 360° in 0.06667 s, gravity "
        "off, refined between 180 crank angles, masses as in the file"
    )
    assert "stroke [mm]: 30.9866" in lines
    assert any(line.startswith("worst case: ") and "at all 8 combinations of limits" in line for line in lines)
    assert "50 random designs, seed 0: all of them assemble" in lines
    assert "rocker.C.y" in (tmp_path / "a.svg").read_text(encoding="utf-8")

    document = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))
    assert (document["conditions"], document["derivatives"], document["assembled"]) == (lines[0], "exact", 1.0)
    stroke, peak = (document["results"][name] for name in ("stroke", "Mkr.peak"))
    assert [row["share of variance"] for row in stroke["tolerances"]][2] == 0.0  # a mass has no part in it
    row = pandas.read_csv(tmp_path / "a.csv").set_index(["result", "parameter"]).loc["stroke", "rod.B.x"]
    assert (row["units"], row["contribution"]) == ("mm", stroke["tolerances"][0]["contribution"])

    motion = package.SteadyMotion(gravity=False)
    found = package.tolerance("rimoldi-164", tolerances, motion=motion, samples=50).dataset.sel(result="Mkr.peak")
    assert found.sizes == {"parameter": 3, "limit": 2, "end": 2, "level": 2}
    limits = [[row["at lower limit"], row["at upper limit"]] for row in peak["tolerances"]]
    assert found.change.values.tolist() == limits
    assert float(found.deviation) == peak["random"]["standard deviation"]


def test_a_drive_along_a_line_has_its_own_unit_of_speed(tolerances):
    motor = path_of("linear-motor")
    name = next(iter(package.load(motor).links))
    tolerances.write_text(f'results = ["v.peak"]\nspeed = 12\n[tolerances]\n"{name}.mass" = 0.01\n', encoding="utf-8")
    found = package.tolerance(motor, tolerances, samples=4).dataset
    assert "12 mm/s" in found.attrs["conditions"]
    usual = package.tolerance(motor, {f"{name}.mass": 0.01}, "v.peak", samples=4).dataset
    assert "φ from -9.97355 mm to 172.96 mm in 1 s" in usual.attrs["conditions"]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--samples", "1000000000"), "expected 10000000 random designs or fewer, got 1000000000"),
        (("--samples", "1"), "expected 2 or more random designs, got 1"),
        (("--save", "tolerances.toml"), "the suffix must be one of .csv, .json, .svg, .png, .pdf"),
    ],
)
def test_bad_input_of_tolerances_is_refused_before_anything_is_written(tmp_path, tolerances, words, sentence):
    assert sentence in refused("tolerance", "rimoldi-164", tolerances, "--save", tmp_path / "none.json", *words)
    assert not (tmp_path / "none.json").exists()


def test_the_new_file_has_bounds_as_typed_and_few_digits(tmp_path):
    """The crank ends at its bound; the torque has a kink in the rod's length, which its file needs 9 digits for."""
    over = ("--over", "crank.A.x=40:80", "--over", "rod.K.x=±10%")
    best, words = tmp_path / "best.toml", ("optimise", PRESS, "--minimise", "Mkr.peak", *over, "--json")
    done = linkproof(*words, "--save", best)
    numbers = {number["name"]: number for number in json.loads(done.stdout)["numbers"]}
    assert numbers["crank.A.x"]["bound"] == "lower"
    text = best.read_text(encoding="utf-8")
    assert "A = [40.0,0]" in text
    [rod] = re.findall(r"K = \[([\d.]+), 0\]", text)
    assert len(rod.replace(".", "")) <= 9
    assert float(rod) == pytest.approx(numbers["rod.K.x"]["after"] * 1e3, rel=1e-8)


def test_loads_over_the_angle_are_said_to_stay_while_dead_centres_move():
    said = "the force at 'R' stays at its crank angles while the top dead centre moves from 182.3° to "
    rod = ("optimise", PRESS, "--minimise", "stroke", "--over", "rod.K.x=320:340", "--json")
    assert [text for text in json.loads(linkproof(*rod).stdout)["warnings"] if text.startswith(said)]
    swept = linkproof("sweep", PRESS, "--vary", "rod.K.x=320:360:3", "--quantity", "stroke")
    assert said in swept.stderr
    assert said not in linkproof("sweep", PRESS, "--vary", "rod.mass=1:2:3", "--quantity", "stroke").stderr
