"""Every mechanism of the catalogue in every engine, each quantity and invariant within its limit and its baseline."""

from functools import cache

import pytest

from analytic.loading import catalogue, load
from analytic.regimes import crank_motion
from comparisons import baseline
from comparisons.campaign import Request, RunResult, compare
from comparisons.invariants import INVARIANTS
from comparisons.quantities import QUANTITIES
from engines.contract import Setting
from engines.registry import engine, engine_names
from reports.requests import Choice

CHECKED = [("run-up", Setting.TUNED), ("run-up-quintic", Setting.TUNED), ("run-up-quintic", Setting.BEST)]


@cache
def _result(mechanism: str, engine_name: str, regime: str, setting: Setting) -> RunResult:
    linkage = load(mechanism)
    quantities = tuple(n for n in QUANTITIES if linkage.output is not None or not QUANTITIES[n].needs_output)
    request = Request(
        (linkage,), (crank_motion(regime),), Choice().conditions, (engine_name,), (setting,), quantities
    )
    (result,) = compare(request)
    return result


@pytest.mark.parametrize("quantity", [*QUANTITIES, *INVARIANTS])
@pytest.mark.parametrize(("regime", "setting"), CHECKED)
@pytest.mark.parametrize("engine_name", engine_names())
@pytest.mark.parametrize("mechanism", catalogue())
def test_deviation_is_within_its_limit(mechanism, engine_name, regime, setting, quantity):
    if engine(engine_name).version() is None:
        pytest.skip(f"{engine_name} is not installed: pip install 'linkproof[{engine_name}]'")
    if quantity in QUANTITIES and QUANTITIES[quantity].needs_output and load(mechanism).output is None:
        pytest.skip(f"{mechanism} names no output")
    result = _result(mechanism, engine_name, regime, setting)
    (record,) = (r for r in (*result.records, *result.invariants) if r.quantity == quantity)
    assert record.outcome == "passed", record.detail


def test_the_baseline_covers_what_is_checked():
    missing = [
        (mechanism, name, regime, setting)
        for mechanism in catalogue()
        for name in engine_names()
        for regime, setting in CHECKED
        if engine(name).version() is not None
        and baseline.key(_result(mechanism, name, regime, setting).records[0]) not in baseline.recorded()
    ]
    assert not missing, "run `make baseline` and look at what it changes"
