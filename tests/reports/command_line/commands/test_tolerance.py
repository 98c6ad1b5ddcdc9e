"""``linkproof tolerance`` as a designer meets it: tables, files, and one sentence for every fault."""

import csv
import json

import pytest

import linkproof as package
from analytic.errors import LinkproofError
from reports.command_line.commands.tolerance import tolerance
from reports.requests.options.designs import ToleranceFiles, ToleranceOptions
from tests.analytic.drives import path_of
from tests.commands import linkproof, refused
from tests.options import shared_out

TEXT = """results = ["Mkr.peak", "stroke"]
speed = 900
[tolerances]
"rod.B.x" = 0.05
"rocker.C.angle" = { plus_minus = 0.1, distribution = "uniform" }
"rod.mass" = "5g"
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "tolerances.toml"
    path.write_text(TEXT, encoding="utf-8")
    return path


def test_it_says_what_moves_what_and_writes_it(tmp_path, file):
    done = linkproof(
        "tolerance", "rimoldi-164", file, "--angles", 24, "--samples", 50, "--seed", 7, "--no-gravity",
        "--json", tmp_path / "a.json", "--csv", tmp_path / "a.csv", "--svg", tmp_path / "a.svg",
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    head = (
        "rimoldi-164 (as-built): constant-speed, 900 rpm counter-clockwise, φ from 0° to 360° in 0.06667 s, gravity off"
    )
    head += ", refined between 24 crank angles, masses as in the file"
    assert lines[0] == head
    assert "stroke [mm]: 30.9866" in lines
    assert any(line.startswith("worst case: ") and "of all 8 corners" in line for line in lines)
    assert "50 random designs, seed 7: all of them assemble" in lines
    assert lines[-1].startswith("± of a normal distribution are three standard deviations")
    document = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))
    assert "rocker.C.angle" in (tmp_path / "a.svg").read_text(encoding="utf-8")
    assert (document["conditions"], document["derivatives"], document["assembled"]) == (head, "exact", 1.0)
    stroke = document["results"]["stroke"]
    assert [one["share of variance"] for one in stroke["tolerances"]][2] == 0.0  # a mass has no part in it
    assert sum(one["share of variance"] for one in stroke["tolerances"]) == pytest.approx(1.0)
    with (tmp_path / "a.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [(row["result"], row["parameter"], row["parameter unit"]) for row in rows][3:5] == [
        ("stroke", "rod.B.x", "mm"),
        ("stroke", "rocker.C.angle", "deg"),
    ]
    assert float(rows[3]["contribution"]) == stroke["tolerances"][0]["contribution"]


def test_python_has_the_same_numbers(tmp_path, file):
    options = ToleranceOptions(mechanism="rimoldi-164", tolerances=file, angles=24, samples=50)
    tolerance(options, ToleranceFiles(json=str(tmp_path / "a.json")), quiet=True)
    told = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))["results"]["Mkr.peak"]
    found = package.tolerance("rimoldi-164", file, angles=24, samples=50).sel(result="Mkr.peak")
    assert found.sizes == {"parameter": 3, "limit": 2, "end": 2, "level": 2}
    assert float(found.nominal) == told["nominal"]
    assert found.derivative.values.tolist() == [one["derivative"] for one in told["tolerances"]]
    limits = [[one["at lower limit"], one["at upper limit"]] for one in told["tolerances"]]
    assert found.change.values.tolist() == limits
    assert found.corner.values.tolist() == told["worst case"]["corners"]
    assert float(found["mean"]) == told["random"]["mean"]
    assert float(found.deviation) == told["random"]["standard deviation"]
    named = package.tolerance("rimoldi-164", {"rod.B.x": 0.05}, "stroke", speed=900, angles=24, samples=50)
    assert float(named.derivative.squeeze()) == pytest.approx(0.0829, abs=1e-4)


def test_a_drive_along_a_line_has_its_own_unit_of_speed(file):
    motor = path_of("linear-motor")
    name = next(iter(package.load(motor).links))
    file.write_text(f'results = ["v.peak"]\nspeed = 12\n[tolerances]\n"{name}.mass" = 0.01\n', encoding="utf-8")
    found = package.tolerance(motor, file, angles=12, samples=4)
    assert "12 mm/s" in found.attrs["conditions"]
    usual = package.tolerance(motor, {f"{name}.mass": 0.01}, "v.peak", angles=12, samples=4)
    assert "φ from -9.97355 mm to 172.96 mm in 1 s" in usual.attrs["conditions"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("rod.B.x", "rod.B.X", "did you mean 'rod.B.x'"),
        ("Mkr.peak", "Mkr.peek", "did you mean 'Mkr.peak'"),
        ("5g", "5mm", "rod.mass: unknown mass unit 'mm'"),
        ("speed", "sped", "unknown key 'sped': did you mean 'speed'"),
        ("0.05", "-0.05", "expected a positive ±, got -0.05"),
        ('["Mkr.peak", "stroke"]', "[]", "results: expected a list of figures"),
    ],
)
def test_faults_of_the_file_are_told_with_its_name(file, old, new, words):
    file.write_text(TEXT.replace(old, new), encoding="utf-8")
    with pytest.raises(LinkproofError, match=words) as told:
        tolerance(ToleranceOptions(mechanism="rimoldi-164", tolerances=file), ToleranceFiles())
    assert str(told.value).startswith(str(file))


def test_other_faults_are_told_before_anything_is_written(tmp_path, file):
    said = refused("tolerance", "rimoldi-164", file, "--json", file)
    assert "would take the place of the tolerances" in said
    for options, words in (
        ({"json": "-", "csv": "-"}, "cannot both go to"),
        ({"samples": 10**9}, "expected 10000000 random designs or fewer, got 1000000000"),
        ({"samples": 1}, "expected 2 or more random designs, got 1"),
        ({"seed": -1}, "--seed: expected a number from 0 on"),
        ({"angles": 3}, "--angles: expected 8 crank angles or more, got 3"),
    ):
        given = {"mechanism": "rimoldi-164", "tolerances": file, "json": str(tmp_path / "none.json"), **options}
        with pytest.raises(LinkproofError, match=words):
            tolerance(*shared_out(given, ToleranceOptions, ToleranceFiles))
    assert not (tmp_path / "none.json").exists()
