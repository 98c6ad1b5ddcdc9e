"""``linkproof bench``: its regimes and times, its refusals, its files and its exit code, with the control engine."""

from dataclasses import replace

import pytest

from analytic.errors import LinkproofError, UnknownNameError
from comparisons.work_precision.measure import Extent
from comparisons.work_precision.records import load
from reports.command_line.commands import bench as bench_command
from reports.command_line.commands.bench import bench
from reports.command_line.destination import Destination
from reports.requests.options import BenchOptions, RunsOptions
from tests.comparisons.faults import PATIENCE

SHORT = Extent((12.0, 24.0, 48.0), budget=PATIENCE, repeats=2, patience=PATIENCE)
OPTIONS = BenchOptions(
    mechanisms=("juki-mf7923d",), engine=("direct",), regime=("run-up-quintic",), quantity=("Mkr",), quick=True
)


@pytest.fixture
def short(monkeypatch):
    """A benchmark of seconds: a short run-up, three steps."""
    monkeypatch.setattr(bench_command, "QUICK", SHORT)
    hurried = RunsOptions(
        mechanisms=("juki-mf7923d",), regime=("run-up-quintic",), engine=("direct",), ramp_time=0.1, hold_time=0.0
    )
    monkeypatch.setattr(bench_command, "_default_runs", lambda options: hurried)


@pytest.mark.parametrize(
    ("options", "regimes", "times"),
    [
        ({}, ("run-up-quintic", "run-up"), (0.6, 0.1)),
        ({"quick": True}, ("run-up-quintic",), (0.06, 0.03)),  # a turn, unless its times are given
        ({"quick": True, "regime": ("own",)}, ("own",), (0.06, 0.03)),
        ({"quick": True, "speed": -3000.0}, ("run-up-quintic",), (0.02, 0.01)),
        ({"quick": True, "hold_time": 0.2}, ("run-up-quintic",), (0.6, 0.2)),
        ({"quick": True, "from_angle": 0.0, "to_angle": 90.0}, (), (0.6, 0.1)),
    ],
)
def test_the_regimes_and_times_of_a_benchmark(options, regimes, times):
    options = bench_command._default_runs(BenchOptions(**options))
    assert options.regime == regimes
    assert (options.ramp_time, options.hold_time) == pytest.approx(times)


def test_a_benchmark_is_printed_written_and_read_back(short, tmp_path, capsys):
    assert bench(OPTIONS, Destination(out=tmp_path / "out")) == 0
    text = capsys.readouterr().out
    for words in ("juki-mf7923d (as-built), run-up-quintic: Mkr", "to get"):
        assert words in text
    saved = load(tmp_path / "out").as_dict
    assert {row["setting"] for row in saved["records"]} >= {"naive", "tuned", "best", "exact"}
    assert saved["noise"]["samples"]
    assert saved["command"] == (
        "linkproof bench juki-mf7923d --regime run-up-quintic --engine direct --quantity Mkr --quick"
    )
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names >= {"bench", "bench.html", "assets", "figures"}
    assert "unfinished" not in names
    assert len(load(tmp_path / "out").records) == len(saved["records"])


@pytest.mark.parametrize(
    ("options", "kind", "words"),
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
def test_bad_input_is_refused_before_any_run(options, kind, words, monkeypatch):
    monkeypatch.setattr(bench_command, "measure_all", lambda *_: pytest.fail("something was run"))
    with pytest.raises(kind, match=words):
        bench(options, Destination())


def test_an_engine_that_finishes_no_point_fails(short, monkeypatch):
    real = bench_command.measure_all

    def failing(request, *rest):
        measured = real(request, *rest)
        return replace(measured, points=tuple(replace(point, outcome="diverged") for point in measured.points))

    monkeypatch.setattr(bench_command, "measure_all", failing)
    assert bench(OPTIONS, Destination(quiet=True)) == 1
