"""A folder as compare writes it, of an engine that makes no error, and the same with something in it changed."""

import json

import pytest

from analytic.description.crank_motion import crank_motion
from analytic.kinematics.mechanism import Mechanism
from comparisons.campaign import campaign
from comparisons.campaign.campaign import CampaignRequest
from comparisons.campaign.project import judged_campaign
from comparisons.campaign.results import document, load, save
from comparisons.datasheet.building import bare_sheet
from comparisons.judging.limits import Standard, shipped_limits
from comparisons.judging.records import RunRecord
from engines.contract import Outcome, Run
from tests.comparisons.true_motions import perfect_motion

MOTION = crank_motion("run-up", start_angle=0.3)


def save_campaign(folder, linkage, motion=MOTION, limits=None):
    """Save the campaign of a linkage in a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    request = CampaignRequest((linkage,), (motion,), "as tested", ("direct",))
    run = Run(Outcome.FINISHED, history=perfect_motion(Mechanism(linkage), motion, 701).history)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(campaign, "run_engine", lambda *_: run)
        runs = list(campaign.compare(request))
    judged = judged_campaign(request, runs, Standard(limits or shipped_limits()))
    save(folder, {**document(request, "linkproof compare"), **judged.as_dict}, judged.runs, [bare_sheet(linkage, "")])
    return folder


def changed(folder, into, edit):
    """A copy of a folder, as if it had been written so, whose document and run ``edit`` has changed.

    The run has its errors by quantity in ``errors`` and its curves in ``curves``.
    """
    results = load(folder)
    (run,) = results.runs
    told = json.loads(json.dumps(results.document))
    made = {
        **run.data,
        "errors": [dict(one) for one in run.data["errors"]],
        "curves": {n: c.copy() for n, c in run.curves.items()},
    }
    edit(told, made)
    into.mkdir()
    save(into, told, [RunRecord.from_row(made, made["curves"])], results.sheets)
    return into


def row(run, quantity):
    """The error of a quantity in a run, as its row."""
    return next(row for row in run["errors"] if row["quantity"] == quantity)
