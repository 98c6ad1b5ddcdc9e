"""Assembly modes are taken from the sketch."""

from pathlib import Path

import numpy as np
import pytest

from analytic.errors import StructureError
from tests.analytic.drives import path_of
from tests.analytic.linkages import angles, from_text, mechanism, text_of


@pytest.mark.parametrize(("sketch", "height"), [("[64, 30]", 1.0), ("[64, -30]", -1.0)])
def test_the_sketch_chooses_the_mode(sketch, height):
    text = text_of("near-toggle").replace("B = [55, 30]", f"B = {sketch}")
    assert np.sign(from_text(text).sweep(np.pi / 2).point("B")[1]) == height


def test_a_rough_sketch_is_enough():
    rough = text_of("carried-slider").replace("B = [55, 45], D = [45, 33]", "B = [40, 60], D = [60, 45]")
    one, two = (sample.sweep(angles(5)).output() for sample in (from_text(rough), mechanism("carried-slider")))
    assert np.array_equal(one, two)


@pytest.mark.parametrize("sketch", ["[sketch]\nangle  = 40\npoints = { D = [45, 33] }", ""])
def test_a_sketch_that_leaves_a_mode_open(sketch):
    text = text_of("carried-slider").split("[sketch]")[0] + sketch
    angle = 40 if sketch else 0
    message = (
        rf"sketch of 'sample': expected the rough position of 'B' at crank angle {angle}°, got a sketch that leaves "
        r"open how 'coupler' and 'rocker' are assembled; add it under \[sketch.points\]"
    )
    with pytest.raises(StructureError, match=message):
        from_text(text)


def test_the_sketch_of_a_drive_along_a_line_is_at_a_length():
    text = Path(path_of("linear-motor")).read_text(encoding="utf-8").split("[sketch]")[0]
    with pytest.raises(StructureError, match=r"of 'B' or 'D' at a slider at 0 mm, got a sketch that leaves open"):
        from_text(text)


def test_modes_that_no_named_point_tells_apart():
    text = text_of("shaper").replace(", E = [140, 0]", "").replace("E = [0, 90]", "A = [0, 22]")
    message = (
        r"expected a point that tells them apart .* name a further point on one of them, and place it in \[sketch\]"
    )
    with pytest.raises(StructureError, match=message):
        from_text(text)
