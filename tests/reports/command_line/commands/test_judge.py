"""``linkproof judge`` as a user meets it: verdict first, causes, corrections, exit codes, JSON, the mapping."""

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from typer.testing import CliRunner

from analytic.description.crank_motion import crank_motion, swing
from analytic.description.crank_motion.table import table_motion
from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.faults.simulation import Simulation
from reports.command_line.app import app
from tests.comparisons.imported.exported import samples
from tests.comparisons.imported.layouts import Channel, csv

JUKI = load("juki-mf7923d")
BOOM = str(Path(__file__).parents[3] / "linkages" / "drives" / "boom.toml")
NAMES = {"Mkr": "N*m", "S": "m", "v": "m/s"}


@pytest.fixture
def run(tmp_path, monkeypatch):
    """The command on a file of the closed form, its torque times a factor; returns exit code and output."""
    monkeypatch.chdir(tmp_path)
    time = np.linspace(0.0, 0.7, 351)
    values = Simulation(JUKI, crank_motion("run-up")).predicted([samples(name, time) for name in NAMES])

    def command(*words, factor=1.0):
        channels = [
            Channel(n, u, factor * v if n == "Mkr" else v) for (n, u), v in zip(NAMES.items(), values, strict=True)
        ]
        (tmp_path / "run.csv").write_text(csv([Channel("time", "s", time), *channels]))
        result = CliRunner().invoke(app, ["judge", "juki-mf7923d", "run.csv", *words])
        if isinstance(result.exception, LinkproofError):
            raise result.exception
        return result.exit_code, result.stdout

    return command


def test_a_right_file_passes_and_the_limit_is_said(run):
    code, text = run("--regime", "run-up")
    assert code == 0
    assert text.splitlines()[1].startswith("Right at the file's samples: all 3 signals are within 1.0 %")  # few samples
    assert "Likely" not in text


def test_a_sign_is_named_offered_and_passes_once_the_mapping_agrees(run, tmp_path):
    code, text = run("--regime", "run-up", "--write-mapping", "mapping.toml", factor=-1.0)
    assert code == 1
    assert text.splitlines()[2].startswith("Likely cause of the difference in Mkr: Mkr has the other sign")
    assert "accept it in the mapping: Mkr: sign = -1.\n" in text
    mapping = tmp_path / "mapping.toml"
    lines = mapping.read_text().splitlines()
    agreed = [line.removeprefix("# ") if "sign = -1" in line else line for line in lines]
    assert agreed != lines
    mapping.write_text("\n".join(agreed))
    code, text = run("--regime", "run-up", "--mapping", "mapping.toml", factor=-1.0)
    assert code == 0
    assert "Accepted in the mapping and applied: Mkr: sign = -1" in text


def test_json_on_stdout_is_one_object(run):
    code, text = run("--regime", "run-up", "--json", "-", "--limit", "0.001", factor=1.01)
    found = json.loads(text)
    assert code == 1
    assert found["passed"] is False
    assert {record["quantity"]: record["outcome"] for record in found["records"]} == {
        "Mkr": "over-limit",
        "S": "passed",
        "v": "passed",
    }
    assert found["causes"][0]["signals"] == ["Mkr"]
    assert found["signals"][0]["column"] == "Mkr [N*m]"


def test_what_cannot_be_is_one_sentence(run):
    with pytest.raises(LinkproofError, match=r"--limit: expected a positive share"):
        run("--limit", "0")
    with pytest.raises(LinkproofError, match=r"say how the crank moves with --regime"):
        run()
    with pytest.raises(LinkproofError, match=r"expected one motion of the crank"):
        run("--regime", "run-up", "--regime", "run-up-cubic")


def test_a_mapping_that_is_there_is_not_overwritten_but_by_itself(run, tmp_path):
    mapping = tmp_path / "mapping.toml"
    run("--regime", "run-up", "--write-mapping", "mapping.toml")
    text = mapping.read_text()
    with pytest.raises(LinkproofError, match="exists already: use it with --mapping"):
        run("--regime", "run-up", "--write-mapping", "mapping.toml")
    assert mapping.read_text() == text
    assert run("--regime", "run-up", "--mapping", "mapping.toml", "--write-mapping", "mapping.toml")[0] == 0


