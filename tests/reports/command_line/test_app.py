"""Help, version and completion."""

import os
import re
from unittest.mock import patch

import pytest

from analytic.description.crank_motion import LAWS, REGIMES
from comparisons.judging.quantities import QUANTITIES
from comparisons.stress.cells import axes
from engines.contract import Setting
from engines.registry import engine_names
from reports.command_line.parameters import GLOSSARY
from tests.commands import ROOT, linkproof


def completed(*words):
    """The words that bash offers for the last of these words."""
    variables = {
        "_LINKPROOF_COMPLETE": "complete_bash",
        "COMP_WORDS": " ".join(("linkproof", *words)),
        "COMP_CWORD": str(len(words)),
    }
    with patch.dict(os.environ, variables):
        return linkproof().stdout.split()


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
        assert not re.search(r"\bbool\b|<|[^\]}]\.\.\.", done.stdout), command
        assert max(map(len, done.stdout.splitlines())) <= 80, command


def test_version():
    done = linkproof("--version")
    assert (done.returncode, done.stdout.split()[0]) == (0, "linkproof")


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
