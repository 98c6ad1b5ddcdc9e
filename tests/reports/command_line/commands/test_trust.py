"""`sweep --simulate`: a campaign of designs below the sweep's folder, which every command reads; what is refused."""

import json

import pytest
from typer.testing import CliRunner

from analytic.description.changes import numbers
from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.campaign import campaign
from comparisons.campaign.results import load as load_campaign
from comparisons.folders.verification import verify
from engines.registry import engine, why_unavailable
from reports.command_line.commands import trust
from reports.command_line.commands.sweep import SweepChoice, run
from reports.command_line.commands.trust_choice import TrustChoice
from reports.command_line.designs_app import app
from reports.command_line.destination import Destination
from tests.comparisons.faults import announce

QUICK = {"speed": 120.0, "gives_speed": True, "jobs": 1, "quantities": ("Mkr.peak",)}
MISSING = [name for name in ("exudyn", "pymunk") if why_unavailable(engine(name))]


def sweep(trial, folder=None, *, vary=("rod.B.x=166:178:4",), resume=False, quiet=True, **options):
    mechanism = options.pop("mechanism", "rimoldi-164")
    choice = SweepChoice(mechanism=mechanism, vary=vary, trial=trial, **{**QUICK, **options})
    return run(choice, Destination(folder=folder, resume=resume, quiet=quiet))


@pytest.fixture(scope="module")
def simulated(tmp_path_factory):
    folder = tmp_path_factory.mktemp("trust") / "sweep"
    assert sweep(TrustChoice(("direct",), 3), folder) == 0
    return folder


def test_a_sample_is_a_campaign_of_its_own(simulated):
    found = verify(simulated / trust.FOLDER)
    assert found.records
    assert not found.findings
    told = json.loads((simulated / trust.FILE).read_text())
    names = ["rimoldi-164", *(f"rimoldi-164-d00{number}" for number in (1, 2, 3))]
    assert [one["mechanism"] for one in told["designs"]] == names
    assert [linkage.name for linkage in load_campaign(simulated / trust.FOLDER).linkages] == names
    assert (simulated / trust.FOLDER / "index.html").is_file()
    assert not (simulated / trust.FOLDER / "unfinished").exists()
    assert "<svg" in (simulated / trust.PICTURE).read_text()
    for one in told["designs"][1:]:
        own = load(str(simulated / trust.DESIGN_FILES / f"{one['mechanism']}.toml"))
        assert numbers(own)["rod.B.x"] == pytest.approx(1e-3 * one["rod.B.x"], rel=1e-15)
        assert 166.0 <= one["rod.B.x"] <= 178.0
    assert {run["standing"] for run in told["runs"]} == {"within limits"}


def test_what_is_done_is_not_done_again(tmp_path, monkeypatch):
    """A command that is cut short after its runs finds them all: with --resume none is made anew."""

    def cut(*_):
        raise KeyboardInterrupt

    trial = TrustChoice(("direct",), 2)
    monkeypatch.setattr(trust, "judged_campaign", cut)
    with pytest.raises(KeyboardInterrupt, match="repeat the command with --resume to finish"):
        sweep(trial, tmp_path / "sweep")
    assert len(list((tmp_path / "sweep" / trust.FOLDER / "unfinished").iterdir())) == 4  # three runs and the request
    assert not (tmp_path / "sweep" / "sweep.nc").exists()
    monkeypatch.undo()
    monkeypatch.setattr(campaign, "judged", cut)
    assert sweep(trial, tmp_path / "sweep", resume=True) == 0
    assert (tmp_path / "sweep" / "sweep.nc").is_file()


def test_an_engine_that_fails_is_a_finding(tmp_path, monkeypatch, capsys):
    announce(tmp_path, "flawed", {"short-sighted": "tests.comparisons.designs.engines_with_flaws:ShortSighted"})
    monkeypatch.syspath_prepend(str(tmp_path))
    assert sweep(TrustChoice(("short-sighted",), 12, seed=5), quiet=False) == 0
    text = capsys.readouterr().out
    assert "Designs simulated: 12 of a Latin hypercube over the ranges (seed 5) and that of the file" in text
    assert "short-sighted tuned: gives way where rod.B.x is below 17" in text


def test_rows_of_a_table_are_simulated(tmp_path, capsys):
    table = tmp_path / "designs.csv"
    table.write_text("rod.B.x,rod.mass\n" + "".join(f"{170 + n},0.{n}\n" for n in range(1, 5)))
    assert sweep(TrustChoice(("direct",), 9), vary=(), table=table, quiet=False) == 0
    assert "Designs simulated: 4 of the table's 4, drawn at random (seed 0)" in capsys.readouterr().out


def test_a_crank_that_makes_no_turn_is_simulated_over_its_range(tmp_path, capsys):
    text = (
        load("rimoldi-164").text.replace("A = [12, 0]", "A = [30, 0]").replace("[-5, 175]", "[-5, 190]")
    )  # so long that the rocker stops it
    (tmp_path / "long.toml").write_text(text)
    trial = TrustChoice(("direct",), 2)
    options = {"mechanism": str(tmp_path / "long.toml"), "vary": ("rod.mass=0.1:0.2:3",)}
    assert sweep(trial, quiet=False, **options) == 0
    text = capsys.readouterr().out
    assert "120 rpm, from " in text
    assert "direct tuned: all 3 designs that were judged are within their limits" in text


@pytest.mark.skipif(bool(MISSING), reason=f"{', '.join(MISSING)} not installed")
def test_two_engines_side_by_side(capsys):
    assert sweep(TrustChoice(("exudyn", "pymunk"), 2), quiet=False) == 0
    text = capsys.readouterr().out
    rows = [line.split() for line in text.splitlines() if line.startswith(("exudyn tuned ", "pymunk tuned "))]
    assert [row[2:6] for row in rows] == [["3", "0", "0", "0"]] * 2


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--simulate", "exudin"], "unknown engine 'exudin': did you mean 'exudyn'?"),
        (["--simulate", "direct", "--designs", "0"], "--designs: expected 1 design or more to simulate, got 0"),
        (["--designs", "8"], "--designs is for designs that are simulated: name an engine with --simulate"),
        (["--simulate", "direct", "--seed", "-1"], "--seed: expected a whole number, 0 or more, got -1"),
    ],
)
def test_bad_input_leaves_nothing(words, sentence, tmp_path):
    out = tmp_path / "sweep"
    ended = CliRunner().invoke(app, ["sweep", "rimoldi-164", "--vary", "rod.B.x=170:178:3", *words, "--out", str(out)])
    assert isinstance(ended.exception, LinkproofError)
    assert sentence in str(ended.exception)
    assert not out.exists()
