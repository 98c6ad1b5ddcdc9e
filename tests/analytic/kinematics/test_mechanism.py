"""Assembly modes are taken from the sketch, and links that do not meet, or cannot move, say where and by how much."""

from pathlib import Path

import numpy as np
import pytest

from analytic.errors import AssemblyError, LinkproofError, StructureError
from tests.analytic.linkages import angles, from_text, mechanism, path_of, text_of


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


SHORT_ROD = (
    r"'sample' cannot be assembled at 180°: 'coupler' \(47 mm\) and 'rocker' \(25 mm\) together are 3 mm shorter than "
    r"the gap of 75 mm between 'A' and 'O2'; lengthen one of them, shorten the crank or move the pivots closer together"
)
LONG_ROD = (
    r"'sample' cannot be assembled at 0°: 'coupler' \(90 mm\) and 'rocker' \(40 mm\) differ by 10 mm more than the gap "
    r"of 40 mm between 'A' and 'O2'; shorten 'coupler', lengthen 'rocker' or move the pivots apart"
)
FAR_GUIDE = (
    r"'sample' cannot be assembled at [\d.]+°: 'rod' \(20 mm\) is [\d.]+ mm too short to reach the guide of "
    r"'piston', [\d.]+ mm away from 'A'; lengthen it or move the guide closer"
)
OFFSET = (
    r"the slide between 'A in rocker' and 'rocker' is offset by [\d.]+ mm, [\d.]+ mm more than the distance "
    r"between 'A' and 'O2'; lessen the offset or move the pivot away"
)
PARALLEL = r"'sample' is undetermined at [\d.]+°: the guides of 'A in yoke' and 'yoke' are parallel"


def _four_bar(frame, crank, coupler, rocker):
    text = text_of("parallelogram").replace('"parallelogram"', '"sample"')
    text = text.replace("O2 = [60, 0]\n", f"O2 = [{frame}, 0]\n").replace("A = [25, 0]", f"A = [{crank}, 0]")
    return text.replace("B = [60, 0]", f"B = [{coupler}, 0]").replace("B = [25, 0]", f"B = [{rocker}, 0]")


# Centric: the rod of 0.04 m has to reach across the crank's 0.05 m.
CENTRIC = text_of("centric-slider-crank").replace("D = [0.2, 0] }", "D = [0.04, 0] }").replace("0.25", "0.09")
CASES = {
    "short rod": (_four_bar(50, 25, 47, 25), SHORT_ROD),
    "long rod": (_four_bar(60, 20, 90, 40), LONG_ROD),
    "far guide": (text_of("force-over-angle").replace("D = [-70, 12]", "D = [-20, 0]"), FAR_GUIDE),
    "the missing length": (CENTRIC, r"at (90|270)°: 'rod' \(0.04 m\) is 0.01 m too short .* 0.05 m away from 'A'"),
    "offset": (text_of("slot-without-mass").replace("through = [6, 4]", "through = [6, 40]"), OFFSET),
    "parallel guides": (text_of("scotch-yoke").replace("along = [0, 1]", "along = [1, 0]"), PARALLEL),
    "the sketch itself": (_four_bar(60, 25, 30, 25), r"'sample' cannot be assembled at 90°: "),
}


@pytest.mark.parametrize("case", CASES)
def test_a_linkage_that_cannot_be_assembled_says_where_and_why(case):
    text, message = CASES[case]
    with pytest.raises(AssemblyError, match=message):
        from_text(text).check_full_turn()


def test_coinciding_pins_leave_a_position_undetermined():
    slotted = from_text(text_of("shaper").replace("O2 = [0, -50]", "O2 = [0, -22]"))
    message = r"is undetermined at 270°: 'A' and 'O2' coincide, so the direction of the slide .* undefined"
    with pytest.raises(AssemblyError, match=message):
        slotted.sweep(np.radians(270.0) + np.array([0.1, 0.0])).poses("rocker")


def test_a_crank_angle_that_is_not_finite_is_refused():
    with pytest.raises(LinkproofError, match="crank angle: expected finite numbers, got nan or infinity"):
        mechanism("juki-mf7923d").sweep(np.array([0.0, np.nan])).poses("coupler")
