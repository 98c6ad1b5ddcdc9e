"""What Windows lacks and does otherwise, as far as it can be tried elsewhere: no POSIX modules, cp1252, CRLF."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from analytic.description.loading import load

pytestmark = pytest.mark.nightly
ROOT = Path(__file__).parents[3]
START = """
import sys
for name in ("resource", "fcntl", "termios", "pwd", "grp"):
    sys.modules[name] = None
"""
EVERYTHING = (
    START
    + """
import importlib, pkgutil, analytic, engines, comparisons, linkproof, reports
for top in (analytic, engines, comparisons, linkproof, reports):
    for module in pkgutil.walk_packages(top.__path__, top.__name__ + "."):
        try:
            importlib.import_module(module.name)
        except ModuleNotFoundError as absent:  # an engine or a package that need not be installed
            if absent.name not in ("exudyn", "fmpy", "mujoco", "opensim", "pydrake", "pymunk", "pyondsel"):
                raise
print(len([name for name in sys.modules if name.startswith("comparisons.")]))
"""
)
COMMANDS = (
    ("compare", "press.toml", "--engine", "direct", "--jobs", "0", "--out", "made", "--verbose"),
    ("compare", "unix/press.toml", "--engine", "direct", "--jobs", "0", "--quiet", "--out", "other"),
    ("list",),
    ("engines",),
    ("show", "press.toml"),
    ("check", "press.toml"),
    ("results", "press.toml"),
    ("published", "juki-mf7923d"),
    ("verify", "made"),
    ("diff", "made", "made", "--verbose"),
    ("report", "made", "--csv", "curves"),
    ("merge", "made", "--out", "merged"),
)
RUNNING = f"""{START}
from reports.command_line.main import main
if __name__ == "__main__":
    for words in {COMMANDS}:
        sys.argv = ["linkproof", *words]
        try:
            main()
        except SystemExit as end:
            if end.code:
                sys.exit(f"{{words}} ended with {{end.code}}")
"""


def _python(script, cwd=ROOT):
    """A Python without the modules that Windows lacks, printing in its old character set."""
    environment = os.environ | {
        "PYTHONPATH": str(ROOT),
        "PYTHONIOENCODING": "cp1252",
        "LINKPROOF_WORKER_START": "spawn",
    }
    command = [sys.executable, "-X", "warn_default_encoding", "-c", script]
    return subprocess.run(command, capture_output=True, encoding="cp1252", check=False, cwd=cwd, env=environment)


def _of_ours(warnings):
    """Warnings of text read or written in whatever the system's character set is, in files of ours."""
    lines = [line for line in warnings.splitlines() if "EncodingWarning" in line and str(ROOT) in line]
    return [line for line in lines if "site-packages" not in line]  # an environment may lie within the tree


def test_everything_is_imported_without_posix_modules():
    done = _python(EVERYTHING)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 100


def test_commands_run_and_a_text_with_other_line_ends_is_the_same_linkage(tmp_path):
    """A linkage file as an editor on Windows saves it, and one with line ends of Unix."""
    text = load("juki-mf7923d").text
    (tmp_path / "press.toml").write_bytes(text.replace("\n", "\r\n").encode())
    (tmp_path / "unix").mkdir()
    (tmp_path / "unix" / "press.toml").write_text(text, encoding="utf-8", newline="\n")
    done = _python(RUNNING, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert _of_ours(done.stderr) == []
    assert "passed" in done.stdout
    documents = [
        json.loads((tmp_path / at / "compare" / "study.json").read_text(encoding="utf-8")) for at in ("made", "other")
    ]
    first, second = ([row["checksum"] for row in document["descriptions"]] for document in documents)
    assert first == second
