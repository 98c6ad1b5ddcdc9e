"""Names of figures for a reader."""

import pytest

from reports.document.templates import worded


@pytest.mark.parametrize(
    ("quantity", "words"),
    [
        ("Jeq.mean", "Jeq, mean"),
        ("Jeq:needle_bar.mean", "Jeq of needle bar, mean"),
        ("start_acceleration:driven", "start acceleration of driven"),
        ("Mkr@0", "Mkr at 0°"),
        ("point:F:vx@-5deg", "vx of point F at -5°"),
        ("point:F:x.range", "x of point F, range"),
        ("joint_force:E:K3:x@0.5rad", "x of joint force E:K3 at 0.5 rad"),
        ("link:K2:angle - phi@0.03s:squeezing", "angle of link K2 − phi at 0.03 s of squeezing"),
    ],
)
def test_a_figure_is_worded_for_a_reader(quantity, words):
    assert worded(quantity) == words
