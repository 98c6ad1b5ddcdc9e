"""A sweep in words: how many designs assemble, and where."""

import numpy as np

from comparisons.designs.sweep import sweep
from reports.designs.sweep_terminal import document, parts, sentence
from reports.document.terminal import rendered
from tests.comparisons.designs.sweeps import grid, request


def summed_up(*texts):
    return sweep(request(grid(*texts), figures=("stroke",)))


def test_designs_that_do_not_assemble_are_counted_and_never_rounded_away():
    assert sentence(summed_up("rod.B.x=175:175:1")) == "1 design, which assembles at every angle"
    assert sentence(summed_up("rod.B.x=175:176:2")) == "2 designs, all of which assemble at every angle"
    told = sentence(summed_up("rod.B.x=160:180:2001"))
    assert told.startswith("2 001 designs, of which ")
    assert "(100 %)" not in told
    assert told.endswith("to 180 mm")


def test_the_table_and_the_document_have_the_same_figures():
    found = summed_up("rod.B.x=170:180:3", "rod.mass=1:2:2")
    lines = rendered(*parts(found)).splitlines()
    stroke = document(found)["figures"]["stroke"]
    for line, what in zip(lines[4:7], ("least", "own", "largest"), strict=True):
        value, x, mass = map(float, line.split()[-3:])
        assert [x, mass] == [*stroke[what]["at"].values()]
        np.testing.assert_allclose(value, stroke[what]["value"], rtol=1e-5)
    assert stroke["own"]["at"] == {"rod.B.x": 175.0, "rod.mass": 0.17}
    assert document(found)["parameters"]["rod.B.x"] == {
        "units": "mm", "least": 170.0, "largest": 180.0, "assembles": [170.0, 180.0]
    }  # fmt: skip
