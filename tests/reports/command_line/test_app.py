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


MOTION = "variant regime speed ramp-time hold-time start-angle from to no-gravity"
SWING = "variant speed from to no-gravity"
# Commands and their options, --help apart; hidden ones count.
OFFERED = {
    "list": "json",
    "new": "like",
    "check": "variant save json strict",
    "results": f"{MOTION} at time decimal figure out open save json strict quiet",
    "watch": f"{MOTION} no-open",
    "sweep": f"{SWING} vary table quantity scale-mass refine save json quiet",
    "optimise": f"{SWING} minimise maximise over keep scale-mass global round save json quiet",
    "tolerance": f"{SWING} scale-mass samples save json quiet",
    "judge": f"{MOTION} map limit encoding out save json quiet verbose",
    "engines": "check try json quiet",
    "compare": f"{MOTION} engine setting quantity out save json junit quiet verbose limits against "
    "record script time-limit memory-limit jobs scheduler",
    "bench": f"{MOTION} engine quantity quick out json quiet verbose",
    "stress": "engine setting quick out json quiet verbose jobs scheduler",
}
MOST = 150
# Commands and options of 1.0; those about designs refused a --regime.
TURNING = f"{MOTION} clockwise"
BEFORE = {
    "list": "figures numbers json",
    "show": "variant json",
    "new": "",
    "check": "variant svg json strict",
    "schema": "",
    "thread": "variant required json",
    "published": "literature json",
    "results": f"{TURNING} at time csv decimal xlsx json svg png pdf gif dxf figure out open strict quiet",
    "watch": f"{TURNING} port no-open",
    "engines": "json",
    "compare": f"{TURNING} engine setting quantity full out json junit resume quiet verbose limits baseline "
    "record-baseline allow-new allow-missing time-limit memory-limit jobs scheduler",
    "judge": f"{TURNING} map limit encoding out json quiet verbose svg write-mapping",
    "bench": f"{TURNING} engine quantity quick costs out json resume quiet verbose scheduler",
    "stress": "engine setting quick time-limit out json resume quiet verbose jobs scheduler",
    "check-engine": "json quiet jobs",
    "doctor": "json",
    "export": f"{TURNING} engine setting cell out",
    "sweep": f"{SWING} clockwise regime vary table quantity scale-mass angles refine simulate designs seed jobs "
    "scheduler csv svg out json resume quiet",
    "optimise": f"{SWING} clockwise regime minimise maximise over keep scale-mass angles starts seed global "
    "round simulate out json quiet",
    "tolerance": "variant regime from to clockwise no-gravity scale-mass angles samples seed json csv svg quiet",
    "report": "out single-file csv png open",
    "verify": "limits json quiet",
    "diff": "json quiet verbose",
    "merge": "out",
}
COMMANDS = main_app.app.commands
NOW = {
    name: [flag.removeprefix("--") for option in command.params for flag in option.opts if flag.startswith("--")]
    for name, command in COMMANDS.items()
}


def test_every_option_of_every_command_is_listed():
    assert {name: sorted(words.split()) for name, words in OFFERED.items()} == {n: sorted(o) for n, o in NOW.items()}
    assert sum(map(len, NOW.values())) <= MOST


@pytest.mark.parametrize("command", [name for name in BEFORE if name not in NOW])
def test_a_command_that_is_gone_is_answered(command):
    assert refused(command, "juki-mf7923d", "--json").startswith(f"linkproof: {command}: ")


@pytest.mark.parametrize("command", [name for name in BEFORE if name in NOW])
def test_an_option_that_is_gone_is_answered(command):
    for option in {*BEFORE[command].split()} - {*NOW[command]}:
        with pytest.raises(LinkproofError, match=f"^--{option}: "):
            COMMANDS[command].make_context(command, ["x", f"--{option}", "y"])


@pytest.mark.parametrize("file", ["-", "r.json"])
def test_a_file_after_json_is_answered(file):
    assert "--json: takes no file and prints on stdout" in refused("compare", "juki-mf7923d", "--json", file)
