"""``linkproof results`` as a designer meets it: tables, files, and one sentence for every fault."""

import json
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from analytic.errors import LinkproofError
from reports.command_line.commands.results import results
from reports.requests.options.linkage import ResultsFiles, ResultsOptions
from tests.analytic.drives import path_of
from tests.analytic.textbook import DOUBLE_ROCKER
from tests.commands import linkproof, refused
from tests.options import shared_out
from tests.reports.designs.results.samples import piston_text


@pytest.fixture
def engine(tmp_path):
    (tmp_path / "engine.toml").write_text(piston_text("mm", 1e-3, "deg"), encoding="utf-8")
    return tmp_path / "engine.toml"


def test_without_options_it_says_what_a_designer_needs_in_80_columns(engine):
    done = linkproof("results", engine)
    assert done.returncode == 0, done.stderr
    for words in (
        "engine (base): constant-speed, 1000 rpm counter-clockwise, φ from 0° to 360° in 0.06 s, gravity off",
        "peak torque", "peak power", "peak braking power", "RMS torque", "signed mean", "piston on ground",
        "shaking force", "shaking moment", "least transmission angle", "stroke", "at φ deg",
    ):  # fmt: skip
        assert words in done.stdout
    assert max(map(len, done.stdout.splitlines()[1:])) <= 100


def test_positions_velocities_and_forces_at_chosen_angles(engine):
    lines = linkproof("results", engine, "--at", "0,90").stdout.splitlines()
    place = next(number for number, line in enumerate(lines) if line.startswith("B "))
    assert lines[place].split()[:3] == ["B", "0", "250.0"]
    assert lines[place + 1].split()[:2] == ["90", "193.6"]  # sqrt(200² - 50²)
    assert any(line.startswith("force in") for line in lines)


def test_all_files_at_once_and_json_to_stdout_alone(engine, tmp_path):
    done = linkproof(
        "results", engine, "--regime", "run-up", "--ramp-time", "0.1", "--csv", tmp_path / "t.csv", "--decimal", ",",
        "--svg", tmp_path / "t.svg", "--xlsx", tmp_path / "t.xlsx", "--png", tmp_path / "t.png", "--json", "-",
        "--gif", tmp_path / "t.gif", "--dxf", tmp_path / "t.dxf", cwd=tmp_path,
    )  # fmt: skip
    document = json.loads(done.stdout)
    assert document["axis"] == "time"
    assert "run-up, up to 1000 rpm" in document["conditions"]
    assert (tmp_path / "t.csv").read_text().startswith("\ufefftime [s];phi [deg];")
    assert ET.parse(tmp_path / "t.svg").getroot().tag.endswith("svg")
    assert {path.name for path in tmp_path.iterdir()} == {
        "engine.toml",
        "t.csv",
        "t.svg",
        "t.png",
        "t.xlsx",
        "t.gif",
        "t.dxf",
    }


def test_groups_of_a_higher_class_are_said_to_be_numerical():
    done = linkproof("results", path_of("ternary-on-rods"))
    assert "the figures are a numerical reference" in done.stdout
    assert "force N" in done.stdout


def test_clockwise_and_a_negative_speed_are_the_same(engine):
    there, back = (
        linkproof("results", engine, *how).stdout for how in (("--speed", -500), ("--speed", 500, "--clockwise"))
    )
    assert there == back
    assert "500 rpm clockwise, φ from 0° to -360°" in there


def test_a_crank_that_makes_no_turn_is_shown_over_its_range(tmp_path):
    (tmp_path / "rocker.toml").write_text(DOUBLE_ROCKER, encoding="utf-8")
    done = linkproof("results", tmp_path / "rocker.toml")
    assert "constant-speed over its range, 1000 rpm" in done.stdout
    assert "No S, v and a: the file names no output." in done.stdout
    swing = linkproof("results", tmp_path / "rocker.toml", "--from", 50, "--to", 90, "--regime", "cycloidal").stdout
    assert "cycloidal, up to 1000 rpm counter-clockwise, φ from 50° to 90°" in swing


