"""The command: what it asks for, refuses, writes and returns, with engines that are there."""

import json
from dataclasses import replace

import pytest

from analytic.errors import LinkproofError, UnknownNameError
from comparisons.work_precision import costs
from comparisons.work_precision.points import Extent
from comparisons.work_precision.records import load
from reports.command_line.commands import bench as bench_command
from reports.command_line.commands.bench import bench
from reports.command_line.destination import Destination
from reports.requests.options.campaign import BenchOptions, RunsOptions
from reports.requests.options.declaring import command_line
from tests.comparisons.faults import PATIENCE

SHORT = Extent((12.0, 24.0, 48.0), budget=PATIENCE, repeats=2, patience=PATIENCE)
CHOICE = BenchOptions(
    mechanisms=("juki-mf7923d",), engine=("direct",), regime=("run-up-quintic",), quantity=("Mkr",), quick=True
)
COMMAND = "linkproof bench juki-mf7923d --regime run-up-quintic --engine direct --quantity Mkr --quick"


@pytest.fixture
def short(monkeypatch):
    """A benchmark of seconds: a short run-up, three steps."""
    monkeypatch.setattr(bench_command, "QUICK", SHORT)
    hurried = RunsOptions(
        mechanisms=("juki-mf7923d",), regime=("run-up-quintic",), engine=("direct",), ramp_time=0.1, hold_time=0.0
    )
    monkeypatch.setattr(bench_command, "_campaign", lambda options: hurried)


def test_defaults_are_both_run_ups_and_a_quick_one_the_smooth_alone():
    regimes = bench_command._campaign
    assert regimes(BenchOptions()).regime == ("run-up-quintic", "run-up")
    assert regimes(BenchOptions(quick=True)).regime == ("run-up-quintic",)
    assert regimes(BenchOptions(regime=("own",), quick=True)).regime == ("own",)


@pytest.mark.parametrize(
    ("options", "times"),
    [
        ({"quick": True}, (0.06, 0.03)),
        ({"quick": True, "speed": -3000.0}, (0.02, 0.01)),
        ({"quick": True, "hold_time": 0.2}, (0.6, 0.2)),
        ({"quick": True, "from_angle": 0.0, "to_angle": 90.0}, (0.6, 0.1)),
        ({}, (0.6, 0.1)),
    ],
    ids=["quick", "faster-and-clockwise", "its-own-time", "swing", "full"],
)
def test_a_quick_benchmark_moves_one_turn_unless_its_times_are_given(options, times):
    options = bench_command._campaign(BenchOptions(**options))
    assert (options.ramp_time, options.hold_time) == pytest.approx(times)


def test_the_command_asks_for_the_same():
    assert command_line("bench", CHOICE) == COMMAND
    assert command_line("bench", BenchOptions()) == "linkproof bench"


def test_a_benchmark_is_printed_written_and_read_back(short, tmp_path, capsys):
    assert bench(CHOICE, Destination(json=str(tmp_path / "r.json"), out=tmp_path / "out")) == 0
    text = capsys.readouterr().out
    assert "juki-mf7923d (as-built), run-up-quintic: Mkr" in text
    assert "to get" in text
    rows = json.loads((tmp_path / "r.json").read_text())["records"]
    assert {row["setting"] for row in rows} >= {"naive", "tuned", "best", "exact"}
    assert {path.name for path in (tmp_path / "out").iterdir()} >= {"bench", "bench.html", "assets", "figures"}
    assert len(load(tmp_path / "out").records) == len(rows)
    assert not (tmp_path / "out" / "unfinished").exists()


def test_costs_are_measured_where_they_are_asked_for(short, monkeypatch, capsys, tmp_path):
    monkeypatch.setattr(costs, "ROUNDS", 1)
    asked = replace(CHOICE, costs=True)
    assert command_line("bench", asked) == f"{COMMAND} --costs"
    assert bench(asked, Destination(json=str(tmp_path / "r.json"))) == 0
    measured = json.loads((tmp_path / "r.json").read_text())["costs"]
    assert {cost["solver"] for cost in measured} >= {"direct"}
    assert "motion alone" in capsys.readouterr().out


def test_json_to_stdout_is_json_and_nothing_else(short, capsys):
    assert bench(CHOICE, Destination(json="-")) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["command"] == COMMAND
    assert found["noise"]["samples"]
    assert found["costs"] == []


@pytest.mark.parametrize(
    ("choice", "kind", "words"),
    [
        (BenchOptions(mechanisms=("jukki",)), UnknownNameError, "known are .*juki-mf7923d"),
        (BenchOptions(engine=("exudin",)), UnknownNameError, "exudyn"),
        (BenchOptions(regime=("runup",)), UnknownNameError, "run-up"),
        (BenchOptions(quantity=("torque",)), UnknownNameError, "Mkr"),
        (
            BenchOptions(mechanisms=("slotted-takeup",), regime=("own",), quantity=("Mkr",)),
            LinkproofError,
            "none of Mkr is a result",
        ),
    ],
)
def test_what_cannot_be_is_refused_before_any_run(choice, kind, words, monkeypatch):
    monkeypatch.setattr(bench_command, "measure_all", lambda *_: pytest.fail("something was run"))
    with pytest.raises(kind, match=words):
        bench(choice, Destination())


def test_resuming_needs_a_folder():
    with pytest.raises(LinkproofError, match="--resume needs the folder of the interrupted run"):
        bench(CHOICE, Destination(resume=True))


def test_an_engine_that_gives_nothing_at_all_fails(short, monkeypatch):
    real = bench_command.measure_all

    def failing(wanted, *rest):
        measured = real(wanted, *rest)
        return replace(measured, points=tuple(replace(one, outcome="diverged") for one in measured.points))

    monkeypatch.setattr(bench_command, "measure_all", failing)
    assert bench(CHOICE, Destination()) == 1
