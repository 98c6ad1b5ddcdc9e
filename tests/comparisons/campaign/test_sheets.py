"""The data sheets of a campaign's linkages: one a linkage, in order; a sheet that fails has the reason."""

from analytic.description.crank_motion import RPM, crank_motion
from analytic.description.loading import load
from comparisons.campaign import campaign as module
from comparisons.campaign.campaign import CampaignRequest, sheets
from comparisons.datasheet.building import usual_sheet

NAMES = ("slotted-takeup", "juki-mf7923d")
LINKAGES = tuple(load(name) for name in NAMES)
REQUEST = CampaignRequest(
    LINKAGES, (crank_motion("run-up", speed=500 * RPM),), "as tested", ("direct",), own_regimes=("free",)
)


def test_every_linkage_has_a_sheet_of_the_campaigns_motions():
    found = sheets(REQUEST, processes=2)
    assert [sheet.name for sheet in found] == list(NAMES)
    assert all("500 rpm" in sheet.conditions for sheet in found)
    assert [list(sheet.released) for sheet in found] == [["free"], []]


def test_a_sheet_that_fails_costs_no_other(monkeypatch):
    def broken(linkage, *rest):
        if linkage.name == "juki-mf7923d":
            raise ZeroDivisionError("a fault of the suite")
        return usual_sheet(linkage, *rest)

    monkeypatch.setattr(module, "usual_sheet", broken)
    whole, lost = sheets(REQUEST, processes=0)
    assert "a fault of the suite" in lost.missing["values"]
    assert (lost.name, lost.linkage) == ("juki-mf7923d", LINKAGES[1])
    assert whole.values
