"""Engines' answers to printed figures, against the figures and against engines that are wrong."""

import pytest

from comparisons.campaign.printed_answers import engine_answers
from comparisons.datasheet.published import all_variants, compare_published
from comparisons.runs.workers import LocalPool
from reports.document.terminal import rendered
from reports.mechanism import terminal
from tests.comparisons.faults import announce


def _answers(name, *engines):
    return list(engine_answers(all_variants(name)[:1], engines, pool=LocalPool(0)))


@pytest.mark.parametrize("name", ["slotted-lever", "shaper-quick-return", "teaching-four-bar", "jansen-leg"])
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
