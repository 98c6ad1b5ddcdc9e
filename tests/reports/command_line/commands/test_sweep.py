"""``linkproof sweep`` as a designer meets it: a summary, files, and one sentence for every fault."""

import json
import shutil
import xml.etree.ElementTree as ET
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import xarray

from analytic.description.changes import numbers
from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.campaign.results import load as load_campaign
from reports.command_line.commands.sweep import sweep
from reports.command_line.destination import Destination
from reports.requests.designs_options import SweepFiles, SweepOptions
from tests.comparisons.faults import announce
from tests.options import shared_out

VARY = ("rod.B.x=160:18cm:5", "rod.mass=100g:0.2:3")
PLAIN = {"mechanism": "rimoldi-164", "vary": VARY, "quantity": ("Mkr.peak", "stroke"), "angles": 12}
QUICK = {"vary": ("rod.B.x=166:178:13",), "quantity": ("Mkr.peak",), "speed": 120.0, "jobs": 1}


def swept(folder=None, *, quiet=True, **options):
    return sweep(
        *shared_out({**PLAIN, **options, "out": folder, "quiet": quiet}, SweepOptions, SweepFiles, Destination)
    )


def table(path):
    lines = path.read_text(encoding="utf-8").splitlines()
    return lines[0].split(","), np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])


def test_every_file_has_the_same_values_and_the_summary_counts_assembled_designs(tmp_path, capsys):
    out = tmp_path / "out"
    swept(out, csv=str(tmp_path / "t.csv"), quiet=False)
    lines = capsys.readouterr().out.splitlines()
    assert lines[1] == (
        "15 (5 × 3) designs, of which 9 (60 %) assemble at every angle: rod.B.x from 170 to 180 mm, rod.mass from 0.1 "
        "to 0.2 kg"
    )
    assert lines[-2:] == [f"wrote {out / name}" for name in ("sweep.nc", "sweep.svg")]
    head, rows = table(tmp_path / "t.csv")
    assert head == ["rod.B.x [mm]", "rod.mass [kg]", "Mkr.peak [N*m]", "stroke [mm]"]
    swept(json=True)
    document = json.loads(capsys.readouterr().out)
    with xarray.open_dataset(out / "sweep.nc") as dataset:
        assert dataset.sizes == {"rod.B.x": 5, "rod.mass": 3}
        np.testing.assert_allclose(dataset["stroke"].values.ravel(), rows[:, 3], rtol=1e-14)
        assert dataset.attrs["command"] == (
            "linkproof sweep rimoldi-164 --vary rod.B.x=160:18cm:5 --vary rod.mass=100g:0.2:3 --quantity Mkr.peak "
            "--quantity stroke --angles 12"
        )
        assert (dataset.attrs["angles"], dataset.attrs["refined"]) == (12, 0)
    assert (document["designs"], document["assembled"]) == (15, 9)
    least = document["figures"]["stroke"]["least"]
    row = rows[np.nanargmin(rows[:, 3])]
    assert [least["at"]["rod.B.x"], least["at"]["rod.mass"], round(least["value"], 9)] == [*row[:2], round(row[3], 9)]
    peak = rows[np.nanargmax(np.abs(rows[:, 2])), 2]
    assert document["figures"]["Mkr.peak"]["largest"]["value"] == pytest.approx(peak, rel=1e-14)


def test_a_picture_is_drawn_on_request_and_into_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    swept()
    assert list(tmp_path.iterdir()) == []
    swept(svg=str(tmp_path / "t.svg"))
    assert ET.parse(tmp_path / "t.svg").getroot().tag.endswith("svg")
    assert [path.name for path in tmp_path.iterdir()] == ["t.svg"]
    picture = tmp_path / "out" / "sweep.svg"
    swept(picture.parent, quiet=False)
    assert picture.read_text() == (tmp_path / "t.svg").read_text()
    swept(picture.parent)  # quiet
    assert not picture.exists()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"vary": ("rod.B.q=1:2:3",)}, "unknown parameter of 'rimoldi-164' 'rod.B.q': did you mean"),
        ({"vary": ("speed=-10:10:3",)}, "speed: expected speeds on one side of 0, got -10 to 10"),
        ({"vary": ()}, "got neither"),
        ({"table": Path("designs.csv")}, "got both"),
        ({"vary": (), "table": Path("designs.csv")}, "No such file"),
        ({"vary": ("rod.B.x=100:110:3",)}, "expected designs that assemble, got none of 3, for 'rimoldi-164' cannot"),
        ({"vary": (f"rod.B.x=170:180:{10**6}", f"rod.mass=1:2:{10**5}")}, "expected room for 100000000000 designs"),
        ({"simulate": ("exudin",)}, "unknown engine 'exudin': did you mean 'exudyn'?"),
        ({"simulate": ("direct",), "designs": 0}, "--designs: expected 1 design or more to simulate, got 0"),
        ({"designs": 8}, "--designs is for designs that are simulated: name an engine with --simulate"),
        ({"simulate": ("direct",), "seed": -1}, "--seed: expected a whole number, 0 or more, got -1"),
        ({"jobs": 0}, "--jobs: expected 1 or more cores, got 0"),
    ],
)
def test_bad_input_is_a_sentence_and_writes_nothing(tmp_path, monkeypatch, options, words):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: SimpleNamespace(free=10**9))
    with pytest.raises(LinkproofError) as error:
        swept(tmp_path / "new" / "out", csv="t.csv", **options)
    assert words in str(error.value)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("without_pictures")
def test_designs_are_simulated_in_a_campaign_of_their_own(tmp_path, capsys):
    out = tmp_path / "out"
    swept(out, **QUICK, simulate=("direct",), designs=4, quiet=False)
    sentence = "direct tuned: within limits on 4 of 4 designs judged; with 95 % certainty fewer than 75% of such"
    assert sentence in capsys.readouterr().out
    names = [linkage.name for linkage in load_campaign(out / "simulated").linkages]
    assert {*names} == {path.stem for path in (out / "designs").iterdir()}
    rods = [numbers(load(str(path)))["rod.B.x"] for path in (out / "designs").iterdir()]
    assert len({*rods}) == 4
    assert all(0.166 <= rod <= 0.178 and abs(1e3 * rod - round(1e3 * rod)) < 1e-9 for rod in rods)  # of the sweep
    assert (out / "simulated" / "index.html").is_file()


def test_the_number_that_separates_failing_designs_is_named(tmp_path, monkeypatch, capsys):
    announce(tmp_path, "flawed", {"short-sighted": "tests.comparisons.designs.engines_with_flaws:ShortSighted"})
    monkeypatch.syspath_prepend(str(tmp_path))
    assert swept(**QUICK, simulate=("short-sighted",), designs=13, quiet=False) == 1
    text = capsys.readouterr().out
    assert "short-sighted tuned: within limits on 7 of 12 designs judged\n" in text
    assert "fails where rod.B.x is 171.0 mm or less: there lie 5 of 5 failing designs and 0 of 7 others" in text
    assert "the rod is too short" in text


def test_a_crank_that_makes_no_turn_is_simulated_over_its_range(tmp_path, capsys):
    text = load("rimoldi-164").text.replace("A = [12, 0]", "A = [30, 0]").replace("[-5, 175]", "[-5, 190]")
    (tmp_path / "long.toml").write_text(text)  # its crank is so long that the rocker stops it
    options = {**QUICK, "mechanism": str(tmp_path / "long.toml"), "vary": ("rod.mass=0.1:0.2:3",)}
    swept(**options, simulate=("direct",), designs=1, quiet=False)
    assert "within limits on 1 of 1 designs judged" in capsys.readouterr().out
