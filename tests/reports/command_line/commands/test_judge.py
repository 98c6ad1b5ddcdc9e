"""``linkproof judge`` as a user meets it: verdict first, causes, corrections, exit codes, JSON."""

import json
import re

import numpy as np
import pytest

from analytic.description.crank_motion import RPM, crank_motion, swing
from analytic.description.loading import load
from comparisons.filejudge.columns import SignalTimes
from comparisons.filejudge.simulation import Simulation
from tests.analytic.linkages import path_of
from tests.commands import linkproof, refused
from tests.comparisons.filejudge.layouts import Channel, csv

JUKI = load("juki-mf7923d")
NAMES = {"Mkr": "N*m", "S": "m", "v": "m/s"}
RUN_UP = ("--regime", "run-up")


@pytest.fixture(scope="module")
def curves():
    """Instants and the closed form's own values of a run-up."""
    time = np.linspace(0.0, 0.7, 141)
    return time, Simulation(JUKI, crank_motion("run-up")).predict([SignalTimes(name, time) for name in NAMES])


@pytest.fixture
def folder(tmp_path, monkeypatch, curves):
    """A folder with the closed form's values as ``right.csv``, and as ``wrong.csv`` with the opposite torque."""
    time, values = curves
    for name, factor in (("right", 1.0), ("wrong", -1.0), ("off", 1.01)):
        channels = [
            Channel(signal, unit, (factor if signal == "Mkr" else 1.0) * column)
            for (signal, unit), column in zip(NAMES.items(), values, strict=True)
        ]
        (tmp_path / f"{name}.csv").write_text(csv([Channel("time", "s", time), *channels]))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def judge(*words):
    return linkproof("judge", "juki-mf7923d", *words)


def test_a_sign_is_named_and_passes_once_it_is_accepted(folder):
    done = judge("wrong.csv", *RUN_UP)
    assert done.returncode == 1
    assert done.stdout.splitlines()[2].startswith("Likely cause of the difference in Mkr: Mkr has the other sign")
    assert 'accept it with --map "Mkr [N*m]=-Mkr [N*m]".\n' in done.stdout
    done = judge("wrong.csv", *RUN_UP, "--map", "Mkr [N*m]=-Mkr [N*m]")
    assert done.returncode == 0
    assert 'Accepted and applied: --map "Mkr [N*m]=-Mkr [N*m]".' in done.stdout


def test_a_speed_alone_is_a_constant_speed(folder):
    time = np.linspace(0.0, 0.1, 61)
    motion = crank_motion("constant-speed", speed=600.0 * RPM)
    (torque,) = Simulation(JUKI, motion).predict([SignalTimes("Mkr", time)])
    steady = [Channel("time", "s", time), Channel("Mkr", "N*m", torque)]
    over_angle = [Channel("phi", "deg", 3600.0 * time), steady[1]]
    (folder / "steady.csv").write_text(csv(steady, digits=9))
    (folder / "angle.csv").write_text(csv(over_angle, digits=9))
    assert [judge(name, "--speed", "600").returncode for name in ("steady.csv", "angle.csv")] == [0, 0]
    assert judge("steady.csv", "--speed", "700").returncode == 1
    sentence = refused("judge", "juki-mf7923d", "angle.csv", *RUN_UP, "--speed", "600")
    assert "'Mkr [N*m]' is over the crank angle, which does not say when the crank was there in 'run-up'" in sentence


def test_a_small_difference_of_a_right_file_is_told_with_its_cause(folder):
    done = judge("off.csv", *RUN_UP, "--limit", "0.02")
    assert done.returncode == 0
    assert (
        "Right within 2.0 %; a 1.00 % difference remains: every mass and moment of inertia is 1.01 times" in done.stdout
    )


def test_json_on_stdout_is_one_object(folder):
    done = judge("wrong.csv", *RUN_UP, "--json")
    document = json.loads(done.stdout)
    assert (done.returncode, document["passed"]) == (1, False)
    outcomes = {record["quantity"]: record["outcome"] for record in document["records"]}
    assert outcomes == {"Mkr": "over-limit", "S": "passed", "v": "passed"}
    assert document["causes"][0]["signals"] == ["Mkr"]
    assert document["signals"][0]["column"] == "Mkr [N*m]"


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--limit", "0"), "--limit: expected a positive finite number, such as 0.01, got 0"),
        ((), "say how the crank moves with --regime"),
    ],
)
def test_bad_input_is_one_sentence(folder, words, sentence):
    assert sentence in refused("judge", "juki-mf7923d", "right.csv", *words)


def test_the_page_begins_with_the_verdict_and_its_cause(folder):
    judge("wrong.csv", *RUN_UP, "--out", "page")
    page = (folder / "page" / "index.html").read_text(encoding="utf-8")
    head = page[page.index("<header>") : page.index("<section")].replace("\N{NO-BREAK SPACE}", " ")
    for words in (
        "Juki MF-7923D needle mechanism", "Not right: 1 of 3 signals over",
        "Likely cause of the difference in Mkr: Mkr has the other sign", "accept it with --map",
    ):  # fmt: skip
        assert words in head
    assert "not installed" not in page
    assert re.search(r'"opens":"[\w-]+/Mkr"', page)  # its curves


def test_a_swing_of_a_cylinder_is_given_in_the_unit_of_its_file(tmp_path):
    boom = path_of("boom")
    time = np.linspace(0.0, 2.0, 51)  # a cycloidal law is twice as fast as its mean at most, which 1 s gives
    simulation = Simulation(load(boom), swing("cycloidal", 0.42, 0.45, speed=0.03))
    (force,) = simulation.predict([SignalTimes("Mkr", time)])
    (tmp_path / "run.csv").write_text(csv([Channel("time", "s", time), Channel("Mkr", "N", force)]))
    done = linkproof("judge", boom, tmp_path / "run.csv", "--regime", "cycloidal", "--from", "420", "--to", "450")
    assert done.returncode == 0
    assert "Right: the signal is within" in done.stdout
    sentence = "has times up to 2 s, and the stated motion 'constant-speed' ends at 1 s: correct the motion"
    assert sentence in refused("judge", boom, tmp_path / "run.csv", "--from", "420", "--to", "450")
