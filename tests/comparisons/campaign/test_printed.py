"""Printed figures and models, and the linkages of the literature, against engines."""

import numpy as np
import pytest

from analytic.description.loading import literature, load
from comparisons.campaign import campaign
from comparisons.campaign.campaign import CampaignRequest, compare
from comparisons.campaign.errata import judge_errata
from comparisons.campaign.printed_answers import engine_answers
from comparisons.datasheet.published import all_variants, compare_published
from comparisons.judging.records import Verdict
from comparisons.runs.study import Journal
from comparisons.runs.workers import LocalPool
from reports.document.terminal import rendered
from reports.mechanism import terminal
from reports.requests.campaign import request
from reports.requests.campaign_options import CompareOptions
from tests.analytic.linkages import FOLDER
from tests.comparisons.faults import announce


@pytest.fixture(scope="module")
def records():
    return {r.erratum: r for r in judge_errata([load("slotted-takeup")], ["direct"])}


@pytest.mark.nightly
def test_every_erratum_is_judged_and_refuted(records):
    others = judge_errata([load("two-crank-takeup")], ["direct"])
    found = [*records.values(), *others]
    assert len(found) == 4
    assert {r.supports for r in found} == {"corrected"}
    assert all(r.deviation_corrected < 1e-10 for r in found)


@pytest.mark.nightly
def test_the_moduli_settle_where_the_article_says_and_the_true_crank_does_not(records):
    record = records["k2 from moduli"]
    assert 22.0 < record.mean_speed_printed < 26.0
    assert record.mean_speed == pytest.approx(record.mean_speed_corrected, rel=1e-6)
    # The crank still spins up in the last two seconds of ten: 0.93 % short of M1/b = 125 rad/s.
    assert record.mean_speed_corrected == pytest.approx(0.9907 * 125.0, rel=1e-4)
    assert record.deviation_printed > 0.5
    for words in ("article 000", "direct supports the corrected model", "printed 24."):
        assert words in record.sentence


@pytest.mark.nightly
def test_the_published_integrator_loses_a_fifth_of_the_speed(records):
    record = records["1000 fixed Runge-Kutta steps"]
    assert record.deviation_printed > 0.1
    assert record.mean_speed_printed < 0.9 * record.mean_speed_corrected


def test_an_erratum_is_refuted_by_a_run_that_may_be_in_a_journal(tmp_path, monkeypatch):
    linkage, journal = load("two-crank-takeup"), Journal(tmp_path, "a request")
    compare(CampaignRequest((linkage,), (), "", ("direct",), own_regimes=("driven",)), journal=journal).make()
    monkeypatch.setattr(campaign, "run_engine", None)
    found = list(judge_errata([linkage], ["direct"], journal=journal))
    assert {record.supports for record in found} == {"corrected"}
    assert all(record.deviation_corrected < 1e-10 for record in found)


def test_other_variants_are_not_judged():
    assert list(judge_errata([load("two-crank-takeup", "W+1")], ["direct"])) == []


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


def _answers(name, *engines):
    return list(engine_answers(all_variants(name)[:1], engines, pool=LocalPool(0)))


@pytest.mark.parametrize("name", ["slotted-lever", "teaching-four-bar"])
def test_the_second_derivation_reproduces_what_is_printed_of_signals(name):
    answers = _answers(name, "direct")
    assert len(answers) == len([one for one in all_variants(name)[0].published if "@" in one.quantity])
    for one in answers:
        assert one.ours == pytest.approx(one.published, abs=one.uncertainty + 1e-12 * abs(one.published) + 1e-13)


def test_a_released_crank_and_a_range_between_toggles_are_answered():
    squeezer = {one.quantity: one for one in _answers("andrews-squeezer", "direct")}
    assert squeezer["phi@0.03s"].verdict == "reproduced"
    assert squeezer["joint_force:E:K4:y@0.03s"].verdict == "reproduced"
    watt = {one.quantity: one for one in _answers("watt-six-bar", "direct")}
    assert watt["Mkr@-5"].ours == pytest.approx(-102001.44091590792, rel=1e-9)
    assert "range.low" not in watt


def test_an_engine_that_fails_says_why_and_the_table_names_the_source(tmp_path, monkeypatch):
    announce(tmp_path, "bad", {"bad": "tests.comparisons.faults:Raising"})
    monkeypatch.syspath_prepend(str(tmp_path))
    linkages = all_variants("teaching-four-bar")
    answers = list(engine_answers(linkages, ("bad", "direct"), pool=LocalPool(0)))
    assert {one.ours for one in answers if one.engine == "bad"} == {None}
    assert all("adapter" in one.reason for one in answers if one.engine == "bad")
    sources = {one.name: one.source for one in linkages}
    text = rendered(*terminal.answered(compare_published(linkages), answers, sources))
    assert linkages[0].source.split(",")[0] in text
    assert f"bad: {next(one.reason for one in answers if one.engine == 'bad')}" in text
    assert "±" in text


# Of peak; the energy balance is left out, an integral over samples.
SECOND_DERIVATION = 1e-12
# `direct` ends at change points, and forty windows take it half a minute: ten between two of them.
THROUGH_CHANGE_POINTS = {"n-four-bar": str(FOLDER / "change-points" / "ten-four-bars.toml")}
ORDINARY = ("teaching-four-bar",)
VARIANTS = [
    pytest.param(name, variant, marks=() if name in ORDINARY else pytest.mark.nightly)
    for name in literature()
    for variant in load(name).variants
]


def _choice(name: str, variant: str) -> CompareOptions:
    if name in THROUGH_CHANGE_POINTS:  # between two of them
        ten = (THROUGH_CHANGE_POINTS[name],)
        return CompareOptions(
            mechanisms=ten, engine=("direct",), regime=("cycloidal",), from_angle=90.0, to_angle=30.0, speed=30.0
        )
    regimes = ("own",) if load(name).regimes else ("run-up-quintic",)
    return CompareOptions(mechanisms=(name,), engine=("direct",), regime=regimes, variant=variant, speed=100.0)


@pytest.mark.parametrize(("name", "variant"), VARIANTS)
def test_the_second_derivation_agrees_to_rounding(name, variant):
    for result in compare(request(_choice(name, variant)), pool=LocalPool(0)):
        records = [*result.records, *result.invariants]
        assert {record.outcome for record in records} == {Verdict.PASSED}
        held = [record.error_max for record in records if record.quantity != "energy_balance"]
        assert np.max(held) <= SECOND_DERIVATION
