"""``linkproof results`` as a designer meets it: tables, files, and one sentence for every fault."""

import json

import numpy as np
import pytest

from analytic.errors import install_words
from tests.analytic.linkages import DOUBLE_ROCKER, path_of
from tests.commands import linkproof, refused
from tests.reports.designs.samples import piston_text


@pytest.fixture
def engine(tmp_path):
    (tmp_path / "engine.toml").write_text(piston_text("mm", 1e-3, "deg"), encoding="utf-8")
    return tmp_path / "engine.toml"


def test_all_files_at_once_and_json_to_stdout_alone(engine, tmp_path):
    formats = ("csv", "json", "xlsx", "pdf", "dxf")
    words = [word for name in formats for word in ("--save", f"t.{name}")]
    motion = ("--regime", "run-up", "--ramp-time", "0.02", "--hold-time", "0.01", "--decimal", ",", "--json")
    done = linkproof("results", engine, *motion, *words, cwd=tmp_path)
    assert done.stderr == "".join(f"wrote t.{name}\n" for name in formats)
    document = json.loads(done.stdout)
    assert json.loads((tmp_path / "t.json").read_text(encoding="utf-8")) == document
    assert document["axis"] == "time"
    assert "run-up, up to 1000 rpm" in document["conditions"]
    assert (tmp_path / "t.csv").read_text().startswith("\ufefftime [s];phi [deg];")
    assert {path.name for path in tmp_path.iterdir()} == {"engine.toml", *(f"t.{name}" for name in formats)}


def test_a_torque_over_the_angle_is_the_drives(tmp_path):
    released = """
[regimes.push]
start_angle = 70
duration = 0.05
angle = [0, 90, 180, 270]
torque = [0.4, 0.5, 0.4, 0.3]
"""
    (tmp_path / "rocker.toml").write_text(DOUBLE_ROCKER + released, encoding="utf-8")
    document = json.loads(linkproof("results", "rocker.toml", "--regime", "push", "--json", cwd=tmp_path).stdout)
    assert document["axis"] == "time"
    assert document["conditions"].startswith("rocker (base): released at 70°")
    crank = dict(zip(np.degrees(document["values"]["phi"]), document["values"]["Mkr"], strict=True))
    assert crank[min(crank)] == pytest.approx(0.4931412894, rel=1e-8)  # the periodic spline through the four values
    assert document["peaks"]["Mkr"]["value"] == pytest.approx(0.5, rel=1e-6)


def test_a_likely_mistake_is_a_warning_and_with_strict_an_error(engine):
    engine.write_text("gravity = [0, -9810]\n" + engine.read_text(encoding="utf-8"), encoding="utf-8")
    assert "warning: gravity is 9810 m/s^2" in linkproof("check", engine).stdout
    for command in ("results", "check"):
        strict = linkproof(command, engine, "--strict")
        assert (strict.returncode, "--strict: gravity is 9810 m/s^2" in strict.stderr) == (2, True)
    assert "gravity is 9810" in json.loads(linkproof("results", engine, "--json").stdout)["warnings"][0]


def test_a_line_names_what_cannot_be_computed_or_is_numerical(tmp_path, engine):
    text = "\n".join(line for line in engine.read_text().splitlines() if not line.startswith(("mass", "inertia")))
    (tmp_path / "light.toml").write_text(text)
    done = linkproof("results", tmp_path / "light.toml")
    assert done.returncode == 0, done.stderr
    assert "No torques and forces: no link has mass, and there are no loads." in done.stdout
    assert "torque N" not in done.stdout
    assert "the figures are a numerical reference" in linkproof("results", path_of("ternary-on-rods")).stdout


FAULTS = [
    ("--time 0.07", "--time: expected instants from 0 to 0.06 s"),
    ("--at 5 --from 30 --to 60", "--at: expected values that the motion passes, from 30° to 60°"),
    ("--at 0 --time 0", "--at and --time both choose"),
    ("--save engine.toml/t.csv", "cannot write 'engine.toml/t.csv'"),
    ("--save t.csv --save t.doc", "--save t.doc: the suffix must be one of .csv, .json, .xlsx, .svg, .png, .pdf, .dxf"),
    ("--save t.csv --save ./t.csv", "are the same file: leave one out"),
    ("--save link.csv", "--save link.csv would take the place of a file that is read: give another name"),
    ("--figure torque", "--figure needs a file: name a .svg, .png or .pdf with --save"),
    ("--save a.csv --decimal ;", "--decimal: expected . or , in the numbers of a .csv, got ';'"),
    ("--decimal ,", "--decimal belongs to a table"),
    ("--regime all", "expected one motion"),
    ("--ramp-time 0.1", "add --regime run-up"),
    ("--at 0,x", "--at: expected finite numbers with commas between them"),
    ("--time 0.01,inf", "--time: expected finite numbers with commas between them"),
    ("--open", "--open shows the page that --out writes"),
]


@pytest.mark.parametrize(("words", "sentence"), FAULTS)
def test_bad_input_is_one_sentence_and_nothing_is_written(engine, tmp_path, words, sentence):
    (tmp_path / "link.csv").symlink_to(engine)
    assert sentence in refused("results", "engine.toml", *words.split(), cwd=tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"engine.toml", "link.csv"}


@pytest.mark.parametrize(("suffix", "package"), [("xlsx", "openpyxl"), ("dxf", "ezdxf")])
def test_a_missing_package_is_one_sentence_with_the_cure(engine, tmp_path, monkeypatch, suffix, package):
    monkeypatch.setattr("reports.document.study.find_spec", lambda name: None if name == package else name)
    error = refused("results", engine, "--save", f"a.{suffix}", cwd=tmp_path)
    cure = f"install it with: {install_words(suffix)}"
    assert error == f"linkproof: --save a.{suffix}: expected {package}, got none: {cure}\n"


def test_the_page_is_written_into_a_folder_beside_those_of_other_linkages(engine, tmp_path, monkeypatch):
    shown = []
    monkeypatch.setattr("webbrowser.open", shown.append)
    (tmp_path / "other.toml").write_text(piston_text(), encoding="utf-8")
    out = tmp_path / "pages"
    for words in ((engine,), (tmp_path / "other.toml", "--speed", 500, "--open"), (engine, "--speed", 200)):
        assert linkproof("results", *words, "--out", out, "--quiet").returncode == 0
    pages = {path.name: path.read_text(encoding="utf-8") for path in (out / "mechanisms").iterdir()}
    assert set(pages) == {"engine.base.html", "other.base.html"}
    assert "200 rpm" in pages["engine.base.html"]
    assert "500 rpm" in pages["other.base.html"]
    assert all(f"mechanisms/{name}" in (out / "index.html").read_text(encoding="utf-8") for name in pages)
    assert shown == [(out / "mechanisms" / "other.base.html").as_uri()]
