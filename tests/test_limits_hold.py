"""Every mechanism of the catalogue in every engine, each quantity and invariant within its limit and its baseline."""

import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import catalogue, load
from analytic.kinematics.mechanism import Mechanism
from comparisons.campaign.campaign import CampaignRequest, cases, compare
from comparisons.judging import baseline
from comparisons.judging.quantities import all_quantities
from comparisons.judging.records import blank_record
from comparisons.reference.case import Case
from comparisons.stress.verdict import SAID as INVARIANTS
from engines.contract import Setting
from engines.registry import engine, engine_names
from reports.command_line.requests import CampaignChoice

CHECKED = [("run-up", Setting.TUNED), ("run-up-quintic", Setting.TUNED), ("run-up-quintic", Setting.BEST)]


def _request(mechanism: str, engine_name: str, regime: str, setting: Setting) -> CampaignRequest:
    conditions = CampaignChoice().conditions
    return CampaignRequest((load(mechanism),), (crank_motion(regime),), conditions, (engine_name,), (setting,))


@pytest.mark.parametrize("mechanism", catalogue())
@pytest.mark.parametrize(("regime", "setting"), CHECKED)
@pytest.mark.parametrize("engine_name", engine_names())
def test_every_deviation_is_within_its_limit(mechanism, engine_name, regime, setting):
    if engine(engine_name).version() is None:
        pytest.skip(f"{engine_name} is not installed: pip install 'linkproof[{engine_name}]'")
    if setting not in engine(engine_name).abilities.settings:
        pytest.skip(f"{engine_name} has no setting {setting}")
    (result,) = compare(_request(mechanism, engine_name, regime, setting))
    records = (*result.records, *result.invariants)
    case = Case(Mechanism(load(mechanism)), crank_motion(regime))
    assert {record.quantity for record in records} == {*all_quantities(case), *INVARIANTS}
    bad = [r for r in records if r.outcome != "passed" and (r.outcome, r.quantity) != ("not-provided", "force_balance")]
    assert not [f"{r.quantity}: {r.outcome}, {r.detail}" for r in bad]


def test_the_baseline_covers_what_is_checked():
    missing = [
        key
        for mechanism in catalogue()
        for name in engine_names()
        for regime, setting in CHECKED
        if engine(name).version() is not None and setting in engine(name).abilities.settings
        for case in cases(_request(mechanism, name, regime, setting))
        if (key := baseline.key(blank_record(case, setting, name))) not in baseline.recorded()
    ]
    assert not missing, "run `make baseline` and look at what it changes"
