"""pytest's way to linkproof: no harm to a project that has nothing to do with it, a sentence where it cannot begin."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
OWN = "from reports.own import MINE\n\n\ndef test_it():\n    assert MINE == 1\n"


@pytest.fixture
def run(tmp_path):
    """Run pytest in a project with a package ``reports`` of its own, where the plug-in is installed."""
    for name, text in (("reports/__init__.py", ""), ("reports/own.py", "MINE = 1"), ("tests/test_own.py", OWN)):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    place = tmp_path / "installed" / "strangers_friend-1.dist-info"
    place.mkdir(parents=True)
    (place / "METADATA").write_text("Metadata-Version: 2.1\nName: strangers-friend\nVersion: 1\n")
    (place / "entry_points.txt").write_text("[pytest11]\nstrangers_friend = linkproof.pytest_plugin\n")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tmp_path / "installed"), str(ROOT)])}

    def call():
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:linkproof", "-n0"]
        return subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)

    return call


def test_a_project_with_packages_of_our_names_runs_its_tests(run):
    done = run()
    assert done.returncode == 0, done.stdout + done.stderr
    assert "1 passed" in done.stdout


def test_in_a_project_of_linkages_a_stranger_is_named_in_a_sentence(run, tmp_path):
    (tmp_path / "linkproof.toml").touch()
    done = run()
    assert done.returncode == pytest.ExitCode.USAGE_ERROR
    assert f"expected linkproof's package 'reports' in '{ROOT}', got another one" in done.stderr
    assert "Traceback" not in done.stderr