def test_the_page_begins_with_the_verdict_and_its_cause(run, tmp_path):
    run("--regime", "run-up", "--out", "page", factor=-1.0)
    page = (tmp_path / "page" / "index.html").read_text(encoding="utf-8")
    head = page[page.index("<header>") : page.index("<section")].replace("\N{NO-BREAK SPACE}", " ")
    assert "Juki MF-7923D needle mechanism" in head
    assert "Not right: 1 of 3 signals over" in head
    assert "Likely cause of the difference in Mkr: Mkr has the other sign" in head
    assert "accept it in the mapping: Mkr: sign = -1" in head
    assert "not installed" not in page
    summary = (tmp_path / "page" / "RESULTS.md").read_text(encoding="utf-8")
    assert "Mkr has the other sign" in summary

    assert "Mkr of the file and of the closed form" in page
    assert (tmp_path / "page" / "figures" / "index" / "judged-Mkr.svg").is_file()


def test_the_picture_has_both_curves_what_the_cause_leaves_the_worst_place_and_a_caption(run, tmp_path):
    code, text = run("--regime", "run-up", "--svg", "curve.svg", factor=-1.0)
    assert (code, "Likely cause" in text) == (1, True)
    root = ElementTree.parse(tmp_path / "curve.svg").getroot()
    tag = root.tag.removesuffix("svg")
    words = ["".join(one.itertext()) for one in root.iter(f"{tag}text")]
    for part in ("juki-mf7923d (as-built) against run.csv", "Likely cause: Mkr has the other sign.", "closed form",
                 "file", "without the cause", "Mkr, N m", "difference, N m", "time, s"):  # fmt: skip
        assert part in words
    (time,) = [float(one.split()[2]) for one in words if one.startswith("worst at")]
    rows = np.loadtxt(tmp_path / "run.csv", delimiter=",", skiprows=1)
    assert time == pytest.approx(rows[np.argmax(np.abs(rows[:, 1])), 0])
    paths = [one for one in root.iter(f"{tag}path") if len(re.findall("[ML]", one.get("d", ""))) > 1]
    reference, file, without, difference, left = [
        np.array([float(y) for y in re.findall(r"[ML] \S+ (\S+)", path.get("d"))])
        for path in paths
        if re.search("#a9b3bf|#0072b2|#00855f", path.get("style", "")) and "M" in path.get("d")
    ][:5]
    assert np.corrcoef(reference, file)[0, 1] < -0.99
    assert np.ptp(without) == pytest.approx(np.ptp(reference), rel=0.1)
    assert np.ptp(left) < 1e-3 * np.ptp(difference)
    assert run("--regime", "run-up", "--svg", "-")[1].startswith("<?xml")


def test_an_open_signal_is_in_the_headline_with_its_cure_and_the_exit_code_is_not_zero(run, tmp_path):
    time = np.linspace(0.0, 1.0, 401)
    angle = 3.0 * time + 0.2 * np.sin(40.0 * time)
    values = Simulation(JUKI, table_motion("own", time[::5], angle[::5])).predicted(
        [samples(name, time) for name in ("phi", "Mkr", "S")]
    )
    channels = [Channel(n, u, v) for n, u, v in zip(("phi", "Mkr", "S"), ("rad", "N*m", "m"), values, strict=True)]
    (tmp_path / "open.csv").write_text(csv([Channel("time", "s", time), *channels], digits=3))
    result = CliRunner().invoke(app, ["judge", "juki-mf7923d", "open.csv"])
    assert result.exit_code == 1
    lines = result.stdout.splitlines()
    assert (
        lines[1]
        == "Right within the file's digits: 1 of 2 signals within 1.0 % of the closed form's peak; 1 undecided: Mkr."
    )
    assert lines[2].startswith("Mkr is undecided: the rounding of the crank's motion causes")
    assert lines[2].endswith("or say how it moves with --regime.")


def test_a_swing_of_a_cylinder_is_asked_for_in_the_unit_of_its_file(tmp_path):
    boom = load(BOOM)
    time = np.linspace(0.0, 2.0, 101)  # a cycloidal law is twice as fast as its mean at most, which 1 s gives
    (force,) = Simulation(boom, swing("cycloidal", 0.42, 0.45, speed=0.03)).predicted([samples("Mkr", time)])
    (tmp_path / "run.csv").write_text(csv([Channel("time", "s", time), Channel("Mkr", "N", force)]))
    words = ["--regime", "cycloidal", "--from", "420", "--to", "450"]
    result = CliRunner().invoke(app, ["judge", BOOM, str(tmp_path / "run.csv"), *words])
    assert result.exit_code == 0
    assert "Right: the signal is within" in result.stdout
