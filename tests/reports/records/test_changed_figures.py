"""Key figures that changed stand in a table, the others do not."""

from comparisons.campaign.key_figures import KeyFigure
from reports.document.numbers import ABSENT
from reports.records.changed_figures import changed_figures

PLACE = ("m", "v", "run-up", "c")


def test_only_what_changed_has_a_row():
    same = KeyFigure(*PLACE, "Mkr.peak", 1.0, 1.0, changed=False)
    assert changed_figures([same]) == ()
    moved = KeyFigure(*PLACE, "Jeq.mean", 2.0, 2.02, changed=True, unit="kg m²")
    lost = KeyFigure(*PLACE, "Peq.peak", 3.0, None, changed=True)
    (table,) = changed_figures([same, moved, lost])
    assert table.rows == (
        ("m (v)", "run-up", "Jeq.mean", "2", "2.02", "kg m²", "+1 %"),
        ("m (v)", "run-up", "Peq.peak", "3", ABSENT, "", ABSENT),
    )
