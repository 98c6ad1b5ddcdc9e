"""Every mechanism of the catalogue in every engine, each quantity and invariant within its limit and as recorded."""

from pathlib import Path

import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import catalogue, load
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Case
from comparisons.trials.campaign.campaign import CampaignRequest, compare
from comparisons.trials.campaign.standard import changes_since, closed_form
from comparisons.trials.invariants.checks import INVARIANTS
from comparisons.trials.judging.changes import CLOSED_FORM, changes, read_rows
from comparisons.trials.judging.quantities import all_quantities
from engines.contract import Setting
from engines.registry import own_names
from reports.api.options import Motion
from tests.engines.closed_form import installed

BASELINE = read_rows(Path(__file__).with_name("baseline.csv"))
RECORDED = {row[:6] for row in BASELINE}
REGIMES = ("run-up-quintic", "run-up")
CHECKED = [("run-up-quintic", Setting.TUNED), ("run-up", Setting.TUNED), ("run-up-quintic", Setting.BEST)]
ORDINARY = "slotted-takeup"  # has every joint, a damper and a thread
CASES = [
    pytest.param(mechanism, *how, marks=() if mechanism == ORDINARY and how is CHECKED[0] else pytest.mark.nightly)
    for mechanism in catalogue()
    for how in CHECKED
]


@pytest.mark.parametrize(("mechanism", "regime", "setting"), CASES)
@pytest.mark.parametrize("engine_name", own_names())
def test_every_deviation_is_within_its_limit_and_as_recorded(mechanism, engine_name, regime, setting):
    if setting not in installed(engine_name).abilities.settings:
        pytest.skip(f"{engine_name} has no setting {setting}")
    motion, conditions = crank_motion(regime), Motion().conditions
    (found,) = compare(CampaignRequest((load(mechanism),), (motion,), conditions, (engine_name,), (setting,)))
    records, case = found.every, Case(Mechanism(load(mechanism)), motion)
    assert {record.quantity for record in records} == {*all_quantities(case), *INVARIANTS}
    of_forces = {name for name, invariant in INVARIANTS.items() if invariant.of_forces}
    bad = [
        r for r in records if r.outcome != "passed" and not (r.outcome == "not-provided" and r.quantity in of_forces)
    ]
    assert not [f"{r.quantity}: {r.outcome}, {r.detail}" for r in bad]
    assert records[0][:6] in RECORDED, "run `make baseline` and look at what it changes"
    before = [row for row in BASELINE if row[:6] == records[0][:6]]
    assert [change.sentence for change in changes(before, records)] == []


def test_the_figures_of_the_closed_form_are_those_recorded():
    linkages, motions = tuple(map(load, catalogue())), tuple(map(crank_motion, REGIMES))
    request = CampaignRequest(linkages, motions, Motion().conditions, ())
    figures = closed_form(request, every_variant=True)
    assert [change.sentence for change in changes_since(BASELINE, figures, request, every_variant=True)] == []
    assert {row[:7] for row in figures} == {row[:7] for row in BASELINE if row.engine == CLOSED_FORM}
