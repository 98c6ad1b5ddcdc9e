"""What Windows lacks and does otherwise, as far as it can be tried elsewhere: no POSIX modules, cp1252, CRLF."""

import json
import os
import subprocess
import sys

import pytest

from analytic.description.loading import read
from tests.commands import ROOT

COMMANDS = (
    ("compare", "press.toml", "--engine", "direct", "--jobs", "0", "--out", "made", "--verbose"),
    ("compare", "unix/press.toml", "--engine", "direct", "--jobs", "0", "--quiet", "--out", "other"),
    ("list",),
    ("engines",),
    ("check", "press.toml"),
    ("results", "press.toml"),
)
RUNNING = f"""
import sys
for name in ("resource", "fcntl", "termios", "pwd", "grp"):
    sys.modules[name] = None
import importlib, pkgutil, analytic, engines, comparisons, linkproof, reports
for top in (analytic, engines, comparisons, linkproof, reports):
    for module in pkgutil.walk_packages(top.__path__, top.__name__ + "."):
        try:
            importlib.import_module(module.name)
        except ModuleNotFoundError as absent:  # an engine or a package that need not be installed
            if absent.name not in ("exudyn", "mujoco", "opensim", "pydrake", "pymunk", "pyondsel"):
                raise
from reports.command_line.main import main
for words in {COMMANDS}:
    sys.argv = ["linkproof", *words]
    try:
        main()
    except SystemExit as end:
        if end.code:
            sys.exit(f"{{words}} ended with {{end.code}}")
"""


@pytest.mark.nightly
def test_commands_run_and_a_text_with_other_line_ends_is_the_same_linkage(tmp_path):
    """A linkage file as an editor on Windows saves it, and one with line ends of Unix; no text in a local encoding."""
    text = read("juki-mf7923d").text
    (tmp_path / "press.toml").write_bytes(text.replace("\n", "\r\n").encode())
    (tmp_path / "unix").mkdir()
    (tmp_path / "unix" / "press.toml").write_text(text, encoding="utf-8", newline="\n")
    environment = {"PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "cp1252", "LINKPROOF_WORKER_START": "spawn"}
    done = subprocess.run(
        [sys.executable, "-X", "warn_default_encoding", "-c", RUNNING],
        capture_output=True, encoding="cp1252", check=False, cwd=tmp_path, env=os.environ | environment,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    warnings = [line for line in done.stderr.splitlines() if "EncodingWarning" in line and str(ROOT) in line]
    assert [line for line in warnings if "site-packages" not in line] == []  # an environment may lie within the tree
    assert "passed" in done.stdout
    files = [tmp_path / folder / "compare" / "study.json" for folder in ("made", "other")]
    documents = [json.loads(file.read_text(encoding="utf-8")) for file in files]
    first, second = ([row["checksum"] for row in document["descriptions"]] for document in documents)
    assert first == second
