"""Every mechanism of the catalogue in every engine, each quantity and invariant within its limit and its baseline."""

from pathlib import Path

import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import catalogue, load, read
from analytic.kinematics.mechanism import Mechanism
from comparisons.campaign.campaign import CampaignRequest, cases, compare
from comparisons.campaign.key_figures import changes
from comparisons.campaign.standard import places
from comparisons.judging.baseline import read_baseline, regime_key
from comparisons.judging.limits import Standard, shipped_limits
from comparisons.judging.quantities import all_quantities
from comparisons.reference.case import Case
from comparisons.stress.verdict import ALARMS as INVARIANTS
from engines.contract import Setting
from engines.registry import engine, engine_names
from reports.requests.campaign_options import CompareOptions

FILE = Path(__file__).with_name("baseline.json")
BASELINE = read_baseline(FILE, places(map(read, catalogue()), FILE.parent))
CHECKED = [("run-up-quintic", Setting.TUNED), ("run-up", Setting.TUNED), ("run-up-quintic", Setting.BEST)]
USUAL, *OTHERS = CHECKED


def _request(mechanism: str, engine_name: str, regime: str, setting: Setting) -> CampaignRequest:
    conditions = CompareOptions().conditions
    return CampaignRequest((load(mechanism),), (crank_motion(regime),), conditions, (engine_name,), (setting,))


@pytest.mark.parametrize("mechanism", catalogue())
@pytest.mark.parametrize(
    ("regime", "setting"), [USUAL, *(pytest.param(*other, marks=pytest.mark.nightly) for other in OTHERS)]
)
@pytest.mark.parametrize("engine_name", engine_names())
def test_every_deviation_is_within_its_limit(mechanism, engine_name, regime, setting):
    if engine(engine_name).version() is None:
        pytest.skip(f"{engine_name} is not installed: pip install 'linkproof[{engine_name}]'")
    if setting not in engine(engine_name).abilities.settings:
        pytest.skip(f"{engine_name} has no setting {setting}")
    (found,) = compare(_request(mechanism, engine_name, regime, setting))
    records = found.judged(Standard(shipped_limits(), BASELINE).judge).every
    case = Case(Mechanism(load(mechanism)), crank_motion(regime))
    assert {record.quantity for record in records} == {*all_quantities(case), *INVARIANTS}
    bad = [r for r in records if r.outcome != "passed" and (r.outcome, r.quantity) != ("not-provided", "force_balance")]
    assert not [f"{r.quantity}: {r.outcome}, {r.detail}" for r in bad]


def test_the_baseline_covers_what_is_checked():
    missing = [
        (mechanism, regime, name, setting)
        for mechanism in catalogue()
        for name in engine_names()
        for regime, setting in CHECKED
        if engine(name).version() is not None and setting in engine(name).abilities.settings
        for case in cases(_request(mechanism, name, regime, setting))
        if f"{name} {setting}" not in _entry(case)["errors"]
    ]
    assert not missing, "run `make baseline` and look at what it changes"


def _entry(case: Case):
    linkage, key = case.mechanism.linkage, regime_key(case.motion.regime, case.conditions)
    return BASELINE.linkages[linkage.name]["variants"][linkage.variant][key]


def test_the_key_figures_are_those_recorded():
    every = [case for name in catalogue() for regime in ("run-up", "run-up-quintic")
             for case in cases(_request(name, "direct", regime, Setting.TUNED))]  # fmt: skip
    assert all(_entry(case)["figures"] for case in every)
    assert [change.sentence for change in changes(every, BASELINE)] == []
    assert BASELINE.changed() == ()
    assert {*BASELINE.linkages} == {*catalogue()}
