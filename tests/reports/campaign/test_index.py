"""The first page: the verdict before all else, one row an engine, a card a mechanism, folds for the rest."""

import pytest

from analytic.description.loading import load
from comparisons.designer.building import usual_sheet
from comparisons.trials.judging.records import Verdict
from engines.registry import engine_names
from reports.campaign.index import index
from reports.document.markdown import written
from reports.document.parts import Cards, PageLink, Paragraph
from reports.records import looks
from tests.made_up import made_up_results

NAMES = ("juki-mf7923d", "fork-takeup")
STUDY = (PageLink("Stability", "stress.html"), ": 480 runs")


@pytest.fixture(scope="module")
def results():
    broken = {"gamma": Verdict.UNAVAILABLE}
    engines = ("alpha", "beta", "gamma")
    return made_up_results([load(name) for name in NAMES], samples=51, engines=engines, broken=broken)


@pytest.fixture(scope="module")
def sheets():
    return tuple(usual_sheet(load(name)) for name in NAMES)


@pytest.fixture(scope="module")
def page(results, sheets):
    return index(results, sheets, (STUDY,))


def section(page, key):
    return next(one for one in page.sections if one.key == key)


def test_the_verdict_stands_before_every_section(page):
    assert [part.role for part in page.parts if isinstance(part, Paragraph)] == ["verdict", "lead"]
    assert page.parts[0].words.startswith("alpha and beta, once tuned, pass every comparison")


def test_a_picture_has_a_dot_for_every_engine_and_setting_that_leads_to_its_worst_curve(page):
    figures = page.parts[1].data["figures"]
    assert figures[0]["name"] == "Mkr"
    alpha, beta, gamma = figures[0]["data"]
    assert [len(one["x"]) for one in (alpha, beta, gamma)] == [3, 3, 0]
    assert all(0.0 < error < 10.0 for error in beta["y"])
    assert alpha["customdata"][0].startswith("mechanisms/")
    assert "#curve=run-up%2F" in alpha["customdata"][0]


def test_every_engine_has_a_colour_and_a_symbol_that_no_other_has():
    names = [*engine_names(), *"abcdefghijklmnopqrstuvwxyz"]
    assert len({look[:2] for look in looks(names).values()}) == len(names)


def test_a_card_leads_to_the_page_of_its_mechanism_and_tells_its_figures(page, sheets):
    (cards,) = (part for part in section(page, "mechanisms").parts if isinstance(part, Cards))
    assert [card.heading.href for card in cards.cards] == [
        f"mechanisms/{sheet.name}.{sheet.variant}.html" for sheet in sheets
    ]
    text = written(cards.cards[0].parts)
    assert all(name in text for name in ("peak torque", "peak power", "mean Jeq", "stroke"))
