"""Joint forces of a regime as rows."""

from dataclasses import asdict, replace

from comparisons.campaign.results import Results
from reports.records.joint_rows import joint_table
from reports.records.views import views
from tests.reports.made_up_results import made_up_results


def test_joints_come_by_their_peaks_and_round_off_has_no_digits():
    made = made_up_results(samples=21, quantities=("Jeq", "Mkr"))
    names = {"Jeq": "joint_force:P1", "Mkr": "joint_force:slot_slider on rocker"}
    records = [replace(record, quantity=names[record.quantity], unit="N") for record in made.records]
    records = [r if r.quantity.endswith("P1") or not r.error_max else replace(r, error_max=1e-16) for r in records]
    (view,) = views(Results({**made.document, "records": [asdict(record) for record in records]}, made.curves))
    table = joint_table(view, view.regimes[0])
    assert table.head[:3] == ("joint", "peak, N", "alpha naive")
    assert [row[0] for row in table.rows] == ["slot slider on rocker", "P1"]
    assert set(table.rows[0][2:]) == {"< 1e-13"}


def test_no_rows_without_joint_forces():
    (bare,) = views(made_up_results(samples=21, quantities=("Jeq",)))
    assert joint_table(bare, bare.regimes[0]) is None
