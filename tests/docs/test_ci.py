"""The repository that docs/ci.md describes: green by its commands and its action, red once a mass is changed by 1 %."""

import os
import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml

from comparisons.campaign.project import read_project
from tests.comparisons.faults import announce
from tests.reports.pytest_plugin.projects import PLUGIN

ROOT = Path(__file__).parents[2]
BLOCK = re.compile(r"^```\w+ (\S+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
PAGE = dict(BLOCK.findall((ROOT / "docs" / "ci.md").read_text(encoding="utf-8")))
PLUGGED = dict(BLOCK.findall((ROOT / "docs" / "your-first-engine.md").read_text(encoding="utf-8")))
ACTION = yaml.safe_load((ROOT / "docs" / "ci" / "action.yml").read_text(encoding="utf-8"))
PROGRAMS = {"linkproof": "-m linkproof", "pytest": f"-m pytest -p {PLUGIN}", "python": ""}
INPUT = re.compile(r"\$\{\{ inputs\.(\w+) \}\}")


class Repository:
    """A stranger's repository in a folder, with two linkages, and a plug-in engine as it is installed."""

    def __init__(self, folder: Path) -> None:
        self.folder, outside = folder / "repository", folder / "installed"
        for name in ("linkages", "tests"):
            (self.folder / name).mkdir(parents=True)
        for ours, theirs in (("juki-mf7923d", "press"), ("rimoldi-164", "rod")):
            text = (ROOT / "analytic" / "catalogue" / f"{ours}.toml").read_text(encoding="utf-8")
            (self.folder / "linkages" / f"{theirs}.toml").write_text(
                text.partition("[[published]]")[0], encoding="utf-8"
            )
        for name in ("linkproof.toml", "tests/test_press.py"):
            (self.folder / name).write_text(PAGE[name], encoding="utf-8")
        outside.mkdir()
        announce(outside, "barwork", {"barwork": "linkproof_barwork:BarworkEngine"})
        for name in ("barwork.py", "barwork_loop.py", "linkproof_barwork.py"):
            (outside / name).write_text(PLUGGED[name], encoding="utf-8")
        programs = folder / "programs"
        programs.mkdir()
        for name, words in PROGRAMS.items():
            (programs / name).write_text(f'#!/bin/sh\n[ "$2" = pip ] && exit 0\nexec "{sys.executable}" {words} "$@"\n')
            (programs / name).chmod(0o755)
        self.env = {**os.environ, "PATH": f"{programs}:{os.environ['PATH']}", "PYTHONPATH": f"{outside}:{ROOT}",
                    "GITHUB_STEP_SUMMARY": str(folder / "summary.md")}  # fmt: skip

    def shell(self, text, env=None, folder=None):
        """Run lines as a step of a CI service does."""
        command = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", text]
        place = self.folder / (folder or ".")
        return subprocess.run(
            command, capture_output=True, text=True, cwd=place, env=self.env | (env or {}), check=False
        )

    def action(self, **inputs):
        """Exit codes of the action's own steps by name; after one that failed those alone that run always."""
        given = {name: facts["default"] for name, facts in ACTION["inputs"].items()} | inputs
        codes = {}
        for step in ACTION["runs"]["steps"]:
            if "run" in step and (not any(codes.values()) or step.get("if") == "always()"):
                env, folder = (_filled(step.get(key), given) for key in ("env", "working-directory"))
                codes[step["name"]] = self.shell(step["run"], env, folder).returncode
        return codes

    def heavier(self):
        """Change a mass by 1 %."""
        path = self.folder / "linkages" / "press.toml"
        text = path.read_text(encoding="utf-8")
        assert text.count("= 0.076\n") == 1
        path.write_text(text.replace("= 0.076\n", "= 0.07676\n"), encoding="utf-8")


def _filled(value, inputs):
    if isinstance(value, dict):
        return {name: _filled(text, inputs) for name, text in value.items()}
    return value and INPUT.sub(lambda found: inputs[found[1]], value)


def test_every_input_of_the_action_is_used_and_none_is_unknown():
    text = yaml.safe_dump(ACTION["runs"])
    assert set(INPUT.findall(text)) == set(ACTION["inputs"])
    assert not [step for step in ACTION["runs"]["steps"] if "${{" in step.get("run", "")]  # no input is run as a script
    (job,) = yaml.safe_load(PAGE[".github/workflows/linkages.yml"])["jobs"].values()
    (step,) = (step for step in job["steps"] if step["uses"].startswith("./"))
    assert set(step["with"]) <= set(ACTION["inputs"])


def test_the_command_for_anywhere_is_that_of_the_action():
    (step,) = (step for step in ACTION["runs"]["steps"] if step.get("name") == "Compare")
    command = step["run"].splitlines()[-1].replace('"', "").replace("$REPORT", ACTION["inputs"]["report"]["default"])
    assert command.replace("$ARGUMENTS ", "") == PAGE["anywhere"].strip()


@pytest.mark.nightly
def test_the_repository_is_green_and_red_after_a_mass_has_been_changed_by_a_percent(tmp_path):
    repository = Repository(tmp_path)
    assert {path.stem for path in read_project(repository.folder / "linkproof.toml").linkages} == {"press", "rod"}
    recorded = repository.shell(PAGE["record"])
    assert recorded.returncode == 0, recorded.stdout + recorded.stderr
    tested = repository.shell(PAGE["test"].rstrip() + " tests -v")
    assert tested.returncode == 0, tested.stdout
    for name in (
        "press.toml::run-up-barwork-tuned::Mkr",
        "rod.toml::run-up-pymunk-tuned::S",
        "press.toml::run-up-key-figures::Mkr.peak",
    ):
        assert re.search(rf"{re.escape(name)} PASSED", tested.stdout)

    repository.heavier()
    tested = repository.shell(PAGE["test"].rstrip() + " -k key-figures")
    assert tested.returncode == 1
    assert "linkages/press.toml has changed since its baseline was recorded" in tested.stdout
    assert "linkages/rod.toml::" not in tested.stdout
    assert repository.action() == {"Install": 0, "Compare": 1, "Show": 0}
    assert "barwork" in (tmp_path / "summary.md").read_text(encoding="utf-8")
    report = ElementTree.parse(repository.folder / "linkproof-report" / "junit.xml").getroot()
    failed = {case.get("classname") for case in report.iter("testcase") if case.find("failure") is not None}
    assert failed == {f"press/{variant}/run-up/key figures" for variant in ("as-built", "as-printed")}