def test_a_torque_over_the_angle_is_the_drives(tmp_path):
    released = """
[regimes.push]
start_angle = 70
duration = 0.05
angle = [0, 90, 180, 270]
torque = [0.4, 0.5, 0.4, 0.3]
"""
    (tmp_path / "rocker.toml").write_text(DOUBLE_ROCKER + released, encoding="utf-8")
    options = ResultsOptions(mechanism=str(tmp_path / "rocker.toml"), regime=("push",))
    results(options, ResultsFiles(json=str(tmp_path / "r.json")))
    document = json.loads((tmp_path / "r.json").read_text())
    assert document["axis"] == "time"
    assert document["conditions"].startswith("rocker (base): released at 70°")
    crank = dict(zip(np.degrees(document["values"]["phi"]), document["values"]["Mkr"], strict=True))
    assert crank[min(crank)] == pytest.approx(0.4931412894, rel=1e-8)  # the periodic spline through the four values
    assert document["peaks"]["Mkr"]["value"] == pytest.approx(0.5, rel=1e-6)


def test_what_looks_like_a_slip_is_said_and_strictly_refused(engine):
    engine.write_text("gravity = [0, -9810]\n" + engine.read_text(encoding="utf-8"), encoding="utf-8")
    for command in ("results", "check"):
        done = linkproof(command, engine)
        assert (done.returncode, "warning: gravity is 9810 m/s^2" in done.stdout) == (0, True)
        strict = linkproof(command, engine, "--strict")
        assert (strict.returncode, "--strict: gravity is 9810 m/s^2" in strict.stderr) == (2, True)
    assert "gravity is 9810" in json.loads(linkproof("results", engine, "--json", "-").stdout)["warnings"][0]


def test_without_masses_there_are_no_torques_and_a_line_says_so(tmp_path, engine):
    text = "\n".join(line for line in engine.read_text().splitlines() if not line.startswith(("mass", "inertia")))
    (tmp_path / "light.toml").write_text(text)
    done = linkproof("results", tmp_path / "light.toml")
    assert done.returncode == 0, done.stderr
    assert "No torques and forces: no link has mass, and there are no loads." in done.stdout
    assert "torque N" not in done.stdout


FAULTS = [
    ({"time": (0.07,)}, "--time: expected instants from 0 to 0.06 s"),
    ({"time": (-1.0,)}, "--time: expected instants from 0"),
    ({"at": (5.0,), "from_angle": 30.0, "to_angle": 60.0}, "--at: expected what the motion passes, from 30° to 60°"),
    ({"at": (0.0,), "time": (0.0,)}, "--at and --time both choose"),
    ({"csv": "."}, "cannot write '.'"),
    ({"csv": "engine.toml/t.csv"}, "cannot write 'engine.toml/t.csv'"),
    ({"svg": "engine.toml"}, "--svg 'engine.toml' would take the place of the linkage's file"),
    ({"figure": "torque"}, "--figure torque needs a file: name one with --svg, --png or --pdf"),
    ({"figure": "tork", "png": "a.png"}, "unknown figure 'tork': did you mean 'torque'?"),
    ({"gif": "-"}, "--gif: expected the name of a file, got '-'"),
    ({"svg": "a.dxf"}, "--svg: expected the name of a .svg file, got 'a.dxf'"),
    ({"pdf": "-"}, "--pdf: expected the name of a file, got '-'"),
    ({"svg": "a.png"}, "--svg: expected the name of a .svg file, got 'a.png'; --svg writes no .png"),
    ({"csv": "a.XLSX"}, "--csv: expected the name of a .csv file"),
    ({"xlsx": "a.csv"}, "--xlsx: expected the name of a .xlsx file, got 'a.csv'; --xlsx writes no .csv"),
    ({"xlsx": "-"}, "--xlsx: expected the name of a file, got '-'"),
    ({"csv": "a.csv", "decimal": ";"}, "--decimal: expected . or , in the numbers of --csv, got ';'"),
    ({"decimal": ","}, "--decimal belongs to the table of --csv"),
    ({"csv": "-", "json": "-"}, "--csv and --json cannot both go to stdout"),
    ({"csv": "a", "svg": "a"}, "--csv and --svg cannot both go to 'a'"),
    ({"regime": ("all",)}, "expected one motion"),
    ({"regime": ("nothing",)}, "unknown regime 'nothing'"),
    ({"ramp_time": 0.1}, "add --regime run-up"),
    ({"speed": 0.0}, "--speed: expected a finite number of rpm other than 0"),
    ({"variant": "none"}, "unknown variant"),
    ({"from_angle": 10.0}, "add --to"),
]


