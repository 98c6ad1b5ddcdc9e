"""``linkproof tolerance`` as a designer meets it: tables, files, and one sentence for every fault."""

import csv
import json

import pytest

import linkproof as package
from tests.analytic.linkages import path_of
from tests.commands import linkproof, refused

TEXT = """results = ["Mkr.peak", "stroke"]
speed = 900
[tolerances]
"rod.B.x" = 0.05
"rocker.C.angle" = { plus_minus = 0.1, distribution = "uniform" }
"rod.mass" = "5g"
"""
SIZE = {"samples": 50}


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "tolerances.toml"
    path.write_text(TEXT, encoding="utf-8")
    return path


def test_the_tables_the_files_and_python_have_the_same_numbers(tmp_path, file):
    words = [word for name, value in SIZE.items() for word in (f"--{name}", value)]
    files = [word for name in ("json", "csv", "svg") for word in ("--save", tmp_path / f"a.{name}")]
    done = linkproof("tolerance", "rimoldi-164", file, "--no-gravity", *words, *files)
    assert (done.returncode, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    head = (
        "rimoldi-164 (as-built): constant-speed, 900 rpm counter-clockwise, φ from 0° to 360° in 0.06667 s, gravity "
        "off, refined between 180 crank angles, masses as in the file"
    )
    assert lines[0] == head
    assert "stroke [mm]: 30.9866" in lines
    assert any(line.startswith("worst case: ") and "of all 8 corners" in line for line in lines)
    assert "50 random designs, seed 0: all of them assemble" in lines
    assert lines[-1].startswith("± of a normal distribution are three standard deviations")
    assert "rocker.C.angle" in (tmp_path / "a.svg").read_text(encoding="utf-8")

    document = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))
    assert (document["conditions"], document["derivatives"], document["assembled"]) == (head, "exact", 1.0)
    stroke, peak = (document["results"][name] for name in ("stroke", "Mkr.peak"))
    assert [row["share of variance"] for row in stroke["tolerances"]][2] == 0.0  # a mass has no part in it
    assert sum(row["share of variance"] for row in stroke["tolerances"]) == pytest.approx(1.0)
    with (tmp_path / "a.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [(row["result"], row["parameter"], row["parameter unit"]) for row in rows][3:5] == [
        ("stroke", "rod.B.x", "mm"),
        ("stroke", "rocker.C.angle", "deg"),
    ]
    assert float(rows[3]["contribution"]) == stroke["tolerances"][0]["contribution"]

    found = package.tolerance("rimoldi-164", file, gravity=False, **SIZE).sel(result="Mkr.peak")
    assert found.sizes == {"parameter": 3, "limit": 2, "end": 2, "level": 2}
    assert float(found.nominal) == peak["nominal"]
    assert found.derivative.values.tolist() == [row["derivative"] for row in peak["tolerances"]]
    limits = [[row["at lower limit"], row["at upper limit"]] for row in peak["tolerances"]]
    assert found.change.values.tolist() == limits
    assert found.corner.values.tolist() == peak["worst case"]["corners"]
    assert float(found["mean"]) == peak["random"]["mean"]
    assert float(found.deviation) == peak["random"]["standard deviation"]


def test_a_drive_along_a_line_has_its_own_unit_of_speed(file):
    motor = path_of("linear-motor")
    name = next(iter(package.load(motor).links))
    file.write_text(f'results = ["v.peak"]\nspeed = 12\n[tolerances]\n"{name}.mass" = 0.01\n', encoding="utf-8")
    found = package.tolerance(motor, file, samples=4)
    assert "12 mm/s" in found.attrs["conditions"]
    usual = package.tolerance(motor, {f"{name}.mass": 0.01}, "v.peak", samples=4)
    assert "φ from -9.97355 mm to 172.96 mm in 1 s" in usual.attrs["conditions"]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--samples", "1000000000"), "expected 10000000 random designs or fewer, got 1000000000"),
        (("--samples", "1"), "expected 2 or more random designs, got 1"),
        (("--save", "tolerances.toml"), "the suffix must be one of .csv, .json, .svg, .png, .pdf"),
    ],
)
def test_bad_input_is_refused_before_anything_is_written(tmp_path, file, words, sentence):
    assert sentence in refused("tolerance", "rimoldi-164", file, "--save", tmp_path / "none.json", *words)
    assert not (tmp_path / "none.json").exists()
