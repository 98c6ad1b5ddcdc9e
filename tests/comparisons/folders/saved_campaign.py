"""A folder as compare writes it, of an engine that makes no error, and the same with something in it changed."""

import json
import shutil

import pytest
import xarray

from analytic.description.crank_motion import crank_motion
from analytic.kinematics.mechanism import Mechanism
from comparisons.campaign import campaign
from comparisons.campaign.campaign import CampaignRequest
from comparisons.campaign.results import document, save
from comparisons.campaign.standards import judged_campaign
from comparisons.datasheet.building import bare_sheet
from comparisons.judging.limits import shipped_limits
from comparisons.judging.records import to_json
from comparisons.judging.verdicts import Standard
from engines.contract import Outcome, Run
from tests.comparisons.perfect_engine import perfect_motion

MOTION = crank_motion("run-up", start_angle=0.3)


def save_campaign(folder, linkage, motion=MOTION, limits=None):
    """Save the campaign of a linkage in a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    request = CampaignRequest((linkage,), (motion,), "as tested", ("direct",))
    run = Run(Outcome.FINISHED, history=perfect_motion(Mechanism(linkage), motion, 701).history)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(campaign, "run_engine", lambda *_: run)
        results = list(campaign.compare(request))
    judged = judged_campaign(request, results, Standard(limits or shipped_limits()))
    told = {**document(request, judged.results, "linkproof compare"), **judged.told}
    save(folder, judged.results, told, [bare_sheet(linkage, "")])
    return folder


def changed(folder, into, edit):
    """A copy of a folder whose document and curves ``edit`` has changed, in both of its files."""
    shutil.copytree(folder, into)
    with xarray.open_dataset(folder / "curves.nc", engine="scipy", mmap=False) as opened:
        curves = opened.load()
    told = json.loads(curves.attrs["document"])
    edit(told, curves)
    curves.attrs["document"] = to_json(told)
    curves.to_netcdf(into / "curves.nc", engine="scipy", format="NETCDF3_64BIT")
    (into / "records.json").write_text(to_json(told), encoding="utf-8")
    return into


def row(told, quantity):
    """The record of a quantity, as its row."""
    return next(row for row in told["records"] if row["quantity"] == quantity)
