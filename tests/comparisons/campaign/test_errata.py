"""Printed models put to an engine: the corrected closed form is supported, the printed one refuted, by how much."""

import pytest

from analytic.description.loading import load
from comparisons.campaign import campaign, errata
from comparisons.campaign.campaign import CampaignRequest, compare
from comparisons.campaign.errata import judge_errata
from comparisons.runs.journal import Journal


@pytest.fixture(scope="module")
def records():
    linkages = [load("slotted-takeup"), load("two-crank-takeup")]
    return {(r.mechanism, r.erratum): r for r in judge_errata(linkages, ["direct"])}


def test_every_erratum_is_judged_and_refuted(records):
    assert len(records) == 4
    assert {r.supports for r in records.values()} == {"corrected"}
    assert all(r.deviation_corrected < 1e-10 for r in records.values())


def test_the_moduli_settle_where_the_article_says_and_the_true_crank_does_not(records):
    record = records["slotted-takeup", "k2 from moduli"]
    assert 22.0 < record.mean_speed_printed < 26.0
    assert record.mean_speed == pytest.approx(record.mean_speed_corrected, rel=1e-6)
    # The crank still spins up in the last two seconds of ten: 0.93 % short of M1/b = 125 rad/s.
    assert record.mean_speed_corrected == pytest.approx(0.9907 * 125.0, rel=1e-4)
    assert record.deviation_printed > 0.5


def test_the_published_integrator_loses_a_fifth_of_the_speed(records):
    record = records["slotted-takeup", "1000 fixed Runge-Kutta steps"]
    assert record.deviation_printed > 0.1
    assert record.mean_speed_printed < 0.9 * record.mean_speed_corrected


def test_sentences_name_engine_model_and_numbers(records):
    sentence = records["slotted-takeup", "k2 from moduli"].sentence
    for words in ("article 000", "direct supports the corrected model", "printed 24."):
        assert words in sentence


def test_a_run_that_a_campaign_has_made_serves_again(tmp_path, monkeypatch, records):
    linkage, journal = load("two-crank-takeup"), Journal(tmp_path, "a request")
    compare(CampaignRequest((linkage,), (), "", ("direct",), own_regimes=("driven",)), journal=journal).make()
    monkeypatch.setattr(campaign, "run_engine", None)
    again = list(judge_errata([linkage], ["direct"], journal=journal))
    assert again == [record for (name, _), record in records.items() if name == linkage.name]


def test_other_variants_are_not_judged():
    assert list(judge_errata([load("two-crank-takeup", "W+1")], ["direct"])) == []


@pytest.mark.parametrize(
    ("corrected", "printed", "verdict"), [(1e-9, 0.5, "corrected"), (0.5, 1e-9, "as-printed"), (0.1, 0.2, "neither")]
)
def test_support_needs_a_clear_margin(corrected, printed, verdict):
    assert errata._supported(corrected, printed) == verdict


def test_an_engine_that_raises_gives_no_motion_and_ends_nothing(monkeypatch):
    class Failing:
        name = "failing"

        def version(self):
            return "1"

        def run(self, scene, setting):
            raise RuntimeError("out of memory")

    monkeypatch.setattr(campaign, "engine", lambda name: Failing())
    records = list(judge_errata([load("two-crank-takeup")], ["failing"]))
    assert {(r.outcome, r.supports) for r in records} == {("adapter-error", "neither")}
    assert "failing gave no motion, adapter-error: the adapter of failing raised RuntimeError" in records[0].sentence
