"""A released crank on its mechanism's page."""

from dataclasses import replace

import pytest

from analytic.description.loading import load
from comparisons.datasheet.building import usual_sheet
from reports.mechanism.released_section import released_section, sentences


@pytest.fixture(scope="module")
def shown():
    return usual_sheet(load("two-crank-takeup"), regimes=("driven",))


def test_a_regime_is_told_in_sentences_and_shown_to_its_last_turn(shown):
    found = released_section(shown)
    (regime,) = found.parts
    sentences_of, figures = regime.parts
    assert "Runge-Kutta steps" in sentences_of.items[-1]
    assert [one.name for one in figures.figures] == ["released-driven", "released-driven-last-turn"]


def test_what_a_motion_lacks_has_no_sentence(shown):
    one = shown.released["driven"]
    nothing = {"rests": [], "ending": None, "settled": None, "coarse": None, "error_bound": None}
    bare = replace(one, facts={**one.facts, **nothing})
    assert [line[-24:] for line in sentences(bare)] == ["the crank can rest at no angle."[-24:]]
    assert "changes with time" in sentences(replace(bare, facts={**bare.facts, "over": "time"}))[0]
