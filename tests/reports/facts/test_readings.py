"""Published figures stand beside every variant, whatever variant ran."""

from reports.facts.readings import met, readings
from tests.reports.made_up_results import made_up_results


def test_every_variant_has_a_column():
    found = readings(made_up_results(samples=21))["juki-mf7923d"]
    assert found.variants == ("as-built", "as-printed")
    mean = next(row for row in found.rows if row.quantity == "Jeq.mean")
    assert [one.verdict for one in mean.ours] == ["within 6 %", "reproduced"]
    assert {total for _, _, _, total in met(found)} == {len(found.rows)}
