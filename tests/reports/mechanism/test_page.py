"""The page of a mechanism: figures in the units of the file, and a sentence in place of each that it lacks."""

from dataclasses import replace
from functools import cache

import pytest

from analytic.description.loading import catalogue, load
from comparisons.case import Case
from comparisons.datasheet.building import page_sheet, usual_sheet
from reports.document.parts import Facts, FigureGroup, Fold, PageFigure, Paragraph, Table, Widget
from reports.mechanism.page import file_of, page
from tests.analytic.linkages import MADE_UP, from_text, mechanism
from tests.reports.designs.samples import MASS, TURN, piston_text
from tests.reports.made_up_results import made_up_results


def figures(found):
    """Every figure of a page's sections."""
    if isinstance(found, PageFigure):
        return [found]
    if isinstance(found, FigureGroup):
        return list(found.figures)
    inner = next((getattr(found, name) for name in ("sections", "parts", "cards") if hasattr(found, name)), ())
    return [figure for part in inner for figure in figures(part)]


def test_a_crank_that_cannot_turn_has_its_range():
    found = page(usual_sheet(load("stephenson-six-bar")))
    facts = next(part for card in found.parts[-1].cards for part in card.parts if isinstance(part, Facts))
    assert dict(facts.rows)["crank"].startswith("from ")


def section(found, key):
    return next((one for one in found.sections if one.key == key), None)


def key_rows(found):
    """The key figures of a page without scripts."""
    table = next(part for widget in found.parts if isinstance(widget, Widget) for part in widget.instead)
    return {row[0]: row[1:] for row in table.rows}


def test_key_figures_are_those_of_the_formulas_in_the_units_of_the_file():
    rows = key_rows(page_of(piston_text("mm", 1e-3)))
    assert rows["stroke"][0] == "100.0 mm"
    assert rows["RMS torque"][1] == ""  # a mean has no place
    assert rows["peak torque"][0].endswith(" N m")
    assert rows["peak torque"][1].endswith("°")


ORDINARY = ("shaper", "fork-takeup")
NIGHTLY = [pytest.param(name, marks=pytest.mark.nightly) for name in (*MADE_UP, *catalogue()) if name not in ORDINARY]


@cache
def sheet_of(name):
    return usual_sheet(mechanism(name).linkage)


def page_of(text):
    return page(page_sheet(Case(from_text(text), TURN)))


@pytest.mark.parametrize("name", [*ORDINARY, *NIGHTLY])
def test_every_linkage_has_a_page_whose_figures_have_files_of_their_own(name):
    linkage = mechanism(name).linkage
    found = page(sheet_of(name))
    names = [one.name for one in figures(found)]
    assert len(names) == len(set(names))
    assert all(one.alt and one.caption for one in figures(found))
    assert found.file == f"mechanisms/{linkage.name}.{linkage.variant}.html"


def test_its_file_needs_no_quoting_whatever_a_variant_is_called():
    sheet = sheet_of("juki-mf7923d")
    odd = replace(sheet, linkage=replace(sheet.linkage, name="my yoke", variant='50% "#1"'))
    assert file_of(odd) == "mechanisms/my-yoke.50-1-.html"


def test_without_masses_a_sentence_stands_for_torque_and_forces():
    text = piston_text().replace(f"mass = {MASS}", "mass = 0").replace("inertia = 1e-3", "inertia = 0")
    found = page_of(text)
    assert "no torque" in section(found, "drive").parts[0].words
    assert not section(found, "forces")
    assert section(found, "motion")


def test_without_an_output_a_sentence_says_so():
    found = page_of(piston_text().replace('output = { point = "B" }\n', ""))
    assert "names no output" in section(found, "motion").parts[-1].words
    assert "stroke" not in key_rows(found)


def test_a_linkage_without_a_list_of_operations_says_why_its_numbers_stay():
    found = page(usual_sheet(load("shaper-quick-return")))
    words = next(part.words for card in found.parts[-1].cards for part in card.parts if isinstance(part, Paragraph))
    assert words == (
        "The numbers of this page cannot be changed in it: one of its groups has no formula and is solved by Newton's "
        "method."
    )


def test_every_variant_has_a_column_of_published_figures():
    sheet = sheet_of("juki-mf7923d")
    table = next(p for p in section(page(sheet), "published").parts if isinstance(p, Table))
    assert table.head[2:-1] == sheet.linkage.variants
    assert {len(row) for row in table.rows} == {len(table.head)}


def test_every_joint_has_its_largest_force_in_figures():
    linkage = mechanism("three-on-one-pin").linkage
    fold = next(part for part in section(page(usual_sheet(linkage)), "forces").parts if isinstance(part, Fold))
    joints = {joint for pin in linkage.pins for joint in pin.joints} | {slider.name for slider in linkage.sliders}
    assert len(fold.parts[0].rows) == len(joints) + 1  # and the frame


def test_of_a_judged_file_the_verdict_is_first_and_its_errors_come_before_the_designers_figures():
    judged = made_up_results(samples=101)
    judged.document["judgement"] = ["Not right.", "Mkr has the other sign."]
    found = page(sheet_of("juki-mf7923d"), judged)
    assert found.parts[0] == Paragraph("Not right.", "verdict")
    assert found.parts[1].items == ("Mkr has the other sign.",)
    assert found.sections[0].key == "engines"


def test_of_a_campaign_the_engines_come_last_and_only_on_the_pages_of_what_they_ran():
    campaign = made_up_results(samples=101)
    assert [one.key for one in page(sheet_of("juki-mf7923d"), campaign).sections][-1] == "engines"
    assert not section(page(sheet_of("fork-takeup"), campaign), "engines")
