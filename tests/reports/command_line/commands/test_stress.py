"""``linkproof stress``: names are checked before anything runs, cells are made alone, maps are written."""

import json
from dataclasses import replace

import pytest

from analytic.errors import LinkproofError
from comparisons.stress import campaign
from comparisons.stress.verdict import StressVerdict, blank_result
from reports.command_line.commands import stress
from reports.command_line.commands.stress import run
from reports.command_line.destination import Destination
from reports.requests.options import StressOptions
from tests.commands import linkproof
from tests.comparisons.faults import PATIENCE

CELL = "start/positions/1e-08/direct/tuned"


@pytest.fixture(autouse=True)
def _unhurried(monkeypatch):
    """A cell may take minutes unless its time is given."""
    monkeypatch.setattr(campaign, "_cell_seconds", lambda *_: PATIENCE)


@pytest.mark.parametrize(
    ("choice", "options", "words"),
    [
        (StressOptions(words=("start", CELL)), {}, "either axes or cells"),
        (StressOptions(engine=("nobody",)), {}, "nobody"),
        (StressOptions(), {"jobs": 0}, "--jobs"),
    ],
)
def test_bad_input_is_refused_before_any_cell_is_made(choice, options, words, monkeypatch):
    monkeypatch.setattr(stress, "stress", lambda *_: pytest.fail("cells were made"))
    with pytest.raises(LinkproofError, match=words):
        run(choice, Destination(), **options)


def test_no_cell_at_all_is_no_success(tmp_path):
    choice = StressOptions(words=("start",), engine=("direct",), setting=("no such setting",), quick=True)
    with pytest.raises(LinkproofError, match="no stability run matches no such setting"):
        run(choice, Destination(out=tmp_path))
    assert list(tmp_path.iterdir()) == []


def test_a_cell_alone_is_printed_in_full_and_written_as_json(capsys):
    assert run(StressOptions(words=(CELL,)), Destination()) == 0
    text = " ".join(capsys.readouterr().out.split())
    assert text.startswith(f"{CELL}: within limit")
    assert "Worst invariant:" in text
    run(StressOptions(words=(CELL,)), Destination(json=True))
    (cell,) = json.loads(capsys.readouterr().out)["cells"]
    assert (cell["verdict"], cell["command"]) == ("within limit", f"linkproof stress '{CELL}'")


def test_maps_are_written_and_the_journal_is_gone(tmp_path, capsys):
    choice = StressOptions(words=("start",), engine=("direct",), setting=("tuned",), quick=True)
    assert run(choice, Destination(out=tmp_path)) == 0
    files = {path.name for path in tmp_path.iterdir()}
    assert files == {"stress", "stress.html", "index.html", "assets", "figures"}
    tables = capsys.readouterr().out
    assert "missed 0" in " ".join(tables.split())
    assert linkproof("stress", "--out", tmp_path).stdout == tables


def test_a_missed_cell_fails_the_command(monkeypatch, capsys):
    within = blank_result(stress.find_cell(CELL), "m")
    missed = replace(within, verdict=StressVerdict.MISSED, reason="no invariant saw it")
    monkeypatch.setattr(stress, "make_cells", lambda *_: [missed])
    assert run(StressOptions(words=(CELL,)), Destination()) == 1
    assert "missed" in capsys.readouterr().out
