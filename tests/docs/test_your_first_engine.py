"""The adapter that docs/your-first-engine.md builds, installed as its page says, is found and keeps the contract."""

import ast
import contextlib
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from comparisons.conformance.conformance import CHECKS
from comparisons.conformance.mutants import MUTANT
from comparisons.conformance.results import NotTestedError
from comparisons.conformance.trial import EngineTrial
from tests.comparisons.conformance.wrong_engines import WRONG

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "your-first-engine.md").read_text(encoding="utf-8")
BLOCKS = dict(re.findall(r"^```\w+ (\S+)\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL))
MOST_LINES = 100  # of the adapter, blank ones left out


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """Run a module's command where the page's files are installed."""
    source, folder = tmp_path_factory.mktemp("written"), tmp_path_factory.mktemp("installed")
    for name, text in BLOCKS.items():
        (source / name).write_text(text, encoding="utf-8")
    (folder / "test_barwork.py").write_text(BLOCKS["test_barwork.py"], encoding="utf-8")
    offline = ["--no-index", "--no-deps", "--no-build-isolation", "--quiet"]
    subprocess.run([sys.executable, "-m", "pip", "install", *offline, "--target", str(folder), str(source)], check=True)

    def call(*command):
        path = os.pathsep.join([str(folder), str(ROOT)])
        return subprocess.run(
            [sys.executable, "-m", *command],
            capture_output=True, text=True, cwd=folder, env={**os.environ, "PYTHONPATH": path}, check=False,
        )  # fmt: skip

    return call


def test_its_adapter_passes_the_conformance_test(run):
    done = run("reports.command_line.main", "check-engine", "barwork")
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"silence +expected failure +barwork's licence requires its line", done.stdout)
    assert int(re.search(r"(\d+) mutants +passed", done.stdout).group(1)) >= 35
    assert " failed" not in done.stdout


def test_its_checks_are_cases_for_pytest(run):
    done = run("pytest", "-q", "-n0", "-p", "no:cacheprovider", "test_barwork.py", "-k", "identity or silence")
    assert done.returncode == 0, done.stdout
    assert re.search(r"\b1 xfailed\b", done.stdout.splitlines()[-1]), done.stdout


def test_its_runs_are_exported_and_the_script_needs_the_simulator_alone(run):
    done = run("reports.command_line.main", "export", "teaching-four-bar", "--engine", "barwork", "--setting", "naive",
               "--speed", "100", "--ramp-time", "0.1", "--hold-time", "0", "--out", "case.py")  # fmt: skip
    assert done.returncode == 0, done.stderr
    shown = run("case")
    assert shown.returncode == 0, shown.stderr
    rows = [line.split() for line in shown.stdout.splitlines() if line.startswith("drive torque")]
    assert rows[0][-4] == rows[0][-3]  # the torque now and when it was exported


def test_its_thirty_lines_pass_every_check_of_an_engine_that_has_positions_alone():
    known = {"__name__": "pinwork"}
    exec(BLOCKS["pinwork.py"], known)
    tree = ast.parse(BLOCKS["pinwork.py"])
    strings = [node for node in ast.walk(tree) if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)]
    lines = [line for line in BLOCKS["pinwork.py"].splitlines() if line.strip()]
    assert len(lines) - len(strings) <= 33
    trial, passed = EngineTrial(known["PinworkEngine"]()), set()
    for check in CHECKS.values():
        if check.name.startswith(MUTANT):
            continue
        with contextlib.suppress(NotTestedError):
            check.examine(trial)
            passed.add(check.name)
    assert passed >= {"positions", "samples", "refusals", "settings", "recording"}


def test_its_package_asks_for_nothing_that_is_not_to_be_had():
    project = tomllib.loads(BLOCKS["pyproject.toml"])["project"]
    assert {*project["dependencies"]} == {"linkproof", "numpy"}


def test_its_adapter_is_short():
    lines = [line for line in BLOCKS["linkproof_barwork.py"].splitlines() if line.strip()]
    assert len(lines) <= MOST_LINES


def test_the_page_has_every_check():
    rows = [f"| {check.name} | {check.about} |" for check in CHECKS.values() if not check.name.startswith(MUTANT)]
    assert "\n".join(rows) in PAGE


def test_a_wrong_sign_is_named_as_the_page_has_it():
    (told,) = re.findall(r"failed  (drive torque, .*), …", PAGE)
    with pytest.raises(AssertionError, match=re.escape(told)):
        CHECKS["drive torque"].examine(EngineTrial(WRONG["torque reversed"][0]))