@pytest.mark.parametrize(("choice", "said"), FAULTS, ids=lambda part: "" if isinstance(part, str) else str(part))
def test_what_cannot_be_is_said_and_nothing_is_written(engine, tmp_path, monkeypatch, choice, said):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(LinkproofError) as error:
        results(*shared_out({"mechanism": str(engine), **choice}, ResultsOptions, ResultsFiles))
    assert said in str(error.value)
    assert {path.name for path in tmp_path.iterdir()} == {"engine.toml"}


@pytest.mark.parametrize(("option", "package"), [("xlsx", "openpyxl"), ("dxf", "ezdxf")])
def test_a_package_that_is_missing_is_one_sentence_with_the_cure(engine, tmp_path, monkeypatch, option, package):
    monkeypatch.setattr("reports.command_line.destination.find_spec", lambda name: None if name == package else name)
    error = refused("results", engine, f"--{option}", f"a.{option}", cwd=tmp_path)
    cure = f"install it with: pip install 'linkproof[{option}]'"
    assert error == f"linkproof: --{option}: expected {package}, got none: {cure}\n"


def test_a_fault_is_one_sentence_and_exit_code_2(engine, tmp_path):
    for option, text in (("--at", "0,x"), ("--at", ""), ("--at", "nan"), ("--time", "0.01,inf")):
        error = refused("results", engine, option, text, "--csv", "t.csv", cwd=tmp_path)
        assert error.startswith(f"linkproof: {option}: expected finite numbers with commas between them")
    assert {path.name for path in tmp_path.iterdir()} == {"engine.toml"}


def test_the_page_is_written_into_a_folder_beside_those_of_other_linkages(engine, tmp_path, monkeypatch):
    shown = []
    monkeypatch.setattr("webbrowser.open", shown.append)
    other = tmp_path / "other.toml"
    other.write_text(piston_text(), encoding="utf-8")
    out = tmp_path / "pages"
    results(ResultsOptions(mechanism=str(engine)), ResultsFiles(out=out), quiet=True)
    results(ResultsOptions(mechanism=str(other), speed=500.0), ResultsFiles(out=out), opens=True, quiet=True)
    results(ResultsOptions(mechanism=str(engine), speed=200.0), ResultsFiles(out=out), quiet=True)
    pages = {path.name: path.read_text(encoding="utf-8") for path in (out / "mechanisms").iterdir()}
    assert set(pages) == {"engine.base.html", "other.base.html"}
    assert "200 rpm" in pages["engine.base.html"]
    assert "500 rpm" in pages["other.base.html"]
    assert all(f"mechanisms/{name}" in (out / "index.html").read_text(encoding="utf-8") for name in pages)
    assert shown == [(out / "mechanisms" / "other.base.html").as_uri()]


def test_a_page_that_is_nowhere_cannot_be_opened(engine):
    with pytest.raises(LinkproofError, match="--open shows the page that --out writes"):
        results(ResultsOptions(mechanism=str(engine)), ResultsFiles(), opens=True)
