"""The verdict names the engines to trust for each quantity; naive settings do not change it."""

import numpy as np
import pytest

from comparisons.trials.campaign.results import CampaignResults
from comparisons.trials.judging.records import CONTROL, Verdict
from reports.campaign.index import EngineRanking, verdict
from tests.made_up import changed_results, made_up_results

QUANTITIES = ("Jeq", "Mkr", "S")


def made_up(**changes):
    return made_up_results(samples=51, quantities=QUANTITIES, **changes)


@pytest.fixture(scope="module")
def results():
    return made_up()


def test_who_is_within_every_limit_is_trusted_in_everything(results):
    trusted, untuned = verdict(EngineRanking(results))
    count = sum(record.setting == "tuned" for record in (*results.records, *results.invariants))
    assert trusted == f"alpha and beta, once tuned, pass every comparison of all {count}."
    assert "quick" not in " ".join(verdict(EngineRanking(results)))  # one run each: no noise is known
    assert untuned.startswith("With default settings no engine stays within limits; alpha is off by up to ")


def test_what_the_defaults_do_never_decides(results):
    better = changed_results(
        results, lambda r: r._replace(outcome="passed", error_max=1e-9) if r.setting == "naive" else r
    )
    assert verdict(EngineRanking(better))[0] == verdict(EngineRanking(results))[0]
    assert verdict(EngineRanking(better))[1] == "With default settings alpha and beta stay within limits."


def test_an_error_over_its_limit_costs_its_own_family_alone(results):
    def worse(record):
        is_it = (record.engine, record.setting, record.quantity) == ("beta", "tuned", "Mkr")
        return record._replace(outcome=Verdict.OVER_LIMIT.value) if is_it else record

    trust = EngineRanking(changed_results(results, worse))
    first = verdict(trust)[0]
    assert first.startswith("alpha, once tuned, passes every comparison. ")
    assert "Do not trust beta for Mkr: an error is over its limit" in first
    assert trust.most_accurate("tuned", "Mkr") == "alpha"


def test_the_time_of_an_engine_is_the_shifted_geometric_mean_of_its_runs(results):
    times = [run.setup_seconds + run.seconds for run in results.runs if (run.engine, run.setting) == ("beta", "tuned")]
    shifted = np.exp(np.mean(np.log(np.array(times) + 0.01))) - 0.01
    assert EngineRanking(results).seconds("beta", "tuned") == pytest.approx(shifted)


def test_the_control_is_shown_last_and_never_named(results):
    trust = EngineRanking(changed_results(results, lambda r: r._replace(origin=CONTROL) if r.engine == "alpha" else r))
    assert trust.engines == ("beta", "alpha")
    assert "alpha" not in " ".join(verdict(trust))


def test_nobody_is_trusted_where_something_is_not_as_it_was_recorded(results):
    kinds, place = ("changed", "vanished", "appeared"), ["some"] * 7
    changes = [{"place": place, "before": 1.0, "after": 1.5, "kind": kind} for kind in kinds]
    told = {**results.document, "changes": changes}
    first, second, *rest = verdict(EngineRanking(CampaignResults(told, results.runs)))
    assert first == "2 results are not as recorded before."
    assert second == "alpha and beta, once tuned, pass every comparison."
    assert not any(" of all " in line for line in rest)


@pytest.mark.parametrize("outcome", ["diverged", "suite-error"])
def test_nobody_is_trusted_where_another_setting_failed(results, outcome):
    """What decides the exit code decides here, though the table is that of tuned runs."""

    def worse(record):
        return record._replace(setting="best", outcome=outcome) if record.setting == "naive" else record

    assert not any(" of all " in line for line in verdict(EngineRanking(changed_results(results, worse))))
