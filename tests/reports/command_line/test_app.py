"""Help, version, completion; all commands and options there are, and a sentence for every one of 1.0 that is gone."""

import os
import re
from unittest.mock import patch

import pytest

from analytic.description.crank_motion import LAWS, REGIMES
from analytic.errors import LinkproofError
from comparisons.trials.judging.quantities import QUANTITIES
from comparisons.trials.stress.cells import axes
from engines.contract import Setting
from engines.registry import engine_names
from reports.command_line import app as main_app
from reports.command_line.parameters import GLOSSARY
from tests.commands import ROOT, linkproof, refused


def completed(*words):
    """The words that bash offers for the last of these words."""
    variables = {
        "_LINKPROOF_COMPLETE": "bash_complete",
        "COMP_WORDS": " ".join(("linkproof", *words)),
        "COMP_CWORD": str(len(words)),
    }
    with patch.dict(os.environ, variables):
        return [word.partition(",")[2] for word in linkproof().stdout.split()]


def test_help_explains_every_symbol_in_the_words_of_the_page_of_quantities():
    glossary = GLOSSARY.read_text(encoding="utf-8").strip()
    assert linkproof("--help").stdout.rstrip().endswith(glossary)
    rows = [re.split(r"\s{2,}", line.strip()) for line in glossary.splitlines()[1:]]
    assert [symbol for symbol, *_ in rows] == ["φ", "ω", "ε", "S", "v", "a", "Jeq", "Teq", "Mkr", "Peq"]
    page = (ROOT / "docs" / "quantities.md").read_text(encoding="utf-8")
    assert [row for row in rows if f"| {' | '.join(row)} |" not in page] == []


def test_help_of_every_command_has_no_types_no_cut_sentences_and_no_long_lines():
    listed = linkproof("--help").stdout.partition("Commands:")[2].partition("\n\n")[0]
    assert "..." not in listed
    commands = re.findall(r"^  ([a-z][a-z-]*) ", listed, re.MULTILINE)
    assert {"list", "compare", "sweep", "optimise", "tolerance", "watch", "engines"} <= {*commands}
    for command in commands:
        done = linkproof(command, "--help")
        assert done.returncode == 0
        assert not re.search(r"\bbool\b|<|[^\]A-Z]\.\.\.", done.stdout), command
        assert max(map(len, done.stdout.splitlines())) <= 80, command


@pytest.mark.parametrize(
    ("words", "names"),
    [
        (("check", "ju"), ["juki-mf7923d"]),
        (("check", "andr"), ["andrews-squeezer"]),
        (("compare", "--engine", ""), engine_names()),
        (("compare", "--setting", ""), [*Setting, "all"]),
        (("bench", "--quantity", ""), QUANTITIES),
        (("compare", "--regime", ""), {*REGIMES, *LAWS, "own", "all"}),
        (("stress", ""), axes()),
        (("check", "juki-mf7923d", "--variant", "as-"), ["as-built", "as-printed"]),  # of the file that is named
        (("compare", "slotted-takeup", "--regime", "dr"), ["driven"]),
        (("sweep", "rimoldi-164", "--vary", "rod.B."), ["rod.B.x=", "rod.B.y="]),
        (("sweep", "rimoldi-164", "--quantity", "Mkr.p"), ["Mkr.peak"]),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_names_are_completed(words, names):
    assert sorted(completed(*words)) == sorted(names)


def test_a_file_is_completed_from_its_folder(tmp_path, monkeypatch):
    (tmp_path / "mine.toml").write_text("")
    monkeypatch.chdir(tmp_path)
    assert completed("check", "mi") == ["mine.toml"]


@pytest.mark.parametrize(
    ("shell", "script", "settings"),
    [("bash", ".bash_completions/linkproof.sh", ".bashrc"), ("zsh", ".zfunc/_linkproof", ".zshrc")],
)
def test_completion_is_installed_once(tmp_path, monkeypatch, shell, script, settings):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("SHELL", f"/bin/{shell}")
    for _ in range(2):
        assert linkproof("--install-completion").returncode == 0
    shown = linkproof("--show-completion").stdout
    assert f"_LINKPROOF_COMPLETE={shell}_complete" in shown
    assert (tmp_path / script).read_text().strip() == shown.strip()
    assert len((tmp_path / settings).read_text().split("\n\n")) == 1


def test_an_unknown_shell_is_named(monkeypatch):
    monkeypatch.setenv("SHELL", "/bin/strange")
    assert "got 'strange'" in refused("--show-completion")


MOST = 150
# What 1.0 had: commands, and options of commands that there still are.
GONE_COMMANDS = "show schema thread published check-engine doctor export report verify diff merge"
GONE = {
    "list": "figures numbers",
    "check": "svg",
    "results": "clockwise csv xlsx svg png pdf gif dxf",
    "watch": "clockwise port",
    "compare": "clockwise full resume baseline record-baseline allow-new allow-missing",
    "judge": "clockwise svg write-mapping",
    "bench": "clockwise costs resume scheduler",
    "stress": "time-limit resume",
    "sweep": "clockwise regime angles simulate designs seed jobs scheduler csv svg out resume",
    "optimise": "clockwise regime angles starts seed simulate out",
    "tolerance": "regime clockwise angles seed csv svg",
}
COMMANDS = main_app.app.commands


def test_no_more_options_are_offered_than_a_user_can_take_in():
    every = [flag for command in COMMANDS.values() for option in command.params for flag in option.opts]
    assert sum(flag.startswith("--") for flag in every) <= MOST


@pytest.mark.parametrize("command", GONE_COMMANDS.split())
def test_a_command_that_is_gone_is_answered(command):
    assert refused(command, "juki-mf7923d", "--json").startswith(f"linkproof: {command}: ")


@pytest.mark.parametrize("command", GONE)
def test_an_option_that_is_gone_is_answered(command):
    for option in GONE[command].split():
        with pytest.raises(LinkproofError, match=f"^--{option}: "):
            COMMANDS[command].make_context(command, ["x", f"--{option}", "y"])


@pytest.mark.parametrize("file", ["-", "r.json"])
def test_a_file_after_json_is_answered(file):
    assert "--json: takes no file and prints on stdout" in refused("compare", "juki-mf7923d", "--json", file)
