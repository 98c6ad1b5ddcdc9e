"""Names of figures for a reader."""

import pytest

from reports.document.templates import worded


@pytest.mark.parametrize(
    ("quantity", "words"),
    [
        ("Jeq.mean", "Jeq, mean"),
        ("Jeq:needle_bar.mean", "Jeq of needle bar, mean"),
        ("epsilon@0s", "epsilon at 0 s"),
        ("Jeq:needle_bar.mean - rimoldi-164", "Jeq of needle bar, mean − rimoldi-164"),
        ("Mkr@0", "Mkr at 0°"),
        ("point:F:vx@-5deg", "vx of point F at -5°"),
        ("point:F:x.range", "x of point F, range"),
        ("joint_force:E:K3:x@0.5rad", "x of joint force E:K3 at 0.5 rad"),
        ("link:K2:angle@0.03s - phi", "angle of link K2 at 0.03 s − phi"),
    ],
)
def test_a_figure_is_worded_for_a_reader(quantity, words):
    assert worded(quantity) == words
