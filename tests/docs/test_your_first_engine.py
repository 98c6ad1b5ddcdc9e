"""The adapter that docs/your-first-engine.md builds, installed as its page says, is found and keeps the contract."""

import contextlib
import os
import re
import subprocess
import sys
import tomllib
from importlib import import_module
from pathlib import Path

import pytest

from comparisons.trials.conformance.conformance import CHECKS
from comparisons.trials.conformance.slips import MUTANT
from comparisons.trials.conformance.trial import EngineTrial, NotTestedError
from tests.comparisons.faults import announce
from tests.comparisons.trials.conformance.wrong_engines import WRONG

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "your-first-engine.md").read_text(encoding="utf-8")
BLOCKS = dict(re.findall(r"^```\w+ (\S+)\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL))
PROJECT = tomllib.loads(BLOCKS["pyproject.toml"])["project"]


@pytest.fixture
def barwork(tmp_path, monkeypatch):
    """A folder with the page's files, its engine announced."""
    for name, text in BLOCKS.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
        monkeypatch.delitem(sys.modules, Path(name).stem, raising=False)
    announce(tmp_path, "barwork", PROJECT["entry-points"]["linkproof.engines"])
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.nightly
def test_its_adapter_passes_the_conformance_test_where_it_is_installed(tmp_path):
    source, folder = tmp_path / "written", tmp_path / "installed"
    source.mkdir()
    for name, text in BLOCKS.items():
        (source / name).write_text(text, encoding="utf-8")
    offline = ["--no-index", "--no-deps", "--no-build-isolation", "--quiet"]
    subprocess.run([sys.executable, "-m", "pip", "install", *offline, "--target", str(folder), str(source)], check=True)
    path = os.pathsep.join([str(folder), str(ROOT)])
    command = [sys.executable, "-m", "reports.command_line.main", "engines", "barwork", "--check"]
    environment = {**os.environ, "PYTHONPATH": path}
    done = subprocess.run(command, capture_output=True, text=True, cwd=folder, env=environment, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"silence +expected failure +barwork's licence requires its line", done.stdout)
    assert int(re.search(r"(\d+) mutants +passed", done.stdout).group(1)) >= 10
    assert " failed" not in done.stdout


def test_an_error_in_its_loop_is_named_with_file_and_line(barwork):
    loop, line = BLOCKS["barwork_loop.py"].replace("mechanism.step(", "mechanism.stepp("), "mechanism.stepp(end)"
    (barwork / "barwork_loop.py").write_text(loop, encoding="utf-8")
    number = 1 + [text.strip() for text in loop.splitlines()].index(line)
    detail = CHECKS["installed"].result(EngineTrial(import_module("linkproof_barwork").BarworkEngine())).detail
    assert "raised AttributeError: 'Mechanism' object has no attribute 'stepp'" in detail
    assert f"barwork_loop.py, line {number}): correct it" in detail


def test_its_thirty_lines_pass_every_check_of_an_engine_that_has_positions_alone():
    names = {"__name__": "pinwork"}
    exec(BLOCKS["pinwork.py"], names)
    trial, passed = EngineTrial(names["PinworkEngine"]()), set()
    for check in CHECKS.values():
        if check.name.startswith(MUTANT):
            continue
        with contextlib.suppress(NotTestedError):
            check.examine(trial)
            passed.add(check.name)
    assert passed >= {"positions", "samples", "refusals", "settings", "recording"}


def test_the_page_has_every_check_and_the_words_of_a_failed_one():
    rows = [f"| {check.name} | {check.about} |" for check in CHECKS.values() if not check.name.startswith(MUTANT)]
    assert "\n".join(rows) in PAGE
    (failure,) = re.findall(r"failed  (drive torque, .*), …", PAGE)
    with pytest.raises(AssertionError, match=re.escape(failure)):
        CHECKS["drive torque"].examine(EngineTrial(WRONG["torque reversed"][0]))
