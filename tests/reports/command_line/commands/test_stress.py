"""The stress command: names are checked before anything runs, cells are made alone, maps are written and resumed."""

import json
from dataclasses import replace

import pytest

from analytic.errors import LinkproofError
from comparisons.stress import campaign
from comparisons.stress.cell_result import StressVerdict
from reports.command_line.commands import stress
from reports.command_line.commands.stress import run
from reports.command_line.destination import Destination
from reports.requests.options.campaign import StressOptions
from reports.requests.options.declaring import command_line
from tests.comparisons.faults import PATIENCE


@pytest.fixture(autouse=True)
def _unhurried(monkeypatch):
    """A cell may take minutes where nothing else is said."""
    monkeypatch.setattr(campaign, "_seconds", lambda request, _: request.time_limit or PATIENCE)


CELL = "start/positions/1e-08/direct/tuned"


@pytest.mark.parametrize(
    ("choice", "options", "words"),
    [
        (StressOptions(words=("mas",)), {}, "mass"),
        (StressOptions(words=("start/positions/1e-08/direct",)), {}, "AXIS/ROW/VALUE/ENGINE/USAGE"),
        (StressOptions(words=("start/positions/much/direct/tuned",)), {}, "got 'much'"),
        (StressOptions(words=("start", CELL)), {}, "either axes or cells"),
        (StressOptions(engine=("nobody",)), {}, "nobody"),
        (StressOptions(), {"destination": Destination(resume=True)}, "with --out"),
        (StressOptions(), {"jobs": 0}, "--jobs"),
        (StressOptions(time_limit=0.0), {}, "--time-limit"),
    ],
)
def test_what_cannot_be_is_said_before_any_cell_is_made(choice, options, words, monkeypatch):
    monkeypatch.setattr(stress, "stress", lambda *_: pytest.fail("cells were made"))
    with pytest.raises(LinkproofError, match=words):
        run(choice, **{"destination": Destination(), **options})


def test_no_cell_at_all_is_no_success(tmp_path):
    choice = StressOptions(words=("start",), engine=("direct",), setting=("no such setting",), quick=True)
    with pytest.raises(LinkproofError, match="no stability run matches no such setting"):
        run(choice, Destination(out=tmp_path))
    assert list(tmp_path.iterdir()) == []


def test_a_cell_alone_is_told_in_full(capsys):
    assert run(StressOptions(words=(CELL,)), Destination()) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert told.startswith(f"{CELL}: within limit")
    assert "Worst invariant:" in told


def test_a_cell_may_take_as_long_as_it_is_given(capsys):
    choice = StressOptions(words=(CELL,), time_limit=1e-3)
    assert command_line("stress", choice) == f"linkproof stress {CELL} --time-limit 0.001"
    assert run(choice, Destination()) == 0
    assert "took longer than 0.001 s" in " ".join(capsys.readouterr().out.split())


def test_a_cell_alone_as_json(capsys):
    assert run(StressOptions(words=(CELL,)), Destination(json="-")) == 0
    (cell,) = json.loads(capsys.readouterr().out)["cells"]
    assert (cell["verdict"], cell["command"]) == ("within limit", f"linkproof stress '{CELL}'")


def test_maps_are_written_and_the_journal_is_gone(tmp_path, capsys):
    choice = StressOptions(words=("start",), engine=("direct",), setting=("tuned",), quick=True)
    assert run(choice, Destination(out=tmp_path)) == 0
    files = {path.name for path in tmp_path.iterdir()}
    assert files == {"stress", "stress.html", "index.html", "assets", "figures"}
    assert "missed 0" in " ".join(capsys.readouterr().out.split())


def test_a_missed_cell_fails_the_command(monkeypatch, capsys):
    def missed(*_):
        found = campaign.make_cells([stress.find_cell(CELL)])
        return [_as_missed(one) for one in found]

    monkeypatch.setattr(stress, "make_cells", missed)
    assert run(StressOptions(words=(CELL,)), Destination()) == 1
    assert "missed" in capsys.readouterr().out


def _as_missed(result):
    return replace(result, verdict=StressVerdict.MISSED, reason="no invariant saw it")
