"""``linkproof sweep`` as a designer meets it: a summary, files, and one sentence for every fault."""

import json
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pandas
import pytest
import xarray

from analytic.errors import LinkproofError
from reports.command_line.commands.designs import sweep
from reports.command_line.destination import Destination
from reports.requests.options import SweepOptions

VARY = ("rod.B.x=160:18cm:5", "rod.mass=100g:0.2:3")
PLAIN = {"mechanism": "rimoldi-164", "vary": VARY, "quantity": ("Mkr.peak", "stroke")}


def swept(*save, **options):
    sweep(SweepOptions(**{**PLAIN, **options}), Destination(save=save))


def test_every_file_has_the_same_values_and_the_summary_counts_assembled_designs(tmp_path, capsys):
    csv, nc, summary, picture = (tmp_path / f"sweep.{kind}" for kind in ("csv", "nc", "json", "svg"))
    swept(csv, nc, summary, picture)
    assert capsys.readouterr().out.splitlines()[1] == (
        "15 (5 × 3) designs, of which 9 (60 %) assemble at every angle: rod.B.x from 170 to 180 mm, rod.mass from 0.1 "
        "to 0.2 kg"
    )
    table = pandas.read_csv(csv)
    assert [*table] == ["rod.B.x [mm]", "rod.mass [kg]", "Mkr.peak [N*m]", "stroke [mm]"]
    with xarray.open_dataset(nc) as dataset:
        assert dataset.sizes == {"rod.B.x": 5, "rod.mass": 3}
        assert (dataset["stroke"].attrs, dataset["rod.mass"].attrs) == ({"units": "mm"}, {"units": "kg"})
        np.testing.assert_allclose(dataset["stroke"].values.ravel(), table["stroke [mm]"], rtol=1e-14)
        assert dataset.attrs["command"] == (
            "linkproof sweep rimoldi-164 --vary rod.B.x=160:18cm:5 --vary rod.mass=100g:0.2:3 --quantity Mkr.peak "
            "--quantity stroke"
        )
        assert (dataset.attrs["angles"], dataset.attrs["refined"]) == (180, 0)
    document = json.loads(summary.read_text())
    assert (document["designs"], document["assembled"]) == (15, 9)
    least, largest = document["figures"]["stroke"]["least"], document["figures"]["Mkr.peak"]["largest"]
    row = table.loc[table["stroke [mm]"].idxmin()]
    assert [*least["at"].values(), least["value"]] == pytest.approx([*row.iloc[:2], row["stroke [mm]"]], rel=1e-14)
    assert largest["value"] == pytest.approx(table["Mkr.peak [N*m]"].abs().max(), rel=1e-14)
    assert ET.parse(picture).getroot().tag.endswith("svg")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"vary": ("rod.B.q=1:2:3",)}, "unknown parameter of 'rimoldi-164' 'rod.B.q': did you mean"),
        ({"vary": ("speed=-10:10:3",)}, "speed: expected speeds on one side of 0, got -10 to 10"),
        ({"vary": ("rod.mass=-1:1:3",)}, "rod.mass: expected no negative mass, got -1 kg"),
        ({"vary": ()}, "got neither"),
        ({"table": Path("designs.csv")}, "got both"),
        ({"vary": (), "table": Path("designs.csv")}, "No such file"),
        ({"vary": ("rod.B.x=100:110:3",)}, "expected designs that assemble, got none of 3, for 'rimoldi-164' cannot"),
        (
            {"vary": ("rod.B.x=170:180:100000", "rod.mass=1:2:101")},
            "expected 2e+07 values at most, designs times figures, got 10100000 × 2: vary less",
        ),
    ],
)
def test_bad_input_is_a_sentence_and_writes_nothing(tmp_path, monkeypatch, options, words):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(LinkproofError) as error:
        swept(Path("new/t.csv"), **options)
    assert words in str(error.value)
    assert not list(tmp_path.rglob("*.*"))
