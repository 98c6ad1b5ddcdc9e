"""Help, version and completion."""

import os
import re
from pathlib import Path
from unittest.mock import patch

import pytest

from analytic.description.crank_motion import LAWS, REGIMES
from comparisons.judging.quantities import QUANTITIES
from comparisons.stress.axes import axes
from engines.contract import Setting
from engines.registry import engine_names
from reports.command_line.app import GLOSSARY
from tests.commands import linkproof

COMMANDS = ("list", "new", "check", "schema", "show", "results", "thread", "published", "compare", "bench", "stress")
COMMANDS += ("export", "report")


def completed(*words):
    """What bash is offered for the last of these words."""
    line = " ".join(("linkproof", *words))
    asked = {"_LINKPROOF_COMPLETE": "complete_bash", "COMP_WORDS": line, "COMP_CWORD": str(len(words))}
    with patch.dict(os.environ, asked):
        return linkproof().stdout.split()


def test_help_explains_every_symbol():
    shown = linkproof("--help").stdout
    assert shown.rstrip().endswith(GLOSSARY.read_text(encoding="utf-8").strip())
    named = [words.split()[0] for words in GLOSSARY.read_text(encoding="utf-8").strip().splitlines()[1:]]
    assert named == ["φ", "ω", "ε", "S", "v", "a", "Jeq", "Teq", "Mkr", "Peq"]


@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_a_command_has_no_types_and_no_cut_sentences(command):
    done = linkproof(command, "--help")
    assert done.returncode == 0
    assert "bool" not in done.stdout
    assert "<" not in done.stdout
    assert "..." not in done.stdout.replace("]...", "")
    assert max(map(len, done.stdout.splitlines())) <= 80


def test_commands_are_listed_with_whole_sentences():
    shown = linkproof("--help").stdout
    assert all(f"\n  {command} " in shown for command in COMMANDS)
    assert "..." not in shown.partition("Commands:")[2]


def test_version():
    done = linkproof("--version")
    assert (done.returncode, done.stdout.split()[0]) == (0, "linkproof")


def test_names_are_completed():
    assert completed("show", "ju") == ["juki-mf7923d"]
    assert completed("show", "andr") == ["andrews-squeezer"]
    assert completed("compare", "--engine", "") == list(engine_names())
    assert completed("compare", "--setting", "") == sorted([*Setting, "all"])
    assert completed("bench", "--quantity", "") == sorted(QUANTITIES)
    assert set(completed("compare", "--regime", "")) == {*REGIMES, *LAWS, "own", "all"}
    assert set(completed("stress", "")) == set(axes())


def test_variants_and_regimes_of_the_file_that_is_named_are_completed():
    assert completed("show", "juki-mf7923d", "--variant", "as-") == ["as-built", "as-printed"]
    assert completed("compare", "slotted-takeup", "--regime", "dr") == ["driven"]
    assert completed("compare", "watt-six-bar", "--regime", "near") == ["near-toggles"]


def test_a_file_is_completed_from_where_it_lies(tmp_path, monkeypatch):
    (tmp_path / "mine.toml").write_text("")
    monkeypatch.chdir(tmp_path)
    assert completed("show", "mi") == ["mine.toml"]


def test_the_page_of_quantities_explains_the_same_symbols_in_the_same_words():
    page = (Path(__file__).parents[3] / "docs" / "quantities.md").read_text(encoding="utf-8")
    for words in GLOSSARY.read_text(encoding="utf-8").strip().splitlines()[1:]:
        symbol, unit, meaning = re.split(r"\s{2,}", words.strip())
        assert f"| {symbol} | {unit} | {meaning} |" in page
