"""The data sheets of a campaign's linkages: all of them, in order, and of a lost one the reason."""

from analytic.description.crank_motion import RPM, crank_motion
from analytic.description.loading import load
from comparisons.campaign import sheets as module
from comparisons.campaign.campaign import CampaignRequest
from comparisons.campaign.sheets import sheets
from comparisons.datasheet.building import usual_sheet

NAMES = ("slotted-takeup", "juki-mf7923d", "fork-takeup")


def asked(*own_regimes):
    motions = (crank_motion("run-up", speed=500 * RPM),)
    linkages = tuple(load(name) for name in NAMES)
    return CampaignRequest(linkages, motions, "as tested", ("direct",), own_regimes=own_regimes)


def test_every_linkage_has_a_sheet_of_what_the_campaign_ran():
    found = sheets(asked("free"), processes=2)
    assert [sheet.name for sheet in found] == list(NAMES)
    assert all("500 rpm" in sheet.conditions for sheet in found)
    assert [list(sheet.released) for sheet in found] == [["free"], [], []]


def test_a_sheet_that_is_lost_costs_no_other(monkeypatch):
    def broken(linkage, *rest):
        if linkage.name == "juki-mf7923d":
            raise ZeroDivisionError("a fault of the suite")
        return usual_sheet(linkage, *rest)

    monkeypatch.setattr(module, "usual_sheet", broken)
    first, lost, last = sheets(asked(), processes=0)
    assert "a fault of the suite" in lost.missing["values"]
    assert (lost.name, lost.linkage) == ("juki-mf7923d", load("juki-mf7923d"))
    assert first.values
    assert last.values
